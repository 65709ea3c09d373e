"""frana in ParaView: a reader of a run's run.json, and the filters "Exceedance Above" and "Profile Along Line".

Tools > Manage Plugins > Load New, or in Python, where they get the names of their labels without blanks:

    from paraview import simple
    simple.LoadPlugin("/path/to/frana_paraview.py", remote=False)
    run = simple.FranaRun(FileName="/path/to/RUN_DIR/run.json")
    deep = simple.ExceedanceAbove(Input=simple.OutputPort(run, "grid"), Field="depth", Above=0.5)
    line = simple.ProfileAlongLine(Input=run, Line=simple.OutputPort(run, "profiles"))

ParaView 5.11 of Debian 12 needs the folder paraview_5_11, which lies beside this file, on its PYTHONPATH.

Units (all SI) are in the field data of each output as NAME_unit, and with each array as its UNITS_LABEL.
"""
import bisect
import contextlib
import csv
import json
import math
import os
import xml.etree.ElementTree as tree

from paraview.util.vtkAlgorithm import smdomain, smhint, smproperty, smproxy
from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
from vtkmodules.vtkCommonCore import (
    vtkDataArray, vtkDataArraySelection, vtkDoubleArray, vtkIntArray, vtkObject, vtkOutputWindow, vtkPoints,
    vtkStringArray,
)
from vtkmodules.vtkCommonDataModel import (
    vtkCellArray, vtkDataObject, vtkImageData, vtkPolyData, vtkTable, vtkUnstructuredGrid,
)
from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm, vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkFiltersCore import vtkCellDataToPointData, vtkThreshold
from vtkmodules.vtkFiltersGeneral import vtkWarpScalar
from vtkmodules.vtkIOXML import vtkXMLImageDataReader, vtkXMLPolyDataReader

paraview_plugin_name = "frana"
paraview_plugin_version = "1.0"

HISTORY_UNITS = {
    "t": "s", "dt": "s", "mass": "kg", "mass_left": "kg", "mass_in": "kg", "eroded_mass": "kg", "deposited_mass": "kg",
    "momentum_x": "kg m/s", "momentum_y": "kg m/s", "impulse_x": "kg m/s", "impulse_y": "kg m/s",
    "momentum_residual_x": "kg m/s", "momentum_residual_y": "kg m/s", "kinetic": "J", "potential": "J",
    "dissipated": "J", "energy_left": "J", "energy_residual": "J", "stored": "J", "points_friction": "J",
    "points_walls": "J", "points_material": "J", "points_numerical": "J", "points_volume": "m3", "max_depth": "m",
    "max_speed": "m/s", "mean_speed": "m/s", "max_speed_on_map": "m/s", "covered_area": "m2", "front": "m"}
RESULTS = [  # of run.json: where it stands there, unit
    ("simulated_time", "s"), ("steps", "1"), ("release_volume", "m3"), ("particles/initial", "1"),
    ("particles/final", "1"), ("results/max_depth", "m"), ("results/max_depth_time", "s"), ("results/max_speed", "m/s"),
    ("results/max_speed_time", "s"), ("results/max_front", "m"), ("results/footprint_area", "m2"),
    ("results/footprint_depth", "m"), ("results/final_max_depth", "m"), ("results/peak_pressure", "Pa"),
    ("results/peak_dynamic_pressure", "Pa"), ("budgets/mass/initial", "kg"), ("budgets/mass/final", "kg"),
    ("budgets/mass/left_domain", "kg"), ("budgets/mass/relative_error", "1"), ("budgets/energy/dissipated", "J"),
    ("budgets/energy/residual", "J"), ("wall_seconds/total", "s")]
PORTS = [  # name, type, the series of files that it shows over time
    ("grid", vtkImageData, "grid.pvd"), ("terrain", vtkImageData, None), ("particles", vtkPolyData, "particles.pvd"),
    ("outlines", vtkPolyData, None), ("profiles", vtkPolyData, "profiles.pvd"),
    ("barriers", vtkPolyData, "barriers.pvd"), ("history", vtkTable, None), ("results", vtkTable, None)]
FOOTPRINT, SURVEY = 1, 2  # kinds of outlines
ENDED = ("end", "until", "rest", "left")  # run.json's exit_reason of a run that went to its end
RUNNING = "running"  # of one that goes on, or was killed; nothing else of it is known

