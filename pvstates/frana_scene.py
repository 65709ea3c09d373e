"""What frana's ParaView states are made of: terrain with relief, flow on it, outlines, charts, cameras.

Colour ranges, cameras and sizes come from RUN_DIR/states/look.json, which `frana run` and `frana states` write
(run/folder/look.h tells what is in it). The modules overview, stress, profiles, survey and budgets build one state
each from these parts; make_states.py saves them as the .pvsm templates that lie beside this file.
"""
import json
import os

from paraview.simple import (
    AddCameraLink, AnnotateTimeFilter, AssignViewToLayout, Clip, ColorBy, Contour, CreateLayout, CreateRenderView,
    CreateView, GetAnimationScene, GetColorTransferFunction, GetScalarBar, PVDReader, RenameView, Show, Text,
    WarpByScalar, XMLImageDataReader,
)

BLACK, WHITE = [0.0, 0.0, 0.0], [1.0, 1.0, 1.0]
BLUE, ORANGE, GREEN, VERMILION, YELLOW, GREY = (  # Okabe & Ito (2008): told apart by all eyes
    [0.0, 0.447, 0.698], [0.902, 0.624, 0.0], [0.0, 0.62, 0.451], [0.835, 0.369, 0.0], [0.941, 0.894, 0.259],
    [0.45, 0.45, 0.45])


class NoState(Exception):
    """A state that a run has not the files for; the text says which, and what to do."""


class Look(dict):
    """A part of look.json. Raises NoState for a key that is not there: an older frana did not write it."""

    def __init__(self, run_dir, entries):
        dict.__init__(self, entries)
        self.run_dir = run_dir

    def __missing__(self, key):
        raise NoState("%s: was written by an older frana (it has no %s); run: frana states %s"
                      % (os.path.join(self.run_dir, "states", "look.json"), key, self.run_dir))


def look_of(run_dir, state):
    """The run's look. Raises NoState when `state` cannot be shown."""
    path = os.path.join(run_dir, "states", "look.json")
    if not os.path.exists(path):
        raise NoState("%s: is not there; make it with: frana states %s" % (path, run_dir))
    with open(path) as stream:
        look = json.load(stream, object_hook=lambda entries: Look(run_dir, entries))
    why_not = look["states"][state]
    if why_not:
        raise NoState("%s: no state \"%s\": %s" % (run_dir, state, why_not))
    return look


# --- views -----------------------------------------------------------------------------------------------------


def render_view(layout, place, name, camera, flat, scale="scale"):
    """A white view at a place of the layout, from above in parallel (flat) or in perspective."""
    view = CreateRenderView()
    RenameView(name, view)
    AssignViewToLayout(view, layout, place)
    view.UseColorPaletteForBackground = 0
    view.Background = WHITE
    view.OrientationAxesVisibility = 0
    view.CameraPosition, view.CameraFocalPoint = camera["position"], camera["focal"]
    view.CameraViewUp, view.CameraViewAngle = camera["up"], camera["angle"]
    view.CenterOfRotation = camera["focal"]
    view.CameraParallelProjection = 1 if flat else 0
    view.CameraParallelScale = camera[scale]
    return view


def chart_view(layout, place, name, title, x_title, y_title, legend=True):
    view = CreateView("XYChartView")
    RenameView(name, view)
    AssignViewToLayout(view, layout, place)
    view.ChartTitle, view.BottomAxisTitle, view.LeftAxisTitle = title, x_title, y_title
    view.ChartTitleFontSize = view.BottomAxisTitleFontSize = view.LeftAxisTitleFontSize = 13
    view.LegendLocation = "TopRight"
    view.ShowLegend = 1 if legend else 0
    view.LegendFontSize = 12
    return view


def link_cameras(views):
    for k, view in enumerate(views[1:]):
        AddCameraLink(views[0], view, "cameras %d" % (k + 1))


def heading(view, text, name=None):
    """A line of text at the top of a view; `name` of its source, the text when None."""
    source = Text(registrationName=name or text)
    source.Text = text
    place_text(Show(source, view), "Upper Center")


def clock(view, source):
    """The time, at the upper left."""
    annotation = AnnotateTimeFilter(registrationName="clock", Input=source)
    annotation.Format = "t = {time:.1f} s"
    place_text(Show(annotation, view), "Upper Left Corner")


def place_text(display, place):
    display.Color, display.FontSize, display.WindowLocation = BLACK, 15, place


def at_time(views, time):
    """Shows the whole animation in the run's own times, and stands at one of them."""
    scene = GetAnimationScene()
    scene.UpdateAnimationUsingDataTimeSteps()
    scene.AnimationTime = time
    for view in views:
        view.ViewTime = time


# --- sources ---------------------------------------------------------------------------------------------------


def open_grid(run_dir):
    return PVDReader(registrationName="grid", FileName=os.path.join(run_dir, "grid.pvd"))


def terrain_surface(run_dir):
    """The bed as a surface."""
    terrain = XMLImageDataReader(registrationName="terrain", FileName=[os.path.join(run_dir, "terrain.vti")])
    warped = WarpByScalar(registrationName="terrain surface", Input=terrain)
    warped.Scalars = ["POINTS", "elevation"]
    return warped


