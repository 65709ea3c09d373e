#!/usr/bin/env python3
"""Runs the commands of all READMEs: readme_commands.py FRANA SOURCE BUILD FOLDER.

They are the lines of ```sh blocks, and those after `$ ` in other blocks. Those of frana run as they stand, in a scratch
folder that sees the project's cases and is the home folder; commands without --out get one. What costs too much, or needs
what not every machine has, is in readme_commands.toml, with the test that runs it, or with what is run instead and why. A
command that is neither run nor listed fails, as does one that is listed and stands on no page. Of `frana ...` in running
text the command, its options and the names of its problems are looked up.
"""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib

PAGES_APART = "build"
HERE = os.path.dirname(os.path.abspath(__file__))
LISTED = os.path.join(HERE, "readme_commands.toml")


def pages(source):
    for folder, folders, files in os.walk(source):
        folders[:] = sorted(f for f in folders if not f.startswith((".", PAGES_APART)) and f not in ("out", "node_modules")
                            and not os.path.exists(os.path.join(folder, f, "pyvenv.cfg")))
        for name in sorted(files):
            if name.endswith(".md"):
                with open(os.path.join(folder, name), encoding="utf-8") as text:
                    yield os.path.relpath(os.path.join(folder, name), source), text.read()


def commands(text):
    for kind, block in re.findall(r"^```(\w*)\n(.*?)^```", text, re.M | re.S):
        for line in block.replace("\\\n", " ").splitlines():
            if kind != "sh":
                if not line.startswith("$ "):
                    continue
                line = line[2:]
            line = re.sub(r"(^|\s+)#.*", "", line).strip()
            loop = re.fullmatch(r"for (\w+) in ([^;]+); do (.*); done", line)
            parts = [loop.group(3).replace("$" + loop.group(1), of) for of in loop.group(2).split()] if loop \
                else line.split(" && ")
            for part in parts:
                if part.strip():
                    yield part.replace("build/bin/frana", "frana").strip()


def as_it_stands(command, number):
    """With a folder of its own where it says none, and without what it would ask or print."""
    words = command.split()
    if words[:1] == ["frana"] and words[1] in ("run", "converge", "ensemble", "calibrate"):
        if "--out" not in words and "--join" not in words:
            command += f" --out out/readme_{number}"
        command += " --quiet"
        if words[1] != "ensemble" and "--resume" not in words:
            command += " --overwrite"
    return command


def known_tests(build):
    """What each test of this build runs, by name; nothing of those that a build with more switched on has."""
    with tempfile.TemporaryDirectory() as apart:  # in the build itself it would clear the log of the run that this is part of
        with open(os.path.join(apart, "CTestTestfile.cmake"), "w", encoding="utf-8") as text:
            text.write(f'subdirs("{os.path.abspath(build)}")\n')
        asked = ["ctest", "--test-dir", apart, "--show-only=json-v1"]
        listed = subprocess.run(asked, stdout=subprocess.PIPE, check=True).stdout
    with open(os.path.join(HERE, "CMakeLists.txt"), encoding="utf-8") as text:
        tests = {name: "" for name in re.findall(r"add_test\(NAME (\w+)", text.read())}
    for test in json.loads(listed)["tests"]:
        tests[test["name"]] = " ".join(test.get("command", ""))
    return tests


def wrong_in_list(listed, on_pages, tests):
    for one in listed:
        if one["is"] not in on_pages:
            yield f"stands on no page: {one['is']}"
        if ("test" in one) == ("why" in one):
            yield f"needs either a test that runs it or a reason: {one['is']}"
        if one.get("test", "core") not in tests:
            yield f"no such test, {one['test']}: {one['is']}"
        elif one["is"].startswith("frana run ") and "test" in one:  # of a case, in full and with nothing set
            runs = tests[one["test"]]
            if one["is"].split()[2] not in runs or "--set" in one["is"] or "-DSET= " not in runs:
                yield f"the test {one['test']} does not run it: {one['is']}"
        if set(one) - {"is", "run", "test", "why"}:
            yield f"has unknown entries: {one['is']}"


def said(line, folder, environment):
    return subprocess.run(line, shell=True, cwd=folder, env=environment, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True)


