"""What goes wrong, and whose fault it is: the program's exit codes as exceptions."""
import re

_PLACED = re.compile(r"(?:(?P<file>.*?)(?::(?P<line>\d+))?: |--set )(?P<key>[a-z_0-9]+(?:\.[a-z_0-9]+)*): (?P<sentence>.*)", re.S)
_POINT = re.compile(r"point at \(([^)]*)\)|node \(([^)]*)\)|particle (\d+)")


class Error(Exception):
    """Anything that frana refuses or cannot do."""


class Problem(str):
    """A sentence on what is wrong, with its place in the case.

    Attributes
    ----------
    key : str or None
        The key of the case, "release.0.depth".
    line : int or None
        Its line in the case file, counted from 1; None for what ``set`` or ``case[key]`` gave.
    sentence : str
        What was found, what was expected, what to do.
    """

    def __new__(cls, text):
        problem = super().__new__(cls, text)
        problem.key, problem.line, problem.sentence = None, None, text
        placed = _PLACED.fullmatch(text)
        if placed and (placed["line"] or text.startswith("--set ")):
            problem.key, problem.sentence = placed["key"], placed["sentence"]
            problem.line = int(placed["line"]) if placed["line"] else None
        return problem


class _Refused(Error):
    def __init__(self, problems):
        self.problems = [Problem(problem) for problem in problems]
        super().__init__("\n".join(self.problems))

    def __reduce__(self):
        return type(self), ([str(problem) for problem in self.problems],)


class CaseError(_Refused):
    """A case that cannot run. ``problems`` is a list of `Problem`, all that were found at once."""


class DataError(_Refused):
    """Files and folders that cannot be used. ``problems`` is a list of `Problem`."""


class NumericsError(Error):
    """The computation left the numbers it can stand for. What was reached is in the run's folder and result.

    Attributes
    ----------
    step : int or None
    time : float or None
        [s]
    point : tuple of float or None
        Place on the map, in 3D with its elevation [m]; of free water the node's numbers, of particles their id.
    value : float or None
        The depth there [m].
    """

    def __init__(self, text):
        super().__init__(text)

        def number(pattern, kind):
            found = re.search(pattern, text)
            return kind(found[1]) if found else None

        self.step = number(r"step (\d+)", int)
        self.time = number(r"\bt = ([-+.\deE]+) s", float)
        self.value = number(r"depth ([-+.\deEnaif]+) m", float)
        point = _POINT.search(text)
        self.point = tuple(float(x) for x in next(filter(None, point.groups())).split(",")) if point else None


def of_problems(problems):
    """The exception that tells of problems of a case, its files or its folder."""
    error = CaseError(problems)
    return error if any(problem.key for problem in error.problems) else DataError(problems)


def of_numerics(text):
    return NumericsError(text)
