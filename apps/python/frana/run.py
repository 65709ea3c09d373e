"""A run that goes on from frame to frame."""
import json
from collections.abc import Mapping

from . import raster
from .nodes import Nodes, Points


class Fields(Mapping):
    """Arrays of float64 by name; each is a view into the run, read-only, made anew when asked for.

    A view costs nothing. It stays as it is when the run goes on: the run then takes other memory for its next frame.
    """

    def __init__(self, frame, of_grid, crs=""):
        self._frame, self._of_grid, self._crs = frame, of_grid, crs

    def __getitem__(self, name):
        return self._frame.view(self._of_grid, name)

    def __iter__(self):
        return iter(self._frame.names(self._of_grid))

    def __len__(self):
        return len(self._frame.names(self._of_grid))

    def unit(self, name):
        """The unit of a field, "m/s"."""
        return self._frame.unit(self._of_grid, name)


class Grid(Nodes, Fields):
    """Fields of nodes, of the shape (ny, nx) or (ny, nx, components); row 0 is the southernmost."""

    def _geometry(self):
        return self._frame.grid_geometry


class Particles(Points, Fields):
    """Fields of particles, of the shape (n,) or (n, components)."""


class Frame:
    """A state of a run. ``time`` and ``status`` stay; fields can be asked for until the run goes on.

    Attributes
    ----------
    number : int
        0, 1, 2, ... of the outputs. Between two of them, from `Run.advance`, that of the next.
    time : float
        [s]
    status : Status
        Sums and extremes.
    grid : Grid
        Fields of nodes: "elevation" (of the bed as the flow has it, see `Run.bed`), "depth", "surface",
        "velocity" (ny, nx, 3), "peak_depth", "bed_change", ...
    particles : Particles
        Fields of particles: "position" (n, 3), "depth" (n,), "velocity" (n, 3), ...
    """

    def __init__(self, frame, crs=""):
        self.number, self.time, self.status = frame.number, frame.status.time, frame.status
        self.grid, self.particles = Grid(frame, True, crs), Particles(frame, False, crs)

    def __repr__(self):
        return f"<frana.Frame {self.number} at {self.time:g} s>"


class Progress:
    """What a progress callback gets; as text a line for people.

    Attributes
    ----------
    time, end : float
        Where the run is, and where it ends at the latest [s].
    status : Status
        Sums and extremes of the last step.
    """

    def __init__(self, status, end):
        self.time, self.end, self.status = status.time, end, status

    def __str__(self):
        s = self.status
        return (f"{self.time:9.3f} of {self.end:g} s   step {s.step}   {s.particles} particles   "
                f"depth {s.max_depth:.3g} m   speed {s.max_speed:.3g} m/s")


class Result:
    """What a run leaves.

    Attributes
    ----------
    rasters : Rasters
        "peak_depth", "peak_speed", "arrival_time", "final_depth", ...: also as attributes of the result itself. NaN
        where the flow never came, 0 where it came and left nothing.
    record : dict
        The content of run.json: numbers in SI units.
    warnings : list of str
        Remarks on what may not be what was meant.
    reason : str
        "end", "until", "rest", "left", "interrupted", "numerics" or "refused".
    folder : str or None
        Where its files are.
    """

    def __init__(self, run, folder):
        self.folder = folder
        self.record = json.loads(run.record())
        self.rasters = raster.of_list(run.rasters())

    @property
    def reason(self):
        return self.record["exit_reason"]

    @property
    def warnings(self):
        return self.record["remarks"]

    def __getattr__(self, name):
        if name.startswith("_") or name == "rasters":
            raise AttributeError(name)
        return getattr(self.rasters, name)

    def __repr__(self):
        return f"<frana.Result {self.reason}, rasters {', '.join(self.rasters)}>"


