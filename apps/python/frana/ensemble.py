"""Ensembles: one case run many times, and what the runs say together."""
import csv
import io
import json
import os
import warnings
from collections.abc import Mapping

from . import _frana
from .errors import DataError
from .raster import Raster


class EnsembleProgress:
    """What the progress callback of an ensemble gets; as text a line for people.

    Attributes
    ----------
    done, runs, failed : int
        Of the runs that this call makes.
    """

    def __init__(self, done, runs, failed):
        self.done, self.runs, self.failed = done, runs, failed

    def __str__(self):
        return f"{self.done} of {self.runs} runs, {self.failed} failed"


class Ensemble:
    """An ensemble from its file: ``Ensemble("ensemble.toml").run("out/many")``.

    The file is that of ``frana ensemble``, and the runs and maps have the same bytes.

    Parameters
    ----------
    path : path
        The file (TOML), with the case and the keys that vary.
    exceed : dict, optional
        More thresholds for maps of probability, in the field's unit: ``{"peak_depth": [1.3]}`` [m].

    Attributes
    ----------
    samples : int
        Runs that it makes.
    keys : list of str
        That vary.
    fields : list of str
        Kept of each run: "peak_depth", ...
    method : str
        How samples are chosen.

    Raises
    ------
    CaseError, DataError
        With every problem of the file at once.
    """

    def __init__(self, path, *, exceed=None):
        self._path = os.path.abspath(path)
        wishes = [f"{field}={float(value)!r}" for field, values in (exceed or {}).items()
                  for value in (values if isinstance(values, (list, tuple)) else [values])]
        self._plan = _frana.ensemble_plan(self._path, wishes)
        self.samples, self.method = self._plan.samples, self._plan.method
        self.keys, self.fields = self._plan.keys, self._plan.fields

    def run(self, out=None, *, threads=None, resume=False, progress=None):
        """Makes all runs and their maps, and returns their `EnsembleFolder`.

        Parameters
        ----------
        out : path, optional
            Folder for all that ``frana ensemble`` leaves. None: a temporary one, which goes with what is returned.
        threads : int, optional
            Runs at the same time, each on one thread. Default OMP_NUM_THREADS.
        resume : bool
            Go on with what has run in the folder.
        progress : callable, optional
            Gets an `EnsembleProgress` up to five times a second; ``print`` will do.

        Raises
        ------
        CaseError, DataError
            With every problem; also where no run has an answer.
        KeyboardInterrupt
            After the steps that are under way. What has run is kept in ``out``; ``resume=True`` goes on.
        """
        if threads is not None and not 1 <= int(threads) <= 4096:
            raise ValueError(f"threads: found {threads}; expected 1 to 4096")
        if out is None and resume:
            raise ValueError("resume: found without a folder; expected out=DIR with it")
        kept = None
        if out is None:
            import tempfile

            kept = tempfile.TemporaryDirectory(prefix="frana_ensemble_")
            out = kept.name
        tell = None if progress is None else lambda *numbers: progress(EnsembleProgress(*numbers))
        folder = os.path.abspath(out)
        told = _frana.run_ensemble(self._plan, folder, int(threads or 0), bool(resume), tell)
        if told["too_many_failed"]:
            warnings.warn(f"{told['failed']} of {told['run']} runs failed, more than 5 %: the maps should not be trusted; "
                          f"the reasons are in {os.path.join(folder, 'runs.csv')}", RuntimeWarning, stacklevel=2)
        return EnsembleFolder(folder, kept)

    def __repr__(self):
        return f"<frana.Ensemble {self.samples} samples by {self.method}>"


class Maps(Mapping):
    """Rasters by name, each read when it is asked for."""

    def __init__(self, folder):
        self._folder = folder
        try:
            names = os.listdir(folder)
        except OSError:
            names = []
        self._names = sorted(name[:-4] for name in names if name.endswith(".tif") and not name.startswith("."))

    def __getitem__(self, name):
        if name not in self._names:
            raise KeyError(f"{name}: no such map; there are {', '.join(self._names)}")
        return Raster._of(*_frana.ensemble_map(os.path.join(self._folder, name + ".tif"), name))

    def __iter__(self):
        return iter(self._names)

    def __len__(self):
        return len(self._names)


