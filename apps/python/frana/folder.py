"""Folders of runs, finished or running, of this module or of the program."""
import csv
import json
import os
from collections.abc import Mapping, Sequence

from . import _frana, raster
from .errors import DataError
from .nodes import Nodes, Points


class Arrays(Mapping):
    """Arrays by name, with their units."""

    def __init__(self, arrays):
        self._arrays = arrays

    def __getitem__(self, name):
        return self._arrays[name][0]

    def __iter__(self):
        return iter(self._arrays)

    def __len__(self):
        return len(self._arrays)

    def unit(self, name):
        return self._arrays[name][1]


class StoredGrid(Nodes, Arrays):
    """Fields of nodes, of the shape (ny, nx) or (ny, nx, components); row 0 is the southernmost."""

    def __init__(self, arrays, geometry, crs):
        super().__init__(arrays)
        self._of_nodes, self._crs = geometry, crs

    def _geometry(self):
        return self._of_nodes


class StoredParticles(Points, Arrays):
    """Fields of particles, of the shape (n,) or (n, components)."""

    def __init__(self, arrays, crs):
        super().__init__(arrays)
        self._crs = crs


class StoredFrame:
    """A frame of a run's VTK files: float32 precision, read when asked for.

    Attributes
    ----------
    number : int
    time : float
        [s]
    grid : StoredGrid
        Fields of nodes, (ny, nx) or (ny, nx, components), south row first, with what `Grid` has of a run.
    particles : StoredParticles
        Fields of particles, (n,) or (n, components).
    """

    def __init__(self, folder, number, time):
        self._folder, self.number, self.time = folder, number, time
        self._grid = self._particles = None

    @property
    def grid(self):
        if self._grid is None:
            _, geometry, arrays = _frana.grid_frame(self._folder, self.number)
            self._grid = StoredGrid(arrays, geometry, _frana.crs_in(self._folder))
        return self._grid

    @property
    def particles(self):
        if self._particles is None:
            arrays = _frana.particle_frame(self._folder, self.number)[1]
            self._particles = StoredParticles(arrays, _frana.crs_in(self._folder))
        return self._particles

    def __repr__(self):
        return f"<frana.StoredFrame {self.number} at {self.time:g} s>"


class Frames(Sequence):
    """The frames of a folder."""

    def __init__(self, folder):
        self._folder = folder
        self.times = _frana.frame_times(folder)

    def __len__(self):
        return len(self.times)

    def __getitem__(self, number):
        if isinstance(number, slice):
            return [self[k] for k in range(*number.indices(len(self)))]
        if number < 0:
            number += len(self)
        if not 0 <= number < len(self):
            raise IndexError(f"frame {number}: there are {len(self)}")
        return StoredFrame(self._folder, number, self.times[number])

    def at(self, time):
        """The frame nearest to a time [s]."""
        return self[min(range(len(self)), key=lambda k: abs(self.times[k] - time))]


class Folder:
    """A run's folder, from `frana.open`. Everything is read when it is asked for, so that a run may still go on.

    Attributes
    ----------
    path : str
    frames : Frames
        By number or time; needs "vtk" in output.formats.
    history : numpy structured array
        history.csv: "t" [s], "mass" [kg], "kinetic" [J], "max_depth" [m], "front" [m], ...
    rasters : Rasters
        rasters/*.tif, north row first; NaN where the flow never came.
    record : dict
        run.json.
    report : str
        report.md.
    """

    def __init__(self, path):
        self.path = os.fspath(path)
        if not os.path.isdir(self.path):
            raise DataError([f"{self.path}: found no folder; expected that of a run; correct the name"])
        if not any(os.path.exists(os.path.join(self.path, name)) for name in ("run.json", "resolved.toml", "history.csv")):
            raise DataError([f"{self.path}: found no files of a run; expected run.json or resolved.toml; name the folder "
                             "that was given with --out"])

    def _text(self, name):
        try:
            with open(os.path.join(self.path, name), encoding="utf-8") as file:
                return file.read()
        except OSError as error:
            raise DataError([f"{error.filename}: {error.strerror}; expected a file of the run; wait for its end, or ask for "
                             "it in output.formats"]) from None

    @property
    def finished(self):
        """Whether the run is over: run.json tells its end."""
        try:
            return bool(self.record.get("files"))
        except DataError:
            return False

    @property
    def record(self):
        return json.loads(self._text("run.json"))

    @property
    def report(self):
        return self._text("report.md")

    @property
    def frames(self):
        return Frames(self.path)

    @property
    def history(self):
        return self.table("history.csv")

    def table(self, name):
        """A CSV file of the folder, "gauges/bridge.csv", as a structured array; empty cells are NaN. Names have no units.

        A row that a run is still writing is left out. DataError for a table that holds words.
        """
        import numpy

        text = self._text(name)
        rows = list(csv.reader(text[: text.rfind("\n") + 1].splitlines()))
        if not rows:
            raise DataError([f"{os.path.join(self.path, name)}: found no whole line; expected a table; wait for the run"])
        columns = [header.split(" [")[0] for header in rows[0]]
        try:
            numbers = [tuple(float(cell) if cell else float("nan") for cell in row) for row in rows[1:]]
            return numpy.array(numbers, dtype=[(column, float) for column in columns])
        except ValueError as error:
            raise DataError([f"{os.path.join(self.path, name)}: {error}; expected a number in each of the columns "
                             f"{', '.join(columns)}; read a table with words by the module csv"]) from None

    @property
    def rasters(self):
        return raster.of_list(_frana.rasters_in(self.path))

    def compare(self, survey, *, deposit=None, path=None, bed_change=None, bed_change_noise=0.1):
        """Holds the run against a survey, and writes nothing.

        Parameters
        ----------
        survey : path
            Outline of the footprint (vector), or a raster.
        deposit, path, bed_change : path, optional
            Thickness of the deposit [m], a line for the runout, the surveyed change of the ground [m].
        bed_change_noise : float
            Changes of at most this count as none [m].

        Returns
        -------
        dict
            The content of compare.json.
        """
        files = [os.fspath(file) if file is not None else "" for file in (survey, deposit, path, bed_change)]
        return json.loads(_frana.compared(self.path, *files, float(bed_change_noise)))

    def __repr__(self):
        return f"<frana.Folder {self.path}>"