def wrong_in_text(frana, all_pages, folder, environment):
    """Commands, options and problems that running text names and that do not exist."""
    helps = {}
    problems = set(re.findall(r"[\w]+", said(f"{frana} verify --list", folder, environment).stdout))
    for page, text in all_pages:
        for inline in re.findall(r"`frana ([a-z][^`]*)`", re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)):
            words = inline.split()
            if words[0] not in helps:
                asked = said(f"{frana} {words[0]} --help", folder, environment)
                helps[words[0]] = asked.stdout if asked.returncode == 0 else None
            if helps[words[0]] is None:
                yield f"{page}: no such command: frana {inline}"
                continue
            for option in re.findall(r"--[a-z][a-z-]*", inline):
                if not re.search(re.escape(option) + r"(?![a-z-])", helps[words[0]]):
                    yield f"{page}: no such option, {option}: frana {inline}"
            for name in words[1:] if words[0] == "verify" else []:
                if name.startswith("--"):
                    break
                if re.fullmatch(r"[a-z]\w*", name) and name not in problems:
                    yield f"{page}: no such problem, {name}: frana {inline}"


def make_folder(source, build, folder):
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(os.path.join(folder, "few"))
    os.symlink(os.path.join(source, "cases"), os.path.join(folder, "cases"))
    os.symlink(build, os.path.join(folder, "build"))
    for name in ("case.toml", "dem.asc", "release.geojson"):  # "case.toml" of a page is the volcano's
        shutil.copy(os.path.join(source, "cases", "maungawhau", name), folder)
    with open(os.path.join(source, "cases", "ensemble", "ensemble.toml"), encoding="utf-8") as whole:
        few = re.sub(r"samples = \d+", "samples = 4", whole.read()).replace('"case.toml"', '"../cases/ensemble/case.toml"')
    with open(os.path.join(folder, "few", "ensemble.toml"), "w", encoding="utf-8") as file:
        file.write(few)
    with open(os.path.join(source, "cases", "calibrate", "calibrate.toml"), encoding="utf-8") as whole:
        few = re.sub(r"(samples|draws) = \d+", r"\1 = 4", whole.read()).replace("rounds = 3", "rounds = 1\nsearch = \"none\"")
        few = re.sub(r'case = "', 'case = "../cases/calibrate/', few)
    with open(os.path.join(folder, "few", "calibrate.toml"), "w", encoding="utf-8") as file:
        file.write(few)


def main():
    frana, source, build, folder = (os.path.abspath(path) for path in sys.argv[1:5])
    make_folder(source, build, folder)
    environment = dict(os.environ, OMP_NUM_THREADS="1", HOME=folder,
                       PATH=os.path.dirname(frana) + os.pathsep + os.environ["PATH"])
    with open(LISTED, "rb") as file:
        listed = tomllib.load(file)["command"]
    instead = {one["is"]: one for one in listed}
    all_pages = list(pages(source))
    on_pages = [(page, command) for page, text in all_pages for command in commands(text)]
    wrong = list(wrong_in_list(listed, {command for _, command in on_pages}, known_tests(build)))
    wrong += wrong_in_text(frana, all_pages, folder, environment)
    counts, done = {"as they stand": 0, "in a shorter form": 0, "by tests of their own": 0, "not": 0}, set()
    for page, command in on_pages:
        one = instead.get(command)
        if command in done:
            continue
        done.add(command)
        counts["as they stand" if one is None else "by tests of their own" if "test" in one
               else "in a shorter form" if "run" in one else "not"] += 1
        if one is not None and "run" not in one:
            continue
        line = as_it_stands(one["run"] if one else command, len(done))
        if line in done:  # two may be shortened to one
            continue
        done.add(line)
        if one is None and line.split()[0] not in ("frana", "mkdir", "ln"):
            wrong.append(f"{page}: is neither of frana nor in readme_commands.toml: {command}")
            continue
        started = time.monotonic()
        ran = said(line, folder, environment)
        print(f"{time.monotonic() - started:6.1f} s  {line}", flush=True)
        if ran.returncode != 0:
            wrong.append(f"{page}: {command}\n  ran as: {line}\n  exit {ran.returncode}: {ran.stdout.strip()[-600:]}")
    print("commands of the READMEs run " + ", ".join(f"{what}: {count}" for what, count in counts.items()))
    for one in wrong:
        print("wrong: " + one)
    return 1 if wrong or counts["as they stand"] < 25 else 0


if __name__ == "__main__":
    sys.exit(main())
