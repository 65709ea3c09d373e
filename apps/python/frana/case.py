"""Cases: files or dictionaries of the same keys."""
import numbers
import os

from . import _frana
from .errors import CaseError, DataError, Error
from .raster import Raster
from .run import Run


def _plain(value):
    """Numbers of numpy, arrays, paths and tuples as plain Python."""
    if hasattr(value, "tolist"):
        if hasattr(value, "dtype") and value.dtype.kind not in "biufU":
            raise DataError([f"found an array of type {value.dtype}; expected real numbers; give array.astype(float)"])
        value = value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, tuple):
        return list(value)
    return value


def _toml(value):
    """A value as TOML text: numbers with all their digits."""
    value = _plain(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return repr(value)
    if isinstance(value, float):
        return repr(value)
    if isinstance(value, str):
        escapes = {'"': '\\"', "\\": "\\\\"}
        return '"' + "".join(escapes.get(c, c if c >= " " and c != "\x7f" else f"\\u{ord(c):04x}") for c in value) + '"'
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_toml(item) for item in value) + "]"
    raise TypeError(f"found {type(value).__name__}; expected a number, text, True or False, or a list of them")


def _tables(table, name=""):
    """A dictionary as the lines of a case file."""
    lines, below = [], []
    for key, value in table.items():
        full = f"{name}.{key}" if name else str(key)
        if isinstance(value, dict):
            below += ["", f"[{full}]", *_tables(value, full)]
        elif isinstance(value, (list, tuple)) and value and all(isinstance(item, dict) for item in value):
            for item in value:
                below += ["", f"[[{full}]]", *_tables(item, full)]
        else:
            lines.append(f"{key} = {_toml(value)}")
    return lines + below


class Check:
    """What a case holds, from `Case.check`; as text what ``frana check`` prints, or every problem.

    Attributes
    ----------
    ok : bool
        Whether it can run.
    problems : list of Problem
        All that were found.
    particles : int
        At the start, and of what enters later.
    volume : float
        Of these [m3].
    memory : float
        That a run needs, as long as particles do not split [bytes].
    """

    def __init__(self, checked=None, problems=()):
        self.ok, self.problems = checked is not None, list(problems)
        self.text = checked.text if checked else "\n".join(self.problems)
        self.particles = checked.particles if checked else 0
        self.volume = checked.volume if checked else 0.0
        self.memory = checked.memory if checked else 0.0

    def __str__(self):
        return self.text

    def __bool__(self):
        return self.ok