def flow_surface(grid, look):
    """The free surface where the flow is deeper than look["thin"]."""
    lifted = WarpByScalar(registrationName="free surface", Input=grid)
    lifted.Scalars = ["POINTS", "surface"]
    flow = Clip(registrationName="flow", Input=lifted)
    flow.ClipType, flow.Scalars, flow.Value, flow.Invert = "Scalar", ["POINTS", "depth"], look["thin"], 0
    return flow, flow_edge(lifted, look)


def flow_edge(lifted, look):
    """The line at the margin of the flow."""
    edge = Contour(registrationName="margin", Input=lifted)
    edge.ContourBy, edge.Isosurfaces = ["POINTS", "depth"], [look["thin"]]
    edge.ComputeScalars = 0
    return edge


# --- displays --------------------------------------------------------------------------------------------------


def show_terrain(surface, view):
    """Grey by its own relief shading, no lamp of the view's on top."""
    display = Show(surface, view)
    ColorBy(display, ("POINTS", "hillshade"))
    greys = GetColorTransferFunction("hillshade")
    greys.RGBPoints = [-0.4, 0.0, 0.0, 0.0, 1.15, 1.0, 1.0, 1.0]
    greys.ColorSpace = "RGB"
    greys.AutomaticRescaleRangeMode = "Never"
    without_lamp(display)
    display.SetScalarBarVisibility(view, False)
    return display


def without_lamp(display):
    display.Ambient, display.Diffuse, display.Specular = 1.0, 0.0, 0.0


def show_line(source, view, height, colour=BLACK, width=1.5):
    """A line drawn `height` [m] above where it is."""
    display = Show(source, view)
    display.ColorArrayName = [None, ""]  # ColorBy(display, None) fails on data without arrays
    display.AmbientColor = display.DiffuseColor = colour
    display.LineWidth = width
    display.Position = [0.0, 0.0, height]
    without_lamp(display)
    return display


def paint(display, view, array, title, limits, preset, invert=False, where="POINTS"):
    """Colours a display by a scalar array with a fixed range, and gives it a titled bar."""
    ColorBy(display, (where, array))
    colours = GetColorTransferFunction(array)
    colours.ApplyPreset(preset, False)
    if invert:
        colours.InvertTransferFunction()
    colours.RGBPoints = every_few(list(colours.RGBPoints))
    colours.ColorSpace = "Lab"
    colours.AutomaticRescaleRangeMode = "Never"
    colours.RescaleTransferFunction(*limits)
    bar_of(colours, view, title)
    display.SetScalarBarVisibility(view, True)
    return colours


def every_few(points, kept=17):
    """Fewer control points of a colour map: states stay small, and colours the same to the eye."""
    count = len(points) // 4
    if count <= kept:
        return points
    chosen = [round(k * (count - 1) / (kept - 1)) for k in range(kept)]
    return [number for k in chosen for number in points[4 * k:4 * k + 4]]


def bar_of(colours, view, title):
    bar = GetScalarBar(colours, view)
    bar.Title, bar.ComponentTitle = title, ""
    bar.TitleColor = bar.LabelColor = BLACK
    bar.TitleFontSize, bar.LabelFontSize = 14, 13
    bar.TitleItalic = bar.TitleShadow = 0
    bar.AddRangeLabels = 0
    bar.ScalarBarLength, bar.ScalarBarThickness = 0.3, 14
    bar.AutoOrient, bar.Orientation = 0, "Vertical"
    bar.HorizontalTitle = 1  # above the bar; beside it, it runs into wide labels
    bar.WindowLocation = "Lower Right Corner"
    return bar


def show_flow(flow, view, look, array, title, limits, preset, invert=False):
    """The free surface in colours, lifted clear of the terrain where it is thin."""
    display = Show(flow, view)
    display.Position = [0.0, 0.0, look["lift"]]
    paint(display, view, array, title, limits, preset, invert)
    display.Ambient, display.Diffuse, display.Specular = 0.7, 0.3, 0.0
    return display


def show_particles(run_dir, view, look, height, colours):
    """Particles as discs, `height` [m] above where they are; `colours` goes to paint()."""
    particles = PVDReader(registrationName="particles", FileName=os.path.join(run_dir, "particles.pvd"))
    display = Show(particles, view)
    display.SetRepresentationType("Point Gaussian")
    display.GaussianRadius = look["particle_radius"]
    display.ShaderPreset = "Plain circle"
    display.ScaleByArray = display.OpacityByArray = 0
    display.Position = [0.0, 0.0, height]
    paint(display, view, *colours)
    without_lamp(display)


def show_curves(source, view, x, curves, association="POINTS"):
    """Curves of a table or data set: {array: (label, colour, width, style)}, style 1 solid, 2 dashed."""
    display = Show(source, view, "XYChartRepresentation")
    display.AttributeType = "Point Data" if association == "POINTS" else "Row Data"
    display.UseIndexForXAxis, display.XArrayName = 0, x
    names = list(curves)
    pairs = lambda values: [text for name, value in zip(names, values) for text in (name, value)]
    display.SeriesVisibility = names
    display.SeriesLabel = pairs([curves[name][0] for name in names])
    display.SeriesColor = [text for name in names
                           for text in [name] + ["%g" % part for part in curves[name][1]]]
    display.SeriesLineThickness = pairs([str(curves[name][2]) for name in names])
    display.SeriesLineStyle = pairs([str(curves[name][3]) for name in names])
    display.SeriesMarkerStyle = pairs(["0"] * len(names))
    display.SeriesPlotCorner = pairs(["0"] * len(names))
    return display


def new_layout(name):
    return CreateLayout(name)
