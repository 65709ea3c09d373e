"""Loads pvstates/frana_paraview.py into ParaView and holds what it reads against the files of a run.
Called by pvbatch_states.py."""
import csv
import inspect
import json
import math
import os
import runpy
import shutil
import tempfile
import xml.etree.ElementTree as tree

from paraview import servermanager, simple
from vtkmodules.vtkCommonCore import vtkDataArray, vtkOutputWindow, vtkStringOutputWindow

PORTS = ["grid", "terrain", "particles", "outlines", "profiles", "barriers", "history", "results"]
UNITS = {"grid": {"elevation": "m", "depth": "m", "speed": "m/s", "velocity": "m/s", "stress": "Pa", "peak_depth": "m"},
         "particles": {"mass": "kg", "depth": "m", "velocity": "m/s"}, "terrain": {"slope": "degree"},
         "profiles": {"distance": "m", "velocity_along": "m/s"}}


def load(states_dir):
    """As in ParaView 5.11 on Debian 12, with what lies beside the plugin for it; others have what it needs."""
    if not hasattr(inspect, "getargspec"):
        runpy.run_path(os.path.join(states_dir, "paraview_5_11", "sitecustomize.py"))
    if not hasattr(simple, "FranaRun"):
        simple.LoadPlugin(os.path.join(states_dir, "frana_paraview.py"), remote=False)


def numbers(data, name, where="Point"):
    array = getattr(data, "Get%sData" % where)().GetArray(name)
    return [] if not array else [array.GetTuple(k) for k in range(array.GetNumberOfTuples())]


def at(run, port, time):
    run.UpdatePipeline(time)
    return servermanager.Fetch(run, idx=PORTS.index(port))


def times_of(pvd):
    return [float(one.get("timestep")) for one in tree.parse(pvd).getroot().iter("DataSet")]


def look(check, states_dir, run_dir):
    """Times, units, values, areas and lines of a run that has everything but barriers; what is said of bad folders."""
    load(states_dir)
    with open(os.path.join(run_dir, "run.json")) as stream:
        record = json.load(stream)
    run = simple.OpenDataFile(os.path.join(run_dir, "run.json"))
    times = times_of(os.path.join(run_dir, "grid.pvd"))
    check(list(run.TimestepValues) == times, "plugin: times %s; expected %s" % (list(run.TimestepValues), times))
    look_at_units(check, run, times)
    look_at_values(check, run, run_dir, times)
    look_at_tables(check, run, run_dir, record)
    look_at_exceedance(check, run, times, record)
    look_at_profiles(check, run, times)
    look_at_outlines(check, run, run_dir, times)
    look_at_bad_folders(check, run_dir, times)


def look_at_units(check, run, times):
    for port, units in UNITS.items():
        data = at(run, port, times[-1])
        for name, unit in units.items():
            array = data.GetPointData().GetArray(name)
            found = array.GetInformation().Get(vtkDataArray.UNITS_LABEL()) if array else "no array"
            check(found == unit, "plugin: unit of %s of %s: %s; expected %s" % (name, port, found, unit))
            text = data.GetFieldData().GetAbstractArray(name + "_unit")
            check(text is not None and text.GetValue(0) == unit, "plugin: no %s_unit in the field data" % name)


def look_at_values(check, run, run_dir, times):
    """The same numbers as ParaView's own readers have, at every time; nothing of an earlier one is kept."""
    for port, names in (("grid", ["depth", "velocity", "peak_depth"]), ("particles", ["mass", "speed"]),
                        ("profiles", ["surface", "initial_surface"])):
        plain = simple.PVDReader(FileName=os.path.join(run_dir, port + ".pvd"))
        for time in [times[0], times[-1], times[1]]:
            plain.UpdatePipeline(time)
            wanted, found = servermanager.Fetch(plain), at(run, port, time)
            for name in names:
                check(numbers(found, name) == numbers(wanted, name) != [],
                      "plugin: %s of %s at %g s differs from %s.pvd" % (name, port, time, port))
        simple.Delete(plain)


def look_at_tables(check, run, run_dir, record):
    history, results = at(run, "history", 0.0), at(run, "results", 0.0)
    with open(os.path.join(run_dir, "history.csv")) as stream:
        rows = list(csv.DictReader(stream))
    for name in ("t", "max_depth", "mass_error", "kinetic"):
        column = history.GetColumnByName(name)
        check(column is not None and [column.GetValue(k) for k in range(column.GetNumberOfTuples())]
              == [float(row[name]) for row in rows], "plugin: %s of history.csv differs" % name)
        check(history.GetFieldData().GetAbstractArray(name + "_unit") is not None, "plugin: no unit of %s" % name)
    found = {results.GetValue(k, 0).ToString(): results.GetValue(k, 1).ToDouble()
             for k in range(results.GetNumberOfRows())}
    for quantity, value in (("results/max_depth", record["results"]["max_depth"]),
                            ("simulated_time", record["simulated_time"])):
        check(found.get(quantity) == value, "plugin: %s is %s; expected %s" % (quantity, found.get(quantity), value))