class EnsembleFolder:
    """The folder of an ensemble, from `Ensemble.run` or `frana.open`. Everything is read when it is asked for.

    Attributes
    ----------
    path : str
    runs : numpy structured array
        runs.csv, a row for each run: "sample", "weight", the keys that vary, "reason", "runout_m", ...
    samples : numpy structured array
        samples.csv: what each run is made with.
    rasters : Maps
        By name: "probability_peak_depth_0.5", "quantile_peak_depth_0.95", "mean_peak_depth", ... North row first.
    record : dict
        ensemble.json: means and quantiles of outcomes, sensitivities.
    report : str
        report.md.
    """

    def __init__(self, path, kept=None):
        self.path, self._kept = os.fspath(path), kept

    def _text(self, name):
        try:
            with open(os.path.join(self.path, name), encoding="utf-8") as file:
                return file.read()
        except OSError as error:
            raise DataError([f"{error.filename}: {error.strerror}; expected a file of the ensemble; wait for its end, or "
                             "go on with it: Ensemble(FILE).run(DIR, resume=True)"]) from None

    @property
    def finished(self):
        """Whether its maps are there."""
        return os.path.exists(os.path.join(self.path, "ensemble.json"))

    @property
    def record(self):
        return json.loads(self._text("ensemble.json"))

    @property
    def report(self):
        return self._text("report.md")

    @property
    def runs(self):
        return _table(self._text("runs.csv"), os.path.join(self.path, "runs.csv"))

    @property
    def samples(self):
        return _table(self._text("samples.csv"), os.path.join(self.path, "samples.csv"))

    @property
    def rasters(self):
        return Maps(os.path.join(self.path, "rasters"))

    def probability(self, field, *, above):
        """The share of the runs with more than ``above`` of a field, as a `Raster` [1].

        A map that the folder has is read, float32; any other threshold is counted from the runs, which needs their case.

        Parameters
        ----------
        field : str
            That is kept of the runs: "peak_depth" [m], "peak_speed" [m/s], "peak_dynamic_pressure" [Pa], ...
        above : float
            In the field's unit; of "peak_depth" at least output.footprint_depth.

        Raises
        ------
        DataError
            Where the ensemble keeps no such field, or its file or case have changed.
        """
        above = float(above)
        name = f"probability_{field}_{above:g}"
        maps = self.rasters
        if name in maps and float(f"{above:g}") == above:
            return maps[name]
        raster = Raster._of(*_frana.ensemble_probability(self.path, str(field), above))
        raster.name = name
        return raster

    def __repr__(self):
        return f"<frana.EnsembleFolder {self.path}>"


def is_ensemble(path):
    """Whether a folder is that of an ensemble."""
    return any(os.path.exists(os.path.join(path, name)) for name in ("ensemble.json", "ensemble.path"))


_WHOLE = ("sample", "steps")


def _column(name, cells):
    """(type, values) of a column: numbers where all are, empty ones NaN; else words."""
    if name in _WHOLE:
        return "i8", [int(cell) for cell in cells]
    try:
        return "f8", [float(cell) if cell else float("nan") for cell in cells]
    except ValueError:
        return f"U{max((len(cell) for cell in cells), default=0) or 1}", cells


def _table(text, path):
    """A CSV file with numbers and words as a structured array."""
    import numpy

    rows = list(csv.reader(io.StringIO(text)))
    if not rows or any(len(row) != len(rows[0]) for row in rows):
        raise DataError([f"{path}: found rows of different lengths; expected a table of frana; run the ensemble again"])
    words = ("reason", "message")
    columns = []
    for k, name in enumerate(rows[0]):
        cells = [row[k] for row in rows[1:]]
        columns.append((name, *(_column(name, cells) if name not in words else
                                (f"U{max((len(cell) for cell in cells), default=0) or 1}", cells))))
    table = numpy.empty(len(rows) - 1, dtype=[(name, kind) for name, kind, _ in columns])
    for name, _, values in columns:
        table[name] = values
    return table
