"""Opens a run of frana in ParaView: terrain with relief, flow depth over it, particles; or one of the states.

Without a window:   pvbatch open_run.py RUN_DIR [--time T] [--png FILE] [--colour depth|speed] [--max VALUE]
                    pvbatch open_run.py RUN_DIR --state NAME [--time T] [--png FILE]
                    with overview, stress, profiles, survey, impact, structure, phases, budgets or, of an
                    ensemble's folder, probability
                    (on a machine without a screen: xvfb-run -a pvbatch ...)
In ParaView:        Tools > Python Shell, then
                    import sys; sys.path.append("/path/to/pvstates")
                    from open_run import open_run, open_state
                    open_run("/path/to/RUN_DIR")   or   open_state("/path/to/RUN_DIR", "stress")

The colour range is fixed over all times of the run (0 to a round number above the largest value of its output
times), so that colours of two times can be compared. "Play" shows the run; a running case can be opened
too: "Reload Files" (F5) brings the newer frames.
"""
import argparse
import importlib
import math
import os
import sys

from paraview import servermanager
from paraview.simple import (
    AnnotateTimeFilter, Clip, ColorBy, GetActiveViewOrCreate, GetAnimationScene, GetColorTransferFunction,
    GetLayouts, GetScalarBar, GetViewsInLayout, Hide, PVDReader, Render, ResetCamera, SaveScreenshot, Show, Threshold,
    WarpByScalar, XMLImageDataReader,
)

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from frana_scene import NoState, at_time  # noqa: E402

STATES = ("overview", "stress", "profiles", "survey", "impact", "structure", "phases", "budgets", "probability")
LIFT = 0.5  # [m] keeps the flow's surface clear of the terrain where it is thin
THIN = 0.05  # [m] flow thinner than this is not drawn


def unit_of(reader, array):
    """Unit of an array, from the file's field data."""
    data = servermanager.Fetch(reader)
    while data.IsA("vtkCompositeDataSet"):
        walker = data.NewIterator()
        walker.InitTraversal()
        data = walker.GetCurrentDataObject()
    unit = data.GetFieldData().GetAbstractArray(array + "_unit")
    return unit.GetValue(0) if unit else "?"


def largest(reader, array):
    """Largest value of a scalar array over all output times."""
    found = 0.0
    for time in reader.TimestepValues:
        reader.UpdatePipeline(time)
        if reader.PointData.GetArray(array):
            found = max(found, reader.PointData[array].GetRange(0)[1])
    return found


def round_up(value):
    """The next 1, 1.5, 2, 3, 5 or 7.5 times a power of ten: a range one can read off a colour bar."""
    if value <= 0.0:
        return 1.0
    power = 10.0 ** math.floor(math.log10(value))
    return next(step * power for step in (1.0, 1.5, 2.0, 3.0, 5.0, 7.5, 10.0) if step * power >= value)


def paint(display, view, array, title, maximum):
    """Colours a display by a scalar array with a fixed, reversed viridis (dark = much) and a titled bar."""
    ColorBy(display, ("POINTS", array))
    colours = GetColorTransferFunction(array)
    colours.ApplyPreset("Viridis (matplotlib)", True)
    colours.InvertTransferFunction()
    colours.AutomaticRescaleRangeMode = "Never"
    colours.RescaleTransferFunction(0.0, maximum)
    bar = GetScalarBar(colours, view)
    bar.Title, bar.ComponentTitle = title, ""
    bar.TitleColor = bar.LabelColor = [0, 0, 0]
    bar.TitleFontSize, bar.LabelFontSize = 16, 14
    bar.TitleItalic = bar.TitleShadow = 0
    bar.AddRangeLabels = 0
    bar.WindowLocation = "Lower Right Corner"
    display.SetScalarBarVisibility(view, True)