GONE = "%s: is not there, but the run names it; copy the whole folder of the run, or run it again"
TORN = "%s: cannot be read; copy the whole folder of the run, or run it again"


class Trouble(Exception):
    """What cannot be shown: one sentence that says what was found, what was expected, what to do."""


def say(sentence, error=True):
    window = vtkOutputWindow.GetInstance()
    (window.DisplayErrorText if error else window.DisplayWarningText)("frana: " + sentence + "\n")


# --- files -----------------------------------------------------------------------------------------------------


def record_of(path):
    """What run.json holds. Raises Trouble."""
    if not path:
        raise Trouble("no file is given; choose the run.json that frana run leaves in its folder")
    if not os.path.exists(path):
        frames = os.path.join(os.path.dirname(path), "grid.pvd")
        if os.path.exists(frames):
            raise Trouble("%s: is not there, only frames are; copy the whole folder of the run, or open %s"
                          % (path, frames))
        raise Trouble("%s: is not there; expected the run.json that frana run leaves in its folder" % path)
    try:
        with open(path, encoding="utf-8") as stream:
            record = json.load(stream)
    except (OSError, ValueError) as problem:
        raise Trouble("%s: cannot be read as JSON (%s); expected the run.json of frana run" % (path, problem))
    if not isinstance(record, dict) or "exit_reason" not in record:
        raise Trouble("%s: has no exit_reason; expected the run.json of frana run" % path)
    return record


def series_of(pvd):
    """[(time [s], file)] of a .pvd in the order of time; empty when it is not there. Raises Trouble."""
    if not os.path.exists(pvd):
        return []
    try:
        entries = [(float(one.get("timestep")), os.path.join(os.path.dirname(pvd), one.get("file")))
                   for one in tree.parse(pvd).getroot().iter("DataSet")]
    except (tree.ParseError, TypeError, ValueError) as problem:
        raise Trouble("%s: is not a collection of frames (%s); run the case again" % (pvd, problem))
    return sorted(entries)


@contextlib.contextmanager
def quiet():
    """VTK's own lines about a damaged file are many; ours is one."""
    before = vtkObject.GetGlobalWarningDisplay()
    vtkObject.GlobalWarningDisplayOff()
    try:
        yield
    finally:
        vtkObject.SetGlobalWarningDisplay(before)


def read(reader, path):
    """The data set in a file, as a copy without the reader. Raises Trouble."""
    if not os.path.exists(path):
        raise Trouble(GONE % path)
    reader.SetFileName(path)
    with quiet():
        done = reader.GetExecutive().Update()
    if not done or reader.GetErrorCode():
        raise Trouble(TORN % path)
    data = reader.GetOutput().NewInstance()
    data.ShallowCopy(reader.GetOutput())
    return data


def extent_of(path):
    """[0, nx - 1, 0, ny - 1, 0, 0] of an image. Raises Trouble."""
    reader = vtkXMLImageDataReader()
    if not os.path.exists(path):
        raise Trouble(GONE % path)
    reader.SetFileName(path)
    with quiet():
        reader.UpdateInformation()
    extent = reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.WHOLE_EXTENT())
    if extent is None:
        raise Trouble(TORN % path)
    return list(extent)


def first_extent(paths):
    """Of the first of some images that can be read. Raises Trouble, that of the last one, when none can."""
    for path in paths:
        try:
            return extent_of(path)
        except Trouble as problem:
            trouble = problem
    raise trouble


# --- data ------------------------------------------------------------------------------------------------------


def add_text(data, name, text):
    """A text in the field data."""
    array = vtkStringArray()
    array.SetName(name)
    array.InsertNextValue(text)
    data.GetFieldData().AddArray(array)


def add_number(data, name, value, unit):
    array = vtkDoubleArray()
    array.SetName(name)
    array.InsertNextValue(value)
    data.GetFieldData().AddArray(array)
    add_text(data, name + "_unit", unit)


def unit_of(data, name):
    found = data.GetFieldData().GetAbstractArray(name + "_unit")
    return found.GetValue(0) if found else ""


def label_units(data, attributes):
    """Gives each array the unit that the field data has for it."""
    for k in range(attributes.GetNumberOfArrays()):
        array = attributes.GetAbstractArray(k)
        unit = unit_of(data, array.GetName())
        if unit and isinstance(array, vtkDataArray):
            array.GetInformation().Set(vtkDataArray.UNITS_LABEL(), unit)