class Case:
    """A case: ``Case("case.toml")``, or a dictionary of its tables, ``Case({"terrain": {"dem": "dem.tif"}, ...})``.

    ``case["material.bed.mu"]`` is the value of a key, or its default; ``case["release.0.depth"] = 2.0`` overrides it, as
    ``--set`` does. Keys, units and ranges are those of ``frana describe``. Paths in a dictionary are relative to the present
    folder.

    Raises
    ------
    CaseError
        With every problem of the file at once.
    """

    def __init__(self, source, set=None):
        self._sets = {}
        self._text = None
        self._kept = []
        if isinstance(source, dict):
            self._path = os.path.join(os.getcwd(), "dictionary")
            self._text = "\n".join(_tables(source)) + "\n"
        else:
            self._path = os.path.abspath(source)  # the present folder may change before the case is read again
        for key, value in (set or {}).items():
            self._put(key, value)
        self._read()

    @classmethod
    def from_rasters(cls, *, dem, release, density, depth=None, end=60.0, every=5.0, **bed):
        """A case of an elevation model and a release.

        Parameters
        ----------
        dem : path or Raster
            Elevation [m], projected.
        release : path or Raster
            An outline, with ``depth``; or the depth on pixels [m].
        density : float
            [kg/m3]
        depth : float, path or Raster
            Of an outline, along gravity [m].
        end, every : float
            Of the simulated time, and between outputs [s].
        **bed
            Keys of [material.bed]: ``law="voellmy", mu=0.15, xi=500.0``.
        """
        kept = []

        def file_of(given, name):
            if not isinstance(given, Raster):
                return os.path.abspath(given)
            import tempfile

            folder = tempfile.TemporaryDirectory(prefix="frana_")
            kept.append(folder)
            path = os.path.join(folder.name, name)
            given.save(path)
            return path

        where = {"outline": file_of(release, "release.tif")} if depth is not None else {"depth": file_of(release, "depth.tif")}
        if depth is not None:
            where["depth"] = float(depth) if isinstance(depth, numbers.Real) else file_of(depth, "depth.tif")
        case = cls({"terrain": {"dem": file_of(dem, "dem.tif")}, "release": [where],
                    "material": {"density": float(density), "bed": bed},
                    "time": {"end": float(end)}, "output": {"every": float(every)}})
        case._kept = kept
        return case

    def _put(self, key, value):
        _frana.require_key(key)
        try:
            self._sets[key] = _toml(value)
        except TypeError as error:
            raise TypeError(f"{key}: {error}") from None

    def _read(self):
        sets = [f"{key}={value}" for key, value in self._sets.items()]
        if self._text is None:
            self._file = _frana.CaseFile.read(self._path, sets)
        else:
            self._file = _frana.CaseFile.parse(self._text, self._path, sets)
        return sets

    def __getitem__(self, key):
        """The value of a key, its default, or None where it has none. KeyError with the nearest key."""
        return self._file.value(key)

    def __setitem__(self, key, value):
        before = dict(self._sets)
        self._put(key, value)
        try:
            self._read()
        except Error:
            self._sets = before
            raise

    def __contains__(self, key):
        """Whether the case gives the key."""
        try:
            return self._file.given(key)
        except KeyError:
            return False

    def update(self, values):
        """Several keys at once: those that only go together."""
        before = dict(self._sets)
        try:
            for key, value in values.items():
                self._put(key, value)
            self._read()
        except Exception:
            self._sets = before
            raise

    @property
    def name(self):
        """The folder of a case.toml, else the file's stem."""
        return self._file.name

    @property
    def resolved(self):
        """The case in full as TOML: every key in SI, defaults marked."""
        return self._file.resolved()

    def check(self):
        """Builds the whole scene without running it, and returns a `Check`: all problems, or particles, memory, time."""
        try:
            self._read()
            return Check(_frana.check(self._file))
        except (CaseError, DataError) as error:
            return Check(problems=error.problems)

    def run(self, out=None, *, threads=None, until=None, overwrite=False, resume=False, progress=None):
        """Builds the scene, and returns a `Run` that stands before its first frame.

        Parameters
        ----------
        out : path, optional
            Folder for all that ``frana run`` leaves, byte for byte. None: nothing is written, and what are files (gauges,
            profiles, sections, barriers' forces, pictures) is not there.
        threads : int, optional
            Of this run; any number gives the same bits. Default OMP_NUM_THREADS.
        until : float, optional
            An earlier end [s].
        overwrite, resume : bool
            Replace an earlier run in the folder, or go on from its checkpoint.
        progress : callable, optional
            Gets a `Progress` at outputs and up to five times a second; ``print`` will do. What it raises comes through, and
            the run stands until it is told to go on.

        Raises
        ------
        CaseError, DataError
            With every problem; nothing has been written then.
        """
        if threads is not None and not 1 <= int(threads) <= 4096:
            raise ValueError(f"threads: found {threads}; expected 1 to 4096")
        if out is None and (overwrite or resume):
            raise ValueError("overwrite, resume: found without a folder; expected out=DIR with them")
        sets = self._read()
        tell = None if progress is None else lambda status, end: progress(_progress(status, end))
        folder = None if out is None else os.path.abspath(out or os.path.join("out", self.name))
        run = _frana.Run(self._file, folder, sets, int(threads or 0), None if until is None else float(until),
                         bool(overwrite), bool(resume), tell)
        return Run(run, folder, self._kept)

    def __repr__(self):
        return f"<frana.Case {self.name}>"


def _progress(status, end):
    from .run import Progress

    return Progress(status, end)