def look_at_exceedance(check, run, times, record):
    """Areas count whole pixels, as those of the rasters in run.json do."""
    cell = record["grid"]["cell"]
    ground = at(run, "terrain", times[-1]).GetPointData().GetArray("elevation").GetRange()
    deep = simple.ExceedanceAbove(Input=simple.OutputPort(run, "grid"))
    for field, above in (("peak_depth", record["results"]["footprint_depth"]), ("depth", 1.0), ("depth", 1e6)):
        deep.Field, deep.Above = field, above
        deep.UpdatePipeline(times[-1])
        found = servermanager.Fetch(deep)
        values = [value for value, in numbers(at(run, "grid", times[-1]), field)]
        count = sum(value > above for value in values)
        area = found.GetFieldData().GetArray("area").GetTuple1(0)
        check(found.GetNumberOfCells() == count, "plugin: %s above %g: %d cells; expected %d"
              % (field, above, found.GetNumberOfCells(), count))
        check(math.isclose(area, count * cell * cell, rel_tol=1e-12), "plugin: area %g of %d cells" % (area, count))
        if field == "peak_depth":
            check(math.isclose(area, record["results"]["footprint_area"], rel_tol=1e-9) and count > 100,
                  "plugin: area %g; run.json has %g" % (area, record["results"]["footprint_area"]))
            heights = [value for value, in numbers(found, "elevation", "Cell")]
            check(len(heights) == count and ground[0] <= min(heights) < max(heights) <= ground[1],
                  "plugin: exceedance has %d elevations of %d pixels, or some off the terrain" % (len(heights), count))