def column(name, values, kind=vtkDoubleArray):
    array = kind()
    array.SetName(name)
    array.SetNumberOfValues(len(values))
    for k, value in enumerate(values):
        array.SetValue(k, value)
    return array


class Field:
    """Numbers at the nodes of an image, bilinear between them."""

    def __init__(self, image):
        self.origin, self.spacing = image.GetOrigin(), image.GetSpacing()
        self.extent = image.GetExtent()
        self.count = image.GetDimensions()
        self.points = image.GetPointData()

    def corners(self, x, y):
        """[(node, weight)] around a place on the map; none outside."""
        u = (x - self.origin[0]) / self.spacing[0] - self.extent[0]
        v = (y - self.origin[1]) / self.spacing[1] - self.extent[2]
        nx, ny = self.count[:2]
        if not (0.0 <= u <= nx - 1 and 0.0 <= v <= ny - 1) or nx < 2 or ny < 2:
            return []
        i, j = min(int(u), nx - 2), min(int(v), ny - 2)
        s, t = u - i, v - j
        around = [(j * nx + i, (1 - s) * (1 - t)), (j * nx + i + 1, s * (1 - t)),
                  ((j + 1) * nx + i, (1 - s) * t), ((j + 1) * nx + i + 1, s * t)]
        around = [(node, weight) for node, weight in around if weight > 0.0]
        outside = self.points.GetArray("outside")
        return [] if outside and any(outside.GetTuple1(node) for node, _ in around) else around

    def at(self, name, corners):
        array = self.points.GetArray(name)
        return sum(weight * array.GetTuple1(node) for node, weight in corners)


def lines_of(rings, kinds):
    """Lines through rings of (x, y, z), closed, with the kind of each."""
    points, cells = vtkPoints(), vtkCellArray()
    points.SetDataTypeToDouble()
    for ring in rings:
        cells.InsertNextCell(len(ring))
        for place in ring:
            cells.InsertCellPoint(points.InsertNextPoint(place))
    data = vtkPolyData()
    data.SetPoints(points)
    data.SetLines(cells)
    data.GetCellData().AddArray(column("outline", kinds, vtkIntArray))
    return data


def rings_of(path, terrain):
    """The rings of a GeoJSON file of polygons, on the terrain. Raises Trouble."""
    rings = []
    try:
        with open(path, encoding="utf-8") as stream:
            document = json.load(stream)
        for feature in document.get("features", []):
            geometry = feature.get("geometry") or {}
            parts = {"Polygon": lambda c: [c], "MultiPolygon": lambda c: c}.get(geometry.get("type"), lambda c: [])
            rings += [[(float(place[0]), float(place[1])) for place in ring]
                      for polygon in parts(geometry.get("coordinates")) for ring in polygon]
    except (OSError, ValueError, TypeError, AttributeError, IndexError):
        raise Trouble("%s: is not a GeoJSON of polygons; copy the whole folder of the run, or run it again" % path)
    field = Field(terrain)
    draped = []
    for ring in rings:
        places = [(x, y, field.corners(x, y)) for x, y in ring]
        known = [field.at("elevation", corners) for _, _, corners in places if corners]
        lowest = min(known) if known else 0.0
        draped.append([(x, y, field.at("elevation", corners) if corners else lowest) for x, y, corners in places])
    return draped


def surveyed_rings(path):
    data = read(vtkXMLPolyDataReader(), path)
    extent = data.GetCellData().GetArray("extent")
    return [[data.GetPoint(data.GetCell(k).GetPointId(n)) for n in range(data.GetCell(k).GetNumberOfPoints())]
            for k in range(data.GetNumberOfCells()) if extent.GetTuple1(k) == 2]


def outlines_of(run_dir, terrain):
    """What was ever covered (outline 1) and what was surveyed (2), on the terrain."""
    rings, kinds = [], []
    footprint, survey = (os.path.join(run_dir, name) for name in ("footprint.geojson", "survey_outlines.vtp"))
    if os.path.exists(footprint) and terrain.GetNumberOfPoints():
        rings += rings_of(footprint, terrain)
        kinds += [FOOTPRINT] * len(rings)
    if os.path.exists(survey):
        surveyed = surveyed_rings(survey)
        rings += surveyed
        kinds += [SURVEY] * len(surveyed)
    data = lines_of(rings, kinds)
    names = vtkStringArray()
    names.SetName("outline_names")
    for name in ("1 simulated footprint", "2 surveyed"):
        names.InsertNextValue(name)
    data.GetFieldData().AddArray(names)
    return data


