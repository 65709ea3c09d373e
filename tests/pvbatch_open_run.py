"""Opens a run directory with ParaView and compares what it finds with an expected JSON file.

Usage: pvbatch pvbatch_open_run.py RUN_DIR EXPECTED.json

Prints as JSON what ParaView reports of particles.pvd, grid.pvd, terrain.vti and run.xdmf (the last with two
of its readers): times, and for each frame points, cells, bounds and the range of every component of every
array. Exits with 1 when anything differs from EXPECTED.json, of this layout (tests/pvbatch_make_run.cpp
writes one): {file: {block: {"times": [...], "frames": [{"points", "cells", "bounds", "arrays": {name:
{"components", "ranges", "unit"}}}]}}}. Only what EXPECTED.json names is compared: files, blocks and arrays
beyond it may exist.
"""
import json
import os
import sys

from paraview import servermanager, simple

# Xdmf3 makes no cells for Polyvertex, and neither XDMF reader reads units.
READERS = {
    "particles.pvd": {"pvd": lambda path: simple.PVDReader(FileName=path)},
    "grid.pvd": {"pvd": lambda path: simple.PVDReader(FileName=path)},
    "terrain.vti": {"vti": lambda path: simple.XMLImageDataReader(FileName=[path])},
    "run.xdmf": {
        "xdmf2": lambda path: simple.XDMFReader(FileNames=[path]),
        "xdmf3": lambda path: simple.Xdmf3ReaderS(FileName=[path]),
    },
}


def leaves(data):
    """Data sets of a (possibly composite) data object, in order."""
    if not data.IsA("vtkCompositeDataSet"):
        return [data]
    walker = data.NewIterator()
    found = []
    walker.InitTraversal()
    while not walker.IsDoneWithTraversal():
        found.append(walker.GetCurrentDataObject())
        walker.GoToNextItem()
    return found


def arrays_of(data):
    arrays = {}
    for k in range(data.GetPointData().GetNumberOfArrays()):
        array = data.GetPointData().GetArray(k)
        if not array or array.GetName() == "vtkGhostType":
            continue
        components = range(array.GetNumberOfComponents())
        arrays[array.GetName()] = {
            "components": len(components),
            "ranges": [list(array.GetRange(c)) for c in components],
        }
        unit = data.GetFieldData().GetAbstractArray(array.GetName() + "_unit")
        if unit:
            arrays[array.GetName()]["unit"] = unit.GetValue(0)
    return arrays


def describe(data):
    return {
        "points": data.GetNumberOfPoints(),
        "cells": data.GetNumberOfCells(),
        "bounds": list(data.GetBounds()),
        "arrays": arrays_of(data),
    }


def name_of(data):
    """Which block of the expectation a data set is: by its kind, as readers name their blocks differently."""
    return "grid" if data.IsA("vtkImageData") or data.IsA("vtkRectilinearGrid") else "particles"


def look(reader_name, path):
    """{block: {"times", "frames"}} as one ParaView reader sees the file."""
    file = os.path.basename(path)
    reader = READERS[file][reader_name](path)
    reader.UpdatePipelineInformation()
    times = list(reader.TimestepValues) if reader.TimestepValues else []
    blocks = {}
    for time in times or [0.0]:
        reader.UpdatePipeline(time)
        for data in leaves(servermanager.Fetch(reader)):
            block = "terrain" if file == "terrain.vti" else name_of(data)
            blocks.setdefault(block, {"times": times, "frames": []})["frames"].append(describe(data))
    simple.Delete(reader)
    return blocks


compared = 0  # numbers, names and units


def differences(expected, found, place, skip):
    """Sentences about every number or name of `expected` that `found` does not have."""
    if isinstance(expected, dict):
        problems = []
        for key, value in expected.items():
            if key in skip:
                continue
            if not isinstance(found, dict) or key not in found:
                problems.append("%s: %s is missing" % (place, key))
            else:
                problems += differences(value, found[key], "%s/%s" % (place, key), skip)
        return problems
    if isinstance(expected, list):
        if not isinstance(found, list) or len(found) != len(expected):
            return ["%s: found %.200r, expected %.200r" % (place, found, expected)]
        problems = []
        for k, (one, other) in enumerate(zip(expected, found)):
            problems += differences(one, other, "%s/%d" % (place, k), skip)
        return problems
    global compared
    compared += 1
    if isinstance(expected, (int, float)) and isinstance(found, (int, float)):
        # Values arrive as written; coordinates of an image are origin plus steps: a last digit may differ.
        tolerance = 1e-14 * abs(expected) if "bounds" in place else 0.0
        same = abs(expected - found) <= tolerance
    else:
        same = expected == found
    return [] if same else ["%s: found %r, expected %r" % (place, found, expected)]


def visible_to(reader, blocks):
    """The expectation without what a reader cannot show: XDMF2 reports an error for a mesh of no points."""
    if reader != "xdmf2":
        return blocks
    return {
        name: {**series, "frames": [frame for frame in series["frames"] if frame["points"] > 0]}
        for name, series in blocks.items()
    }


def main(run_dir, expected_file):
    with open(expected_file) as stream:
        expected = json.load(stream)
    found, problems = {}, []
    for file, wanted in expected.items():
        # The Xdmf3 reader aborts on a path without a folder: always absolute.
        path = os.path.join(os.path.abspath(run_dir), file)
        if not os.path.exists(path):
            problems.append("%s: not found" % path)
            continue
        for reader in READERS[file]:
            seen = look(reader, path)
            found["%s by %s" % (file, reader)] = seen
            skip = {"xdmf2": ["unit"], "xdmf3": ["unit", "cells"]}.get(reader, [])
            problems += differences(visible_to(reader, wanted), seen, "%s by %s" % (file, reader), skip)
    print(json.dumps({"found": found, "compared": compared, "problems": problems}, indent=1))
    return 1 if problems else 0


if __name__ == "__main__":
    if len(sys.argv) != 3:
        print("usage: pvbatch pvbatch_open_run.py RUN_DIR EXPECTED.json", file=sys.stderr)
        sys.exit(2)
    status = main(sys.argv[1], sys.argv[2])
    sys.stdout.flush()
    os._exit(status)  # pvbatch's own way out loses the status
