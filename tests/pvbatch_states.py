"""Loads the states of runs in ParaView, and holds each against the readable Python state that it was made from.

Usage: pvbatch pvbatch_states.py PVSTATES_DIR PICTURES_DIR JOB...

A job is MODE:STATE:RUN_DIR. All are done by one ParaView, which takes as long to start as several states take to load.
MODE full, drawn, plain, searched: checks for the STATE, or without one for every state of RUN_DIR/states but those of
special runs (impact, structure, phases) and of ensembles, that every reader reads a file of this run, and every array
of the state is there: loaded as it is (plain), or with RUN_DIR as data directory (searched); so are the files of the
templates in PVSTATES_DIR. drawn: plain, and the picture equals that of the Python state, and is not blank (flow and
areas are in colour, on grey terrain). full: drawn and searched.
MODE plugin: the reader and the filters of frana_paraview.py on that run (pvbatch_plugin.py). Prints the count of checks
and a sentence for each that failed; exits with 1 when there is one.
"""
import importlib
import os
import sys
import time

from paraview import servermanager, simple
from vtkmodules.vtkIOImage import vtkPNGReader

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import pvbatch_plugin  # noqa: E402

SIZE = [720, 480]
ALONE = {"impact", "structure", "phases", "probability"}  # states of runs of their own
COLOURED = {  # least share of coloured pixels, of those in the middle; a tenth of what the test's run shows
    "overview": 0.02, "stress": 0.02, "profiles": 0.01, "survey": 0.02, "impact": 0.02, "structure": 0.01, "phases": 0.01,
    "budgets": 0.0005, "probability": 0.005}
ARRAYS = {  # what the state's own sources must have made, besides what its readers read
    "overview": ["depth", "surface", "speed"],
    "stress": ["sigma_xx", "sigma_yy", "sigma_xy", "effective_xx", "effective_yy", "principal_1", "principal_2"],
    "profiles": ["distance", "initial_elevation", "drawn_initial_surface", "drawn_surface", "depth"],
    "impact": ["model", "speed", "pressure", "barrier", "to_true_height", "hillshade"],
    "structure": ["damage", "cohesion", "tension", "hillshade"],
    "phases": ["bound_depth", "bound_surface", "water_depth", "hillshade"],
    "probability": ["probability_reached", "elevation", "hillshade"],
    "survey": ["agreement", "extent", "hillshade"],
    "budgets": ["t", "kinetic", "dissipated", "potential_from_start", "max_speed", "front", "mass_error"]}

checks, problems = 0, []


def check(holds, sentence):
    global checks
    checks += 1
    if not holds:
        problems.append(sentence)


def skip_help_texts():
    """A new session makes paraview.simple's functions again, and searches all definitions for the help text of each:
    three fifths of what this test took."""
    of_functions = type(servermanager.ActiveConnection.ProxiesNS.filters)
    if hasattr(of_functions, "getDocumentation"):
        of_functions.getDocumentation = lambda self, name: ""


def fresh():
    simple.ResetSession()
    servermanager.ActiveConnection.Session.GetSessionProxyManager().UnRegisterAllLinks()
    simple._DisableFirstRenderCameraReset()


def pictures_of_all(png):
    """The rows of all layouts' pixels, one layout after the other in the order of their names."""
    layouts = [layout for _, layout in sorted(simple.GetLayouts().items(), key=lambda item: item[0])]
    files = [png] + [png.replace(".png", "_%d.png" % k) for k in range(2, len(layouts) + 1)]
    return [row for file, layout in zip(files, layouts) for row in picture(layout, file)]


def picture(layout, png):
    """The rows of a layout's pixels, each r, g, b, r, ..."""
    layout.SetSize(*SIZE)
    simple.SaveScreenshot(png, layout, SaveAllViews=1, ImageResolution=SIZE)
    reader = vtkPNGReader()
    reader.SetFileName(png)
    reader.Update()
    image = reader.GetOutput()
    parts = image.GetNumberOfScalarComponents()
    colours = bytes(memoryview(image.GetPointData().GetScalars()))
    length = parts * SIZE[0]
    rows = [colours[k:k + length] for k in range(0, len(colours), length)]
    return rows if parts == 3 else [bytes(v for k, v in enumerate(row) if k % parts < 3) for row in rows]


def pixels(row):
    return zip(row[0::3], row[1::3], row[2::3])


def differing(one, other):
    """Share of pixels that differ by more than a tenth of the range in some colour."""
    unlike = [pair for pair in zip(one, other) if pair[0] != pair[1]]
    return sum(max(abs(a - b) for a, b in zip(p, q)) > 25
               for row, as_well in unlike for p, q in zip(pixels(row), pixels(as_well))) / (SIZE[0] * len(one))


def coloured(rows):
    """Share of pixels that are clearly not grey, away from the right edge of each sixth where colour bars stand; every
    fourth row."""
    sixth = SIZE[0] // 6
    middle = [p for row in rows[::4] for k, p in enumerate(pixels(row)) if k % sixth < 0.6 * sixth]
    return sum(max(p) - min(p) > 40 for p in middle) / len(middle)