def without_holes(source):
    """Leaves out what touches nodes without terrain; Clip does not do that by itself."""
    source.UpdatePipeline()
    if not source.PointData.GetArray("outside"):
        return source
    inside = Threshold(registrationName="inside", Input=source)
    inside.Scalars = ["POINTS", "outside"]
    inside.LowerThreshold = inside.UpperThreshold = 0.0
    inside.AllScalars = 1
    return inside


def show_terrain(run_dir, view):
    """The bed as a warped surface, grey by its own relief shading (no lamp of the view's on top)."""
    terrain = XMLImageDataReader(registrationName="terrain", FileName=[os.path.join(run_dir, "terrain.vti")])
    warped = WarpByScalar(registrationName="terrain surface", Input=terrain)
    warped.Scalars = ["POINTS", "elevation"]
    display = Show(warped, view)
    ColorBy(display, ("POINTS", "hillshade"))
    greys = GetColorTransferFunction("hillshade")
    greys.ApplyPreset("Grayscale", True)
    greys.AutomaticRescaleRangeMode = "Never"
    greys.RescaleTransferFunction(-0.4, 1.0)
    display.Ambient, display.Diffuse, display.Specular = 1.0, 0.0, 0.0
    display.SetScalarBarVisibility(view, False)
    return warped


def show_flow(run_dir, view, array, maximum):
    """The free surface where there is flow, coloured by depth or speed."""
    grid = PVDReader(registrationName="grid", FileName=os.path.join(run_dir, "grid.pvd"))
    lifted = WarpByScalar(registrationName="flow surface", Input=grid)
    lifted.Scalars = ["POINTS", "surface"]
    wet = Clip(registrationName="flow", Input=without_holes(lifted))
    wet.ClipType, wet.Scalars, wet.Value, wet.Invert = "Scalar", ["POINTS", "depth"], THIN, 0
    display = Show(wet, view)
    display.Position = [0.0, 0.0, LIFT]
    title = "%s [%s]" % (array, unit_of(grid, array))
    paint(display, view, array, title, maximum or round_up(largest(grid, array)))
    display.Ambient, display.Diffuse, display.Specular = 0.6, 0.4, 0.0
    return grid


def show_particles(run_dir, view, array):
    """Particles as points in the colours of the flow; hidden when they do not carry the array."""
    particles = PVDReader(registrationName="particles", FileName=os.path.join(run_dir, "particles.pvd"))
    display = Show(particles, view)
    display.Representation = "Points"
    display.PointSize = 3
    display.Ambient, display.Diffuse = 1.0, 0.0
    display.Position = [0.0, 0.0, 2.0 * LIFT]
    particles.UpdatePipeline(particles.TimestepValues[0])
    if particles.PointData.GetArray(array):
        ColorBy(display, ("POINTS", array))
    else:
        Hide(particles, view)
    return particles


def look_from_south(view, terrain):
    """A camera south of the terrain, 40 degrees above it, that sees all of it."""
    bounds = terrain.GetDataInformation().GetBounds()
    centre = [0.5 * (bounds[2 * k] + bounds[2 * k + 1]) for k in range(3)]
    reach = max(bounds[1] - bounds[0], bounds[3] - bounds[2])
    view.CameraFocalPoint = centre
    view.CameraPosition = [centre[0], centre[1] - 0.77 * reach, centre[2] + 0.64 * reach]
    view.CameraViewUp = [0.0, 0.0, 1.0]
    ResetCamera(view)
    view.GetActiveCamera().Dolly(1.4)