def table_of(path):
    """history.csv as a table, with units."""
    table = vtkTable()
    if not os.path.exists(path):
        return table
    with open(path, encoding="utf-8") as stream:
        whole = [line for line in stream if line.endswith("\n")]  # a run that goes on may be writing the last one
    rows = [row for row in csv.reader(whole) if row]
    for k, title in enumerate(rows[0] if rows else []):
        name = title.split(" [")[0]
        try:
            table.AddColumn(column(name, [float(row[k]) for row in rows[1:]]))
        except (ValueError, IndexError):
            raise Trouble("%s: has a line that is not of numbers; run the case again" % path)
        add_text(table, name + "_unit", HISTORY_UNITS.get(name, "1"))
    label_units(table, table.GetRowData())
    return table


def results_of(record):
    """The figures of run.json: quantity, value, unit."""
    rows = []
    for place, unit in RESULTS:
        value = record
        for key in place.split("/"):
            value = value.get(key) if isinstance(value, dict) else None
        if isinstance(value, (int, float)):
            rows.append((place, float(value), unit))
    table = vtkTable()
    table.AddColumn(column("quantity", [row[0] for row in rows], vtkStringArray))
    table.AddColumn(column("value", [row[1] for row in rows]))
    table.AddColumn(column("unit", [row[2] for row in rows], vtkStringArray))
    return table


def true_height(barriers):
    """Faces reach into the ground, and above a top that follows it; moved to what is seen of the barrier."""
    if not barriers.GetPointData().GetArray("to_true_height"):
        return barriers
    warp = vtkWarpScalar()
    warp.SetInputData(barriers)
    warp.SetInputArrayToProcess(0, 0, 0, vtkDataObject.FIELD_ASSOCIATION_POINTS, "to_true_height")
    warp.SetUseNormal(1)
    warp.SetNormal(0.0, 0.0, 1.0)
    warp.Update()
    return warp.GetOutput()


# --- the reader --------------------------------------------------------------------------------------------------


@smproxy.reader(name="FranaRun", label="Frana Run", extensions="json", file_description="run of frana (run.json)")
@smproperty.xml("".join('<OutputPort name="%s" index="%d" id="port%d"/>' % (port[0], k, k)
                        for k, port in enumerate(PORTS)))