def files_of(source):
    found = []
    for name in ("FileName", "FileNames"):
        if source.GetProperty(name):
            value = source.GetPropertyValue(name)
            found += [value] if isinstance(value, str) else list(value)
    return found


def arrays_in_sources():
    names = set()
    moment = simple.GetAnimationScene().AnimationTime  # 3D points are not there from the start
    for source in simple.GetSources().values():
        source.UpdatePipeline(moment)
        information = source.GetDataInformation()
        for attributes in (information.GetPointDataInformation(), information.GetCellDataInformation(),
                           information.GetRowDataInformation()):
            names |= {attributes.GetArrayInformation(k).GetName() for k in range(attributes.GetNumberOfArrays())}
    return names


def check_files(state, run_dir, how):
    files = [file for source in simple.GetSources().values() for file in files_of(source)]
    check(len(files) > 0, "%s (%s): reads no file" % (state, how))
    for file in files:
        check(os.path.dirname(os.path.realpath(file)) == os.path.realpath(run_dir) and os.path.exists(file),
              "%s (%s): reads %s; expected a file of %s" % (state, how, file, run_dir))


def check_arrays(state, how):
    arrays = arrays_in_sources()
    for name in ARRAYS[state]:
        check(name in arrays, "%s (%s): no array %s; there are %s" % (state, how, name, ", ".join(sorted(arrays))))


def check_loading(state, states_dir, run_dir, mode, pictures):
    file = os.path.join(run_dir, "states", state + ".pvsm")
    ways = [("plain", file)] if mode != "searched" else []
    if mode in ("full", "searched"):
        ways += [("searched", file), ("template", os.path.join(states_dir, state + ".pvsm"))]
    for how, path in ways:
        fresh()
        moved = {} if how == "plain" else {"data_directory": run_dir, "restrict_to_data_directory": True}
        simple.LoadState(path, **moved)
        drawn = how == "plain" and mode in ("full", "drawn")
        found = pictures_of_all(os.path.join(pictures, state + ".png")) if drawn else []  # before sources are updated
        check_files(state, run_dir, how)
        if how != "template":  # at another run's time and depth there may be nothing to make arrays of
            check_arrays(state, how)
        if drawn:
            check_picture(state, run_dir, pictures, found)


def check_picture(state, run_dir, pictures, found):
    fresh()
    importlib.import_module(state).build(run_dir)
    wanted = pictures_of_all(os.path.join(pictures, state + "_python.png"))
    check(len(found) == len(wanted), "%s: its layouts have %d rows of pixels; expected %d"
          % (state, len(found), len(wanted)))
    share, in_colour = differing(wanted, found), coloured(found)
    print("%s: %.2f %% of the pixels differ from the Python state's, %.2f %% are coloured"
          % (state, 100 * share, 100 * in_colour))
    # The same renderer draws the same scene: lines' edges may differ where ranges were rounded to the state's digits.
    check(share < 0.005, "%s: %.2f %% of the pixels differ from the Python state's picture" % (state, 100 * share))
    check(in_colour > COLOURED[state], "%s: the picture is blank" % state)


def look_at_states(states_dir, pictures, mode, alone, run_dir):
    for state in [alone] if alone else [name for name in ARRAYS if name not in ALONE]:
        file = os.path.join(run_dir, "states", state + ".pvsm")
        check(os.path.exists(file), "%s: not there" % file)
        if os.path.exists(file):
            check_loading(state, states_dir, run_dir, mode, pictures)


def main(states_dir, pictures, jobs):
    sys.path.insert(0, states_dir)
    os.makedirs(pictures, exist_ok=True)
    skip_help_texts()
    for mode, alone, run_dir in jobs:
        before, start = checks, time.process_time()
        if mode == "plugin":
            fresh()
            if alone == "impact":  # a wall from the ground at 20/3 m, half a patch of 0.5 m in it, up to 8.67 m
                pvbatch_plugin.look_at_barriers(check, states_dir, os.path.abspath(run_dir), 20 / 3 - 0.251, 8.671)
            else:
                pvbatch_plugin.look(check, states_dir, os.path.abspath(run_dir))
        else:
            look_at_states(states_dir, pictures, mode, alone, os.path.abspath(run_dir))
        print("%s %s of %s: %d checks, %.1f s" % (mode, alone or "states", run_dir, checks - before,
                                                  time.process_time() - start))
    print("read back by ParaView: %d checks of states and plugin, %d problems" % (checks, len(problems)))
    for problem in problems:
        print(problem)
    return 1 if problems else 0


if __name__ == "__main__":
    jobs = [argument.split(":", 2) for argument in sys.argv[3:]]
    if not jobs or any(len(job) < 3 or job[0] not in ("full", "drawn", "plain", "searched", "plugin") or
                       job[1] not in ALONE | {""} for job in jobs):
        print("usage: pvbatch pvbatch_states.py PVSTATES_DIR PICTURES_DIR MODE:[STATE]:RUN_DIR ...; MODE full, drawn, "
              "plain, searched or plugin", file=sys.stderr)
        sys.exit(2)
    status = main(os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2]), jobs)
    sys.stdout.flush()
    os._exit(status)  # pvbatch's own way out loses the status