def open_run(run_dir, colour="depth", maximum=None, time=None):
    """Builds the pipeline in the active view (a new one in pvbatch) and returns the view.

    colour: "depth" [m] or "speed" [m/s]; maximum: upper end of the colour range, found from the run when
    None; time: output time nearest to it is shown, the last one when None.
    """
    run_dir = os.path.abspath(run_dir)
    view = GetActiveViewOrCreate("RenderView")
    view.UseColorPaletteForBackground = 0
    view.Background = [1.0, 1.0, 1.0]
    view.OrientationAxesLabelColor = [0.0, 0.0, 0.0]
    terrain = show_terrain(run_dir, view)
    show_particles(run_dir, view, colour)
    grid = show_flow(run_dir, view, colour, maximum)  # last, because it fixes the colour range of both
    clock = AnnotateTimeFilter(registrationName="clock", Input=grid)
    clock.Format = "t = {time:.1f} s"
    label = Show(clock, view)
    label.Color, label.FontSize, label.WindowLocation = [0, 0, 0], 18, "Upper Left Corner"
    GetAnimationScene().UpdateAnimationUsingDataTimeSteps()
    times = list(grid.TimestepValues)
    wanted = times[-1] if time is None else min(times, key=lambda t: abs(t - time))
    GetAnimationScene().AnimationTime = wanted
    view.ViewTime = wanted
    terrain.UpdatePipeline()
    look_from_south(view, terrain)
    Render(view)
    return view


def open_state(run_dir, name, time=None):
    """Shows one of STATES in layouts of its own, mostly one, and returns them with their size for pictures.

    `time` [s]: output time; the state's own when None. Raises NoState with a sentence when the run lacks what it shows.
    """
    if name not in STATES:
        raise NoState("no state \"%s\"; expected one of %s" % (name, ", ".join(STATES)))
    module = importlib.import_module(name)
    before = set(GetLayouts())
    module.build(os.path.abspath(run_dir))
    layouts = [layout for key, layout in GetLayouts().items() if key not in before]
    if time is not None and name not in ("survey", "budgets"):
        at_time([view for layout in layouts for view in GetViewsInLayout(layout)], time)
    return layouts, module.SIZE


def picture_of(given):
    """Draws what the command line asks for; returns what to save, a picture each, and the size."""
    if given.state:
        return open_state(given.run_dir, given.state, given.time)
    view = open_run(given.run_dir, given.colour, given.max, given.time)
    view.ViewSize = [1400, 900]
    return [view], [1400, 900]


def size_of(text):
    """[width, height] of "1600x900"."""
    parts = text.split("x")
    if len(parts) != 2 or not all(part.isdecimal() and int(part) > 0 for part in parts):
        raise argparse.ArgumentTypeError("found %s; expected WxH in pixels, as 1600x900" % text)
    return [int(part) for part in parts]


def main():
    parser = argparse.ArgumentParser(description="Opens a run of frana in ParaView and saves a picture.")
    parser.add_argument("run_dir")
    parser.add_argument("--time", type=float, help="output time nearest to it [s]; default: the last one")
    parser.add_argument("--png", help="picture to write; default: RUN_DIR/figures/paraview.png")
    parser.add_argument("--colour", default="depth", help="depth or speed")
    parser.add_argument("--max", type=float, help="upper end of the colour range; default: from the run")
    parser.add_argument("--state", help="one of %s instead" % ", ".join(STATES))
    parser.add_argument("--size", type=size_of, help="of the picture, as 1600x900 [pixels]")
    given = parser.parse_args()
    name = "paraview_%s.png" % given.state if given.state else "paraview.png"
    png = given.png or os.path.join(given.run_dir, "figures", name)
    try:
        shown, size = picture_of(given)
    except NoState as problem:
        print(problem, file=sys.stderr)
        sys.stderr.flush()
        os._exit(2)  # pvbatch's own way out loses the status
    size = given.size or size
    os.makedirs(os.path.dirname(os.path.abspath(png)), exist_ok=True)
    for k, one in enumerate(shown):  # RUN_DIR/figures/paraview_stress.png, paraview_stress_2.png
        file = png if k == 0 else "%s_%d%s" % (os.path.splitext(png)[0], k + 1, os.path.splitext(png)[1])
        if given.state:
            one.SetSize(*size)
        SaveScreenshot(file, one, ImageResolution=size, SaveAllViews=1 if given.state else 0)
        print(file)


if __name__ == "__main__" and len(sys.argv) > 1:
    main()
