"""Loads the states of a run in ParaView, and holds each against the readable Python state that it was made from.

Usage: pvbatch pvbatch_states.py PVSTATES_DIR RUN_DIR PICTURES_DIR full|plain|searched [STATE]

Checks for every state of RUN_DIR/states but those of special runs (impact, structure, phases) and of ensembles, or for one alone, that every reader reads a file of this run,
and every array of the state is there: loaded as it is (plain), or with RUN_DIR as data directory (searched); so are the
files of the templates in PVSTATES_DIR.
full: both, and the picture equals that of the Python state, and is not blank (flow and areas are in colour, on grey
terrain). Prints the count of checks and a sentence for each that failed; exits with 1 when there is one.
"""
import importlib
import os
import sys

from paraview import servermanager, simple
from vtkmodules.vtkIOImage import vtkPNGReader

SIZE = [900, 600]
ALONE = {"impact", "structure", "phases", "probability"}  # states of runs of their own
COLOURED = {  # least share of coloured pixels, of those in the middle; a tenth of what the test's run shows
    "overview": 0.02, "stress": 0.02, "profiles": 0.01, "survey": 0.02, "impact": 0.02, "structure": 0.01, "phases": 0.01,
    "budgets": 0.0005, "probability": 0.005}
ARRAYS = {  # what the state's own sources must have made, besides what its readers read
    "overview": ["depth", "surface", "speed"],
    "stress": ["sigma_xx", "sigma_yy", "sigma_xy", "effective_xx", "effective_yy", "principal_1", "principal_2"],
    "profiles": ["distance", "elevation", "initial_surface", "surface", "depth"],
    "impact": ["model", "speed", "pressure", "barrier", "hillshade"],
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


def fresh():
    simple.ResetSession()
    servermanager.ActiveConnection.Session.GetSessionProxyManager().UnRegisterAllLinks()
    simple._DisableFirstRenderCameraReset()


def picture(layout, png):
    """The pixels of a layout: rows of r, g, b."""
    layout.SetSize(*SIZE)
    simple.SaveScreenshot(png, layout, SaveAllViews=1, ImageResolution=SIZE)
    reader = vtkPNGReader()
    reader.SetFileName(png)
    reader.Update()
    image = reader.GetOutput()
    parts = image.GetNumberOfScalarComponents()
    colours = bytes(memoryview(image.GetPointData().GetScalars()))
    return [colours[k:k + 3] for k in range(0, len(colours), parts)]


def differing(one, other):
    """Share of pixels that differ by more than a tenth of the range in some colour."""
    return sum(max(abs(a - b) for a, b in zip(p, q)) > 25 for p, q in zip(one, other)) / len(one)


def coloured(pixels):
    """Share of pixels that are clearly not grey, away from the right edge of each half where colour bars stand."""
    width = SIZE[0]
    middle = [p for k, p in enumerate(pixels) if (k % width) % (width // 6) < 0.6 * (width // 6)]
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
    time = simple.GetAnimationScene().AnimationTime  # points in space are not there from the start
    for source in simple.GetSources().values():
        source.UpdatePipeline(time)
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


def check_loading(state, states_dir, run_dir, mode):
    file = os.path.join(run_dir, "states", state + ".pvsm")
    ways = [("plain", file)] if mode != "searched" else []
    ways += [("searched", file), ("template", os.path.join(states_dir, state + ".pvsm"))] if mode != "plain" else []
    for how, path in ways:
        fresh()
        moved = {} if how == "plain" else {"data_directory": run_dir, "restrict_to_data_directory": True}
        simple.LoadState(path, **moved)
        check_files(state, run_dir, how)
        if how != "template":  # at another run's time and depth there may be nothing to make arrays of
            check_arrays(state, how)


def check_picture(state, run_dir, pictures):
    fresh()
    wanted = picture(importlib.import_module(state).build(run_dir), os.path.join(pictures, state + "_python.png"))
    fresh()
    simple.LoadState(os.path.join(run_dir, "states", state + ".pvsm"))
    layouts = list(simple.GetLayouts().values())
    check(len(layouts) == 1, "%s: has %d layouts" % (state, len(layouts)))
    found = picture(layouts[0], os.path.join(pictures, state + ".png"))
    share = differing(wanted, found)
    print("%s: %.2f %% of the pixels differ from the Python state's, %.2f %% are coloured"
          % (state, 100 * share, 100 * coloured(found)))
    # The same renderer draws the same scene: lines' edges may differ where ranges were rounded to the state's digits.
    check(share < 0.005, "%s: %.2f %% of the pixels differ from the Python state's picture" % (state, 100 * share))
    check(coloured(found) > COLOURED[state], "%s: the picture is blank" % state)


def main(states_dir, run_dir, pictures, mode, alone):
    sys.path.insert(0, states_dir)
    os.makedirs(pictures, exist_ok=True)
    for state in alone or [name for name in ARRAYS if name not in ALONE]:
        file = os.path.join(run_dir, "states", state + ".pvsm")
        check(os.path.exists(file), "%s: not there" % file)
        if os.path.exists(file):
            check_loading(state, states_dir, run_dir, mode)
            if mode == "full":
                check_picture(state, run_dir, pictures)
    print("read back by ParaView, states %s: %d checks, %d problems" % (mode, checks, len(problems)))
    for problem in problems:
        print(problem)
    return 1 if problems else 0


if __name__ == "__main__":
    alone = sys.argv[5:]
    if len(sys.argv) < 5 or len(alone) > 1 or not set(alone) <= ALONE or sys.argv[4] not in ("full", "plain", "searched"):
        print("usage: pvbatch pvbatch_states.py PVSTATES_DIR RUN_DIR PICTURES_DIR full|plain|searched [STATE]",
              file=sys.stderr)
        sys.exit(2)
    status = main(*[os.path.abspath(argument) for argument in sys.argv[1:4]], sys.argv[4], alone)
    sys.stdout.flush()
    os._exit(status)  # pvbatch's own way out loses the status
