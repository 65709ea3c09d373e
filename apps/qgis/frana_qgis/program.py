"""The program frana as a child process. Knows nothing of QGIS."""
import functools
import json
import os
import queue
import re
import shutil
import subprocess
import threading
import time
from dataclasses import dataclass, field

NEEDED = (0, 1, 0)  # the oldest version that this plugin works with
STOP_PATIENCE = 120.0  # [s] that a run gets to end by itself once it was asked to

_SETTING = "Settings > Options > Processing > Providers > frana"
_INSTALL = "build and install frana (README.md of its repository), then give its path in " + _SETTING


class Trouble(Exception):
    """What a person has to know, in one sentence."""


@dataclass
class Ended:
    code: int
    lines: list = field(default_factory=list)  # plain lines of standard output
    errors: str = ""  # standard error
    last: dict = field(default_factory=dict)  # the last JSON line of each event, by event
    stopped: bool = False  # because it was asked to
    killed: bool = False  # because it did not end within STOP_PATIENCE once it was asked to

    def began(self):
        """Whether runs had begun; None where the call tells nothing of that."""
        return bool({"scene", "progress", "pictures", "result"} & self.last.keys()) if "start" in self.last else None

    def remarks(self):
        told = self.last.get("result") or self.last.get("scene") or {}
        return told.get("remarks", [])


def beside(folder):
    """The program of the installation that this plugin lies in, PREFIX/share/frana/qgis/frana_qgis; None elsewhere."""
    prefix = os.path.realpath(folder)
    for _ in range(4):
        prefix = os.path.dirname(prefix)
    found = os.path.join(prefix, "bin", "frana")
    return found if os.access(found, os.X_OK) else None


def find(setting=""):
    """By the setting, the environment, the installation around this plugin, and PATH."""
    given = setting or os.environ.get("FRANA_PROGRAM", "")
    if given:
        if not os.path.isfile(given) or not os.access(given, os.X_OK):
            raise Trouble(f"program: found no program at {given}; expected the path of frana; correct it in {_SETTING}")
        return given
    found = beside(os.path.dirname(os.path.abspath(__file__))) or shutil.which("frana")
    if not found:
        raise Trouble(f"program: found no frana on this machine; expected it in PATH or in the settings; {_INSTALL}")
    return found


def _output(path, *arguments):
    """Standard output of a call that takes no time; Trouble when it fails."""
    try:
        done = subprocess.run([path, *arguments], capture_output=True, encoding="utf-8", timeout=60, check=False)
    except (OSError, subprocess.SubprocessError) as error:
        raise Trouble(f"program: {path} does not start: {error}; expected frana; correct it in {_SETTING}") from error
    if done.returncode != 0:
        said = (done.stderr.strip().splitlines() or ["no reason"])[0]
        raise Trouble(f"program: {path} {' '.join(arguments)} failed: {said}; expected frana "
                      f"{version_text(NEEDED)} or later; {_INSTALL}")
    return done.stdout


def version_text(version):
    return ".".join(str(number) for number in version)


def parse_version(text):
    """"frana 0.1.0\\nbuild ..." -> (0, 1, 0); None when it is no frana's."""
    match = re.match(r"frana (\d+)\.(\d+)\.(\d+)", text)
    return tuple(int(number) for number in match.groups()) if match else None


@functools.lru_cache(maxsize=8)
def _described(path, modified):
    """The keys of a case by name, from the program itself. `modified` makes a program that was built again be asked again."""
    version = parse_version(_output(path, "--version"))
    if version is None:
        raise Trouble(f"program: {path} is not frana: its --version says something else; correct the path in {_SETTING}")
    if version < NEEDED:
        raise Trouble(f"program: {path} is version {version_text(version)}; this plugin needs "
                      f"{version_text(NEEDED)} or later; {_INSTALL}")
    try:
        table = json.loads(_output(path, "describe", "--json"))
    except ValueError as error:
        raise Trouble(f"program: {path} describe --json gave no JSON; this plugin needs frana {version_text(NEEDED)} or "
                      f"later; {_INSTALL}") from error
    return {entry["key"]: entry for entry in table["keys"]}


def keys(path):
    return _described(path, os.path.getmtime(path))


def ready(setting=""):
    """Path of a program that works."""
    path = find(setting)
    keys(path)
    return path


def _pour(stream, name, into):
    for line in stream:
        into.put((name, line.rstrip("\n")))
    into.put((name, None))


def call(arguments, tell=None, canceled=None, cwd=None):
    """
    Runs the program to its end.

    tell(event, text): `event` is a JSON line as a dict (text None), or None and a plain line of output.
    canceled(): asked ten times a second; once true the program gets SIGTERM and ends with what it has, code 130.
    """
    tell = tell or (lambda event, text: None)
    canceled = canceled or (lambda: False)
    try:
        child = subprocess.Popen(arguments, stdout=subprocess.PIPE, stderr=subprocess.PIPE, stdin=subprocess.DEVNULL,
                                 text=True, encoding="utf-8", errors="replace", cwd=cwd)
    except OSError as error:
        raise Trouble(f"program: {arguments[0]} does not start: {error}; correct its path in {_SETTING}") from error
    lines = queue.Queue()
    for name in ("stdout", "stderr"):
        threading.Thread(target=_pour, args=(getattr(child, name), name, lines), daemon=True).start()
    ended = Ended(0)
    try:
        _follow(child, lines, ended, tell, canceled)
    except BaseException:  # whoever listens failed: no run is left behind without one
        child.terminate()
        raise
    finally:
        ended.code = child.wait()
        child.stdout.close()
        child.stderr.close()
    return ended


def _follow(child, lines, ended, tell, canceled):
    errors, open_streams, asked = [], 2, None
    while open_streams:
        if asked is None and canceled():
            child.terminate()
            ended.stopped, asked = True, time.monotonic()
            tell(None, "stopping: the run finishes its step and leaves a whole folder")
        if asked is not None and not ended.killed and time.monotonic() - asked > STOP_PATIENCE:
            child.kill()
            ended.killed = True
        try:
            name, line = lines.get(timeout=0.1)
        except queue.Empty:
            continue
        if line is None:
            open_streams -= 1
        elif name == "stderr":
            errors.append(line)
        else:
            _note(line, ended, tell)
    ended.errors = "\n".join(errors).strip()


def _note(line, ended, tell):
    event = event_of(line)
    if event is None:
        ended.lines.append(line)
        tell(None, line)
    else:
        ended.last[event["event"]] = event
        tell(event, None)


def event_of(line):
    """The object of a line of --progress json, or None of any other line."""
    if not line.startswith("{"):
        return None
    try:
        event = json.loads(line)
    except ValueError:
        return None
    return event if isinstance(event, dict) and "event" in event else None


def sentence(ended):
    """Why the program did not end well; None where it did."""
    if ended.code == 0 or (ended.code == 130 and ended.stopped):
        return None
    said = ended.errors or "the program said nothing"
    if ended.code == 2:
        return said
    if ended.code == 3:
        return f"numerics: {said}; the folder has a last frame to look at"
    if ended.code == 130:
        return f"interrupted from outside: {said}; the run can be resumed"
    if ended.killed:
        return (f"canceled, and ended by force since it did not end by itself within {STOP_PATIENCE:g} s; what it wrote "
                "before may be resumed")
    if ended.code < 0 and ended.stopped:
        return "canceled; what it wrote before may be resumed" if ended.began() else "canceled before the run began"
    if ended.code < 0:
        return f"the program was ended by signal {-ended.code}; its last saved state can be resumed"
    return f"a mistake of frana (exit code {ended.code}): {said}; please report it with the case"