class FranaRun(VTKPythonAlgorithmBase):
    """All that a run left, by its run.json: an output for each of PORTS, empty where the run has no such files.

    What cannot be read is said in one sentence among ParaView's messages, and the outputs are empty.
    """

    def __init__(self):
        VTKPythonAlgorithmBase.__init__(self, nInputPorts=0, nOutputPorts=len(PORTS))
        self._file, self._record, self._trouble = "", None, False
        self._series, self._times, self._fixed, self._kept = {}, [], {}, {}
        self._parts = vtkDataArraySelection()
        for name, _, series in PORTS:
            if series:
                self._parts.AddArray(name)
        self._parts.AddObserver("ModifiedEvent", lambda *_: self.Modified())

    def FillOutputPortInformation(self, port, info):
        info.Set(vtkDataObject.DATA_TYPE_NAME(), PORTS[port][1].__name__)
        return 1

    @smproperty.stringvector(name="FileName", panel_visibility="never")
    @smdomain.filelist()
    @smhint.filechooser(extensions="json", file_description="run of frana (run.json)")
    def SetFileName(self, name):
        """run.json, or the folder that it lies in."""
        name = "" if not name or name == "None" else name
        name = os.path.join(name, "run.json") if os.path.isdir(name) else name
        if name != self._file:
            self._file = name
            self.Modified()

    @smproperty.doublevector(name="TimestepValues", information_only="1", si_class="vtkSITimeStepsProperty")
    def GetTimestepValues(self):
        return self._times or None

    @smproperty.dataarrayselection(name="Parts")
    def GetParts(self):
        return self._parts

    def _open(self):
        """Reads what does not change with time. Raises Trouble."""
        self._series, self._times, self._fixed, self._kept = {}, [], {}, {}
        self._record = record_of(self._file)
        run_dir = os.path.dirname(os.path.abspath(self._file))
        self._fixed["history"] = table_of(os.path.join(run_dir, "history.csv"))
        self._fixed["results"] = results_of(self._record)
        for name, _, series in PORTS:
            if series:
                self._series[name] = series_of(os.path.join(run_dir, series))
        if not self._series["grid"] and self._record["exit_reason"] == RUNNING:
            raise Trouble("%s: the run has begun and has no frames yet; open it again later" % run_dir)
        if not self._series["grid"]:
            raise Trouble("%s: the run has no frames (grid.pvd), only its history and results can be shown; add "
                          "\"vtk\" to output.formats and run again" % run_dir)
        self._fixed["terrain"] = read(vtkXMLImageDataReader(), os.path.join(run_dir, "terrain.vti"))
        self._fixed["outlines"] = outlines_of(run_dir, self._fixed["terrain"])
        self._times = sorted({time for series in self._series.values() for time, _ in series})

    def RequestInformation(self, request, inInfo, outInfo):
        try:
            self._open()
            extents = self._extents()
            self._warn()
        except Trouble as problem:
            say(str(problem))
            self._series = {name: [] for name, _, series in PORTS if series}
            self._times, extents = [], {}
        executive = vtkStreamingDemandDrivenPipeline
        for port, (name, kind, _) in enumerate(PORTS):
            info = outInfo.GetInformationObject(port)
            info.Remove(executive.TIME_STEPS())
            info.Remove(executive.TIME_RANGE())
            for time in self._times:
                info.Append(executive.TIME_STEPS(), time)
            for time in self._times[:1] + self._times[-1:]:
                info.Append(executive.TIME_RANGE(), time)
            if kind is vtkImageData:
                info.Set(executive.WHOLE_EXTENT(), extents.get(name, [0, -1, 0, -1, 0, -1]), 6)
        return 1

    def _warn(self):
        """Of a run that did not go to its end."""
        reason, time = str(self._record["exit_reason"]), self._record.get("simulated_time")
        if reason == RUNNING:
            say("%s: the run goes on or was killed; these are its frames so far; `frana run CASE --resume --out %s` "
                "goes on" % (self._file, os.path.dirname(self._file) or "."), error=False)
        elif reason not in ENDED:
            when = " at %g s" % time if isinstance(time, (int, float)) else ""
            say("%s: the run did not go to its end (%s%s); its frames up to there are shown"
                % (self._file, reason, when), error=False)

    def _extents(self):
        """Of the images; a grid that grows has its largest. A frame that is missing is told when it is asked for."""
        files = [file for _, file in self._series["grid"]]
        first, last = first_extent(files), first_extent(files[::-1])
        return {"terrain": list(self._fixed["terrain"].GetExtent()),
                "grid": [(max if k % 2 else min)(first[k], last[k]) for k in range(6)]}

    def _frame(self, name, time):
        """The last frame of a series that is not later; None before the first. Raises Trouble."""
        series = self._series.get(name, [])
        number = bisect.bisect_right([when for when, _ in series], time + 1e-9 * max(1.0, abs(time))) - 1
        if number < 0 or not self._parts.ArrayIsEnabled(name):
            return None
        file = series[number][1]
        if self._kept.get(name, ("",))[0] != file:
            data = read(vtkXMLImageDataReader() if name == "grid" else vtkXMLPolyDataReader(), file)
            self._kept[name] = (file, true_height(data) if name == "barriers" else data)
        return self._kept[name][1]

    def RequestData(self, request, inInfo, outInfo):
        asked = request.Get(vtkStreamingDemandDrivenPipeline.FROM_OUTPUT_PORT())
        info = outInfo.GetInformationObject(max(0, asked))
        step = vtkStreamingDemandDrivenPipeline.UPDATE_TIME_STEP()
        time = info.Get(step) if info.Has(step) else (self._times or [0.0])[0]
        for port, (name, kind, series) in enumerate(PORTS):
            output = kind.GetData(outInfo, port)
            try:
                data = self._frame(name, time) if series else self._fixed.get(name)
            except Trouble as problem:
                say(str(problem))
                data = None
            if data is None:
                output.Initialize()
                continue
            output.ShallowCopy(data)
            self._label(output, time)
        return 1

    def _label(self, output, time):
        """Units with the arrays; what run it is."""
        if not output.IsA("vtkTable"):
            label_units(output, output.GetPointData())
            label_units(output, output.GetCellData())
        add_text(output, "run_title", str(self._record.get("title", "")))
        add_text(output, "exit_reason", str(self._record["exit_reason"]))
        output.GetInformation().Set(vtkDataObject.DATA_TIME_STEP(), time)