def look_at_profiles(check, run, times):
    """frana samples the frame in double precision, the filter its file in single."""
    def compare(found, wanted, how):
        for name in ("distance", "elevation", "depth", "surface", "velocity_along"):
            one, other = numbers(found, name), numbers(wanted, name)
            worst = max((abs(a - b) for (a,), (b,) in zip(one, other)), default=math.inf)
            check(len(one) == len(other) and worst < 2e-4, "plugin: %s along %s differs by %g" % (name, how, worst))

    time = times[len(times) // 2]
    line = simple.ProfileAlongLine(Input=run, Line=simple.OutputPort(run, "profiles"))
    line.UpdatePipeline(time)
    found, wanted = servermanager.Fetch(line), at(run, "profiles", time)
    compare(found, wanted, "the case's profiles")
    check(found.GetNumberOfCells() == wanted.GetNumberOfCells(), "plugin: %d profiles" % found.GetNumberOfCells())
    peaks = numbers(found, "peak_surface")
    check(all(peak >= surface - 1e-3 for (peak,), (surface,) in zip(peaks, numbers(found, "surface"))) and peaks,
          "plugin: peaks lie below the surface")
    last = wanted.GetCell(wanted.GetNumberOfCells() - 1)
    ends = [last.GetPoints().GetPoint(k)[:2] for k in (0, last.GetNumberOfPoints() - 1)]
    straight = simple.ProfileAlongLine(Input=run, Start=ends[0], End=ends[1])
    straight.UpdatePipeline(time)
    alone = simple.Threshold(Input=simple.OutputPort(run, "profiles"))
    alone.Scalars = ["CELLS", "profile"]
    alone.LowerThreshold = alone.UpperThreshold = float(wanted.GetNumberOfCells() - 1)
    alone.UpdatePipeline(time)
    compare(servermanager.Fetch(straight), servermanager.Fetch(alone), "a straight line")
    alone.LowerThreshold = alone.UpperThreshold = -1.0
    surface = simple.ExtractSurface(Input=alone)
    said = said_by(lambda: simple.ProfileAlongLine(Input=run, Line=surface).UpdatePipeline(time))
    check(len(said) == 1 and "the input Line has no lines" in said[0], "plugin: of no lines it says %s" % said)


def look_at_outlines(check, run, run_dir, times):
    found = at(run, "outlines", times[0])
    kinds = [int(kind) for kind, in numbers(found, "outline", "Cell")]
    check(set(kinds) == {1, 2}, "plugin: outlines of kinds %s; expected 1 and 2" % sorted(set(kinds)))
    with open(os.path.join(run_dir, "footprint.geojson")) as stream:
        text = stream.read()
    check(kinds.count(1) == sum(len(polygon) for feature in json.loads(text)["features"] for polygon in
                                ([feature["geometry"]["coordinates"]] if feature["geometry"]["type"] == "Polygon"
                                 else feature["geometry"]["coordinates"])),
          "plugin: rings of the footprint are missing")
    terrain = at(run, "terrain", times[0]).GetPointData().GetArray("elevation").GetRange()
    check(terrain[0] <= found.GetBounds()[4] < found.GetBounds()[5] <= terrain[1],
          "plugin: outlines at %s, off the terrain at %s" % (found.GetBounds()[4:], terrain))


def look_at_barriers(check, states_dir, run_dir, lowest, highest):
    """Faces that reach into the ground end there."""
    load(states_dir)
    run = simple.FranaRun(FileName=run_dir)
    run.UpdatePipelineInformation()
    bounds = at(run, "barriers", run.TimestepValues[-1]).GetBounds()
    check(lowest <= bounds[4] <= bounds[5] <= highest,
          "plugin: barriers from %g to %g m; expected %g to %g" % (bounds[4], bounds[5], lowest, highest))


def said_by(action):
    """What comes among ParaView's messages meanwhile: the lines."""
    window, before = vtkStringOutputWindow(), vtkOutputWindow.GetInstance()
    vtkOutputWindow.SetInstance(window)
    try:
        action()
    finally:
        vtkOutputWindow.SetInstance(before)
    return [line for line in window.GetOutput().splitlines() if line.strip()]


def said_of(run_json, time=None):
    """What the reader says of a file: the lines; and the times that it has."""
    times = []

    def open_it():
        run = simple.FranaRun(FileName=run_json)
        run.UpdatePipeline() if time is None else run.UpdatePipeline(time)
        times.extend(run.TimestepValues or [])
        simple.Delete(run)

    return said_by(open_it), times


def look_at_bad_folders(check, run_dir, times):
    with tempfile.TemporaryDirectory() as folder:
        def copy(name, *files):
            target = os.path.join(folder, name)
            os.mkdir(target)
            for file in files:
                os.symlink(os.path.join(run_dir, file), os.path.join(target, file))
            return os.path.join(target, "run.json")

        def with_frames(name):
            """A copy whose frames are its own."""
            run_json = copy(name, "grid.pvd", "terrain.vti", "history.csv", "run.json")
            shutil.copytree(os.path.join(run_dir, "grid"), os.path.join(folder, name, "grid"))
            return run_json, [os.path.join(folder, name, "grid", "grid_%06d.vti" % k) for k in range(len(times))]

        def copy_with(name, record):
            run_json = copy(name, *everything)
            with open(run_json, "w") as stream:
                json.dump(record, stream)
            return run_json

        everything = ["grid.pvd", "grid", "terrain.vti", "history.csv"]
        torn = copy("torn", *everything)
        with open(torn, "w") as stream:
            stream.write('{"version": "1", "exit_')
        killed = copy_with("killed", {"exit_reason": "running", "others": {}})
        unwhole = copy("unwhole", *everything, "run.json")
        with open(os.path.join(folder, "unwhole", "footprint.geojson"), "w") as stream:
            stream.write('{"type": "FeatureCollection", "feat')
        lost, frames = with_frames("lost")
        os.remove(frames[1])
        last, frames = with_frames("last")
        os.remove(frames[-1])
        cut, frames = with_frames("cut")
        os.truncate(frames[0], 300)
        for run_json, time, shown, part in (
                (copy("empty"), None, False, "is not there; expected the run.json that frana run leaves"),
                (copy("frames", *everything), None, False, "is not there, only frames are"),
                (killed, None, True, "the run goes on or was killed; these are its frames so far"),
                (copy("no_frames", "run.json", "history.csv"), None, False, "has no frames (grid.pvd)"),
                (copy("no_terrain", "run.json", "grid.pvd", "grid"), None, False, "terrain.vti: is not there"),
                (torn, None, False, "cannot be read as JSON"),
                (copy_with("other", [1, 2]), None, False, "has no exit_reason"),
                (unwhole, None, False, "is not a GeoJSON of polygons"),
                (copy_with("interrupted", {"exit_reason": "interrupted", "simulated_time": 7.5}), None, True,
                 "did not go to its end (interrupted at 7.5 s)"),
                (lost, times[1], True, "grid_000001.vti: is not there"),
                (last, times[-1], True, "grid_%06d.vti: is not there" % (len(times) - 1)),
                (cut, times[0], True, "grid_000000.vti: cannot be read")):
            said, found = said_of(run_json, time)
            name = os.path.relpath(run_json, folder)
            check(len(said) == 1 and part in said[0] and said[0].startswith("frana: " + folder),
                  "plugin: of %s it says %s; expected one line with \"%s\"" % (name, said, part))
            check(found == (times if shown else []), "plugin: of %s it has the times %s" % (name, found))
        check(said_of(last, times[0])[0] == [], "plugin: complains of a frame that is not asked for")