class Run:
    """A run, from `Case.run`: a context manager, and an iterator of its frames.

    The first frame is that of the start, the last that of the end. Steps are those of ``frana run``, whatever is looked at.
    Leaving the ``with`` block early ends the run where it is, as Ctrl-C ends the program: what it leaves is whole.
    A run belongs to one thread at a time, and to the process that started it.
    """

    def __init__(self, run, folder, kept=()):
        self._run, self._folder, self._result = run, folder, None
        self._kept = kept  # temporary folders of the case, which may go before its run

    def __enter__(self):
        return self

    def __exit__(self, kind, error, trace):
        try:
            self.close()
        except Exception:
            if kind is None:  # else what is on its way already tells more
                raise

    def __iter__(self):
        return self

    def __next__(self):
        frame = self._run.next()
        if frame is None:
            raise StopIteration
        return Frame(frame, self._run.crs)

    def advance(self, *, until):
        """Goes on to the first moment at or after ``until`` [s], and returns its frame; None: the run is over.

        Between outputs a frame is that of the step which reaches the time: looking changes no step. It has the number
        of the output to come, so that two frames may have one number; their times differ.
        """
        until = float(until)
        if not self.over and not until > self.time:
            raise ValueError(f"until: found {until:g} s; expected a time after the present one, {self.time:g} s")
        frame = self._run.advance(until)
        return None if frame is None else Frame(frame, self._run.crs)

    def add_mass(self, x, y, mass, velocity=(0.0, 0.0), *, size=None):
        """Adds material from outside: from another model, a person, a sensor. It enters when the run goes on.

        It is booked as what inflows bring: in ``status.mass_in``, and in run.json as what came in. It enters at the end of the
        next step. What is added at the last frame never does. A folder's run that is resumed knows only of what has entered.

        Parameters
        ----------
        x, y : float or array_like, shape (n,)
            Places on the map [m].
        mass : float or array_like, shape (n,)
            Of each, above 0 [kg].
        velocity : array_like, shape (2,) or (n, 2)
            Along the map, x and y [m/s].
        size : float or array_like, optional
            Edge of the square that a mass covers [m]. Default half a cell. Larger ones become several particles.

        Raises
        ------
        DataError
            Where the model takes none (3D points, structured solids), or a place is not on the terrain of the run.
        ValueError
            For numbers that are not finite, masses that are not above 0, or shapes that do not fit.
        RuntimeError
            When the run is at its end. A run that is to wait for more says ``time.stop_at_rest = false``; one without any
            material ends all the same.
        """
        import numpy

        x, y, mass, sizes = numpy.broadcast_arrays(*(numpy.atleast_1d(numpy.asarray(given, dtype=float)) for given in
                                                     (x, y, mass, self._run.cell / 2 if size is None else size)))
        velocity = numpy.asarray(velocity, dtype=float)
        if x.ndim != 1:
            raise ValueError(f"x, y, mass, size: found {x.ndim} dimensions; expected one")
        if velocity.shape not in ((2,), (x.size, 2)):
            raise ValueError(f"velocity: found the shape {velocity.shape}; expected (2,) or ({x.size}, 2)")
        velocity = numpy.broadcast_to(velocity, (x.size, 2))
        for name, numbers in (("x", x), ("y", y), ("mass", mass), ("size", sizes), ("velocity", velocity)):
            if not numpy.isfinite(numbers).all():
                raise ValueError(f"{name}: found a number that is not finite; expected finite ones")
        for name, numbers in (("mass", mass), ("size", sizes)):
            if not (numbers > 0.0).all():
                raise ValueError(f"{name}: found {numbers.min():g}; expected more than 0")
        self._run.add_mass(x, y, mass, velocity[:, 0], velocity[:, 1], sizes)

    @property
    def bed(self):
        """The bed as the flow has it now, with what was eroded and deposited: a `Raster` [m], read-only.

        A node has the mean of the elevation model around it (THEORY (5)), as "elevation" of frames: it differs from
        the model on rough ground, without any erosion. `ground` has the model's own heights.
        On the nodes of the grid, north row first. Between outputs it is that of the last step that was looked at.
        """
        return self._heights("elevation", "bed as the flow has it", self._run.bed())

    @property
    def ground(self):
        """The elevation model's heights as they are now, with what was eroded and deposited: a `Raster` [m], read-only.

        Its difference from the start is "bed_change" of frames; at the end it is "final_elevation" of an erodible bed.
        On the nodes of the grid as `bed`.
        """
        return self._heights("ground", "elevation model, with the bed's change", self._run.ground())

    @staticmethod
    def _heights(name, description, north_up):
        heights = raster.Raster._of(name, "m", description, north_up)
        heights.array.flags.writeable = False
        return heights

    @property
    def crs(self):
        """Of the case, WKT; empty: unknown."""
        return self._run.crs

    def finish(self):
        """Goes on to the end, and returns the result."""
        self._run.advance(float("inf"))
        while not self.over:
            self._run.advance(float("inf"))
        return self.result

    def close(self):
        """Ends the run where it is, unless it is over. Raises what goes wrong meanwhile, as a full disk."""
        self._run.close()

    @property
    def over(self):
        return self._run.over

    @property
    def time(self):
        """[s]"""
        return self._run.status.time

    @property
    def status(self):
        """Sums and extremes of the last step that was looked at."""
        return self._run.status

    @property
    def end(self):
        """Where the run ends at the latest [s]."""
        return self._run.end

    @property
    def warnings(self):
        """Remarks so far."""
        return self._run.remarks

    @property
    def result(self):
        """The `Result`, once the run is over."""
        if not self.over:
            raise RuntimeError("the run goes on; its result is there once it is over: run.finish() goes to the end, "
                               "run.close() ends it where it is")
        if self._result is None:
            self._result = Result(self._run, self._folder)
        return self._result

    def __repr__(self):
        return f"<frana.Run {'over' if self.over else f'at {self.time:g} of {self.end:g} s'}>"