# --- exceedance --------------------------------------------------------------------------------------------------


def pixels_of(image):
    """The same numbers as the cells of an image: pixels with the nodes in their middles."""
    pixels = vtkImageData()
    dx, dy, _ = image.GetSpacing()
    x, y = (image.GetOrigin()[k] + image.GetExtent()[2 * k] * image.GetSpacing()[k] for k in range(2))
    nx, ny, _ = image.GetDimensions()
    pixels.SetOrigin(x - 0.5 * dx, y - 0.5 * dy, 0.0)
    pixels.SetSpacing(dx, dy, 1.0)
    pixels.SetDimensions(nx + 1, ny + 1, 1)
    for k in range(image.GetPointData().GetNumberOfArrays()):
        array = image.GetPointData().GetAbstractArray(k)
        if array.GetName() != "vtkGhostType":
            pixels.GetCellData().AddArray(array)
    pixels.GetFieldData().ShallowCopy(image.GetFieldData())
    return pixels


def cells_from(data, name, lower):
    """The cells whose `name` is `lower` or more."""
    keep = vtkThreshold()
    keep.SetInputData(data)
    keep.SetInputArrayToProcess(0, 0, 0, vtkDataObject.FIELD_ASSOCIATION_CELLS, name)
    keep.SetThresholdFunction(vtkThreshold.THRESHOLD_UPPER)
    keep.SetUpperThreshold(lower)
    keep.Update()
    return keep.GetOutput()


def next_above(value):
    """The smallest number that is larger (math.nextafter came with Python 3.9)."""
    return math.nextafter(value, math.inf) if hasattr(math, "nextafter") else value + max(abs(value), 1e-300) * 2.3e-16


def draped(cells):
    """On the terrain: corners have the mean elevation of the pixels around that are shown."""
    if not cells.GetNumberOfCells() or not cells.GetCellData().GetArray("elevation"):
        return cells
    corners = vtkCellDataToPointData()
    corners.SetInputData(cells)
    corners.SetProcessAllArrays(False)
    corners.AddCellDataArray("elevation")
    corners.PassCellDataOn()
    warp = vtkWarpScalar()
    warp.SetInputConnection(corners.GetOutputPort())
    warp.SetInputArrayToProcess(0, 0, 0, vtkDataObject.FIELD_ASSOCIATION_POINTS, "elevation")
    warp.Update()
    result = warp.GetOutput()
    result.GetPointData().RemoveArray("elevation")
    return result


def exceeding(image, field, above):
    """The pixels of an image whose `field` is larger than `above`. Raises Trouble."""
    array = image.GetPointData().GetArray(field)
    if not array:
        names = [image.GetPointData().GetArrayName(k) for k in range(image.GetPointData().GetNumberOfArrays())]
        raise Trouble("Exceedance Above: there is no field \"%s\"; expected one of %s" % (field, ", ".join(names)))
    if array.GetNumberOfComponents() != 1:
        raise Trouble("Exceedance Above: %s has %d components; expected a number at each node, such as speed"
                      % (field, array.GetNumberOfComponents()))
    pixels = pixels_of(image)
    if pixels.GetCellData().GetArray("outside"):
        inside = pixels.NewInstance()
        inside.ShallowCopy(pixels)
        inside.GetCellData().AddArray(column("inside", [1 - int(v) for v in _values(pixels, "outside")], vtkIntArray))
        pixels = cells_from(inside, "inside", 0.5)
        pixels.GetCellData().RemoveArray("inside")
    cells = cells_from(pixels, field, next_above(above))
    result = draped(cells)
    dx, dy, _ = image.GetSpacing()
    add_number(result, "area", result.GetNumberOfCells() * dx * dy, "m2")
    add_number(result, "above", above, unit_of(image, field))
    add_text(result, "field", field)
    return result


def _values(data, name):
    array = data.GetCellData().GetArray(name)
    return [array.GetTuple1(k) for k in range(array.GetNumberOfTuples())]


