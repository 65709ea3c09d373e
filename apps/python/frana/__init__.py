"""frana: flow-like landslides, from an elevation model and a release.

>>> import frana
>>> case = frana.Case("case.toml")
>>> case["material.bed.mu"] = 0.2
>>> with case.run("out/mine", progress=print) as run:
...     for frame in run:
...         depth = frame.grid["depth"]       # (ny, nx), south row first [m]
>>> run.result.peak_depth                     # a Raster: array north row first, transform, crs

Numbers are in SI units; depths are vertical, speeds along the bed. Keys of a case: ``print(frana.describe())``.
"""
import atexit as _atexit
import os as _os


def _load():
    """Threads of OpenMP sleep soon, as in the program, unless the environment has a wish of its own."""
    own = "OMP_WAIT_POLICY" not in _os.environ and "GOMP_SPINCOUNT" not in _os.environ
    if own:
        _os.environ["GOMP_SPINCOUNT"] = "1000"  # read once, when the runtime is loaded
    try:
        from . import _frana
    finally:
        if own:
            del _os.environ["GOMP_SPINCOUNT"]
    return _frana


_frana = _load()
_atexit.register(_frana.end_all)  # a thread that steps a run beyond this would abort the process
from .case import Case, Check  # noqa: E402
from .ensemble import Ensemble, EnsembleFolder, EnsembleProgress, is_ensemble as _is_ensemble  # noqa: E402
from .errors import CaseError, DataError, Error, NumericsError, Problem  # noqa: E402
from .folder import Folder  # noqa: E402
from .raster import Affine, Raster  # noqa: E402
from .run import Frame, Progress, Result, Run  # noqa: E402

__version__ = _frana.version
__all__ = ["Affine", "Case", "CaseError", "Check", "DataError", "Ensemble", "EnsembleFolder", "EnsembleProgress", "Error",
           "Folder", "Frame", "NumericsError", "Problem", "Progress", "Raster", "Result", "Run", "describe", "keys", "open"]


def open(path):
    """The `Folder` of a run, finished or running, or the `EnsembleFolder` of an ensemble."""
    return EnsembleFolder(path) if _is_ensemble(path) else Folder(path)


def describe(key=""):
    """Meaning, unit, range and default of a key, or of all keys that begin so; as text."""
    return _frana.describe(key)


def keys():
    """All keys of a case file, repeated tables without their numbers."""
    return _frana.keys()