@smproxy.filter(name="FranaExceedance", label="Exceedance Above")
@smproperty.input(name="Input", port_index=0)
@smdomain.datatype(dataTypes=["vtkImageData"], composite_data_supported=False)
class FranaExceedance(VTKPythonAlgorithmBase):
    """The pixels around the nodes whose field is larger than a number, on the terrain; their area in the field data.

    A pixel counts in whole, as in frana's own areas: with Field "peak_depth" at the last time and Above the footprint
    depth of the case, `area` is results/footprint_area of run.json.
    """

    def __init__(self):
        VTKPythonAlgorithmBase.__init__(self, nInputPorts=1, nOutputPorts=1, inputType="vtkImageData",
                                        outputType="vtkUnstructuredGrid")
        self._field, self._above = "peak_depth", 0.1

    @smproperty.stringvector(name="Field", default_values=["peak_depth"])
    @smdomain.xml('<ArrayListDomain name="array_list" attribute_type="Scalars" input_domain_name="input_array">'
                  '<RequiredProperties><Property name="Input" function="Input"/></RequiredProperties>'
                  '</ArrayListDomain>')
    def SetField(self, name):
        self._field = name
        self.Modified()

    @smproperty.doublevector(name="Above", default_values=0.1)
    def SetAbove(self, value):
        self._above = value
        self.Modified()

    def RequestData(self, request, inInfo, outInfo):
        output = vtkUnstructuredGrid.GetData(outInfo, 0)
        image = vtkImageData.GetData(inInfo[0], 0)
        if image.GetNumberOfPoints() == 0:
            return 1
        try:
            result = exceeding(image, self._field, self._above)
        except Trouble as problem:
            say(str(problem))
            return 1
        output.ShallowCopy(result)
        label_units(output, output.GetCellData())
        return 1


# --- profile -----------------------------------------------------------------------------------------------------


def stations(start, end, spacing):
    """Places on a straight line, both ends with them, at equal distances of at most `spacing`."""
    length = math.hypot(end[0] - start[0], end[1] - start[1])
    parts = max(1, math.ceil(length / spacing - 1e-9))
    return [(start[0] + (end[0] - start[0]) * k / parts, start[1] + (end[1] - start[1]) * k / parts)
            for k in range(parts + 1)]


def row_at(field, names, corners, along):
    """What stands at a place; the speed is weighted by depth, as in frana's own profiles."""
    row = {"elevation": field.at("elevation", corners)}
    for name in names:
        row[name] = field.at(name, corners)
    depth = field.points.GetArray("depth")
    shares = [(node, weight * depth.GetTuple1(node)) for node, weight in corners] if depth else []
    wet = sum(share for _, share in shares)
    for name in ("speed", "velocity_along"):
        source = field.points.GetArray("velocity" if name == "velocity_along" else name)
        if not depth or not source:
            continue
        value = (lambda node: source.GetTuple(node)[0] * along[0] + source.GetTuple(node)[1] * along[1]) \
            if name == "velocity_along" else source.GetTuple1
        row[name] = sum(share * value(node) for node, share in shares) / wet if wet > 0.0 else 0.0
    if depth:
        row["surface"] = row["elevation"] + row["depth"]
    if "peak_depth" in row:
        row["peak_surface"] = row["elevation"] + row["peak_depth"]
    return row


PROFILE_FIELDS = ("depth", "peak_depth", "peak_speed")
UNITS = {"distance": "m", "surface": "m", "peak_surface": "m", "velocity_along": "m/s", "elevation": "m", "depth": "m",
         "speed": "m/s", "peak_depth": "m", "peak_speed": "m/s"}


def profile_of(image, lines):
    """Polylines on the bed with what the image has there. lines: lists of (x, y), parts without bed left out."""
    field = Field(image)
    names = [name for name in PROFILE_FIELDS if image.GetPointData().GetArray(name)]
    points, cells, rows, numbers = vtkPoints(), vtkCellArray(), [], []
    points.SetDataTypeToDouble()
    for number, line in enumerate(lines):
        distance, places = 0.0, []
        for k, (x, y) in enumerate(line):
            if k:
                distance += math.hypot(x - line[k - 1][0], y - line[k - 1][1])
            corners = field.corners(x, y)
            if not corners:
                continue
            one, other = (line[k], line[k + 1]) if k + 1 < len(line) else (line[k - 1], line[k])
            length = math.hypot(other[0] - one[0], other[1] - one[1]) or 1.0
            row = row_at(field, names, corners, ((other[0] - one[0]) / length, (other[1] - one[1]) / length))
            places.append(points.InsertNextPoint(x, y, row["elevation"]))
            rows.append(dict(row, distance=distance))
        if len(places) > 1:
            cells.InsertNextCell(len(places))
            for place in places:
                cells.InsertCellPoint(place)
            numbers.append(number)
    data = vtkPolyData()
    data.SetPoints(points)
    data.SetLines(cells)
    data.GetCellData().AddArray(column("profile", numbers, vtkIntArray))
    for name in rows[0] if rows else []:
        data.GetPointData().AddArray(column(name, [row[name] for row in rows]))
        add_text(data, name + "_unit", UNITS[name])
    label_units(data, data.GetPointData())
    return data


def places_in(lines):
    """[[(x, y)]] of the lines of a data set."""
    found = []
    for k in range(lines.GetNumberOfCells()):
        cell = lines.GetCell(k)
        if cell.GetNumberOfPoints() > 1:
            found.append([lines.GetPoint(cell.GetPointId(n))[:2] for n in range(cell.GetNumberOfPoints())])
    return found


@smproxy.filter(name="FranaProfile", label="Profile Along Line")
@smproperty.input(name="Line", port_index=1)
@smdomain.datatype(dataTypes=["vtkPolyData"], composite_data_supported=False)
@smhint.xml("<Optional/>")
@smproperty.input(name="Input", port_index=0)
@smdomain.datatype(dataTypes=["vtkImageData"], composite_data_supported=False)
class FranaProfile(VTKPythonAlgorithmBase):
    """Bed, surface, depth and speed along a line at the time that is shown, and the peaks up to then.

    The line: that of the optional input Line (the run's output "profiles" has the case's), its points as they are; else
    a straight one from Start to End [m, map], at stations of Spacing [m] (0: half a cell). Without a line, Start equal
    to End, it is the middle of the map from west to east. Plot the result over `distance`.
    """

    def __init__(self):
        VTKPythonAlgorithmBase.__init__(self, nInputPorts=2, nOutputPorts=1, inputType="vtkImageData",
                                        outputType="vtkPolyData")
        self._start, self._end, self._spacing = (0.0, 0.0), (0.0, 0.0), 0.0

    def FillInputPortInformation(self, port, info):
        info.Set(vtkAlgorithm.INPUT_REQUIRED_DATA_TYPE(), "vtkImageData" if port == 0 else "vtkPolyData")
        if port == 1:
            info.Set(vtkAlgorithm.INPUT_IS_OPTIONAL(), 1)
        return 1

    @smproperty.doublevector(name="Start", default_values=[0.0, 0.0])
    def SetStart(self, x, y):
        self._start = (x, y)
        self.Modified()

    @smproperty.doublevector(name="End", default_values=[0.0, 0.0])
    def SetEnd(self, x, y):
        self._end = (x, y)
        self.Modified()

    @smproperty.doublevector(name="Spacing", default_values=0.0)
    def SetSpacing(self, spacing):
        self._spacing = spacing
        self.Modified()

    def _lines(self, image, given):
        if given:
            return places_in(given)
        start, end = self._start, self._end
        if start == end:
            bounds = image.GetBounds()
            middle = 0.5 * (bounds[2] + bounds[3])
            start, end = (bounds[0], middle), (bounds[1], middle)
        return [stations(start, end, self._spacing if self._spacing > 0.0 else 0.5 * image.GetSpacing()[0])]

    def RequestData(self, request, inInfo, outInfo):
        image = vtkImageData.GetData(inInfo[0], 0)
        given = vtkPolyData.GetData(inInfo[1], 0) if inInfo[1].GetNumberOfInformationObjects() else None
        output = vtkPolyData.GetData(outInfo, 0)
        if image.GetNumberOfPoints() == 0:
            return 1
        if not image.GetPointData().GetArray("elevation"):
            say("Profile Along Line: the input has no elevation; expected the output \"grid\" of a Frana Run, or "
                "grid.pvd")
            return 1
        if given and not given.GetNumberOfCells():
            say("Profile Along Line: the input Line has no lines; disconnect it, or give a [[profile]]")
            return 1
        profile = profile_of(image, self._lines(image, given))
        if profile.GetNumberOfPoints() < 2:
            say("Profile Along Line: the line has no two places on the terrain (x %.0f to %.0f, y %.0f to %.0f); give "
                "Start and End within it" % image.GetBounds()[:4])
        output.ShallowCopy(profile)
        return 1
