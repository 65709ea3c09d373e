"""Stress in the moving mass, from above, through time: the components of the rheology's stress, of the effective stress
(with the depth-averaged pressure, Fois et al. 2024), and the principal stresses as crosses.

Tension is positive. The long bar of a cross lies along the principal stress of the largest size. Two layouts (tabs in
ParaView) of three panes in a row, so that each is as high as the window.
"""
from paraview.simple import Calculator, ExtractSubset, Glyph, Show, Threshold, WarpByScalar

import frana_scene as scene

SIZE = [1800, 900]  # of a picture of a layout [pixels]
DIVERGING, SEQUENTIAL = "Blue Orange (divergent)", "Viridis (matplotlib)"

# Angle of the first principal direction, and half the difference of the two principal stresses.
ANGLE = "0.5*atan2(2*stress_xy,stress_xx-stress_yy)"
RADIUS = "sqrt(0.25*(stress_xx-stress_yy)*(stress_xx-stress_yy)+stress_xy*stress_xy)"
MEAN = "0.5*(stress_xx+stress_yy)"


def calculated(source, name, function):
    result = Calculator(registrationName=name, Input=source)
    result.AttributeType = "Point Data"
    result.ResultArrayName, result.Function = name, function
    return result


def build(run_dir):
    look = scene.look_of(run_dir, "stress")
    stress, effective = look["range"]["stress"], look["range"]["effective_stress"]
    layout = scene.new_layout("stress")
    views = three_views(layout, look, ["stress xx", "stress yy", "stress xy"])
    views += three_views(scene.new_layout("effective and principal"), look,
                         ["effective xx", "effective yy", "principal"])
    terrain = scene.terrain_surface(run_dir)
    grid = scene.open_grid(run_dir)
    flow, edge = scene.flow_surface(grid, look)
    panels = [("stress_xx", "sigma_xx", "Stress xx [Pa]", stress, DIVERGING),
              ("stress_yy", "sigma_yy", "Stress yy [Pa]", stress, DIVERGING),
              ("stress_xy", "sigma_xy", "Stress xy [Pa]", stress, DIVERGING),
              ("effective_stress_xx", "effective_xx", "Effective stress xx [Pa]", effective, SEQUENTIAL),
              ("effective_stress_yy", "effective_yy", "Effective stress yy [Pa]", effective, SEQUENTIAL)]
    for view, (component, name, title, limits, preset) in zip(views, panels):
        bar = look["bar"]["effective_stress" if limits is effective else "stress"]
        scene.show_terrain(terrain, view)
        scene.show_flow(calculated(flow, name, component), view, look, name, bar, limits, preset)
        scene.show_line(edge, view, look["lift"])
        scene.heading(view, title)
    scene.show_terrain(terrain, views[5])
    scene.show_line(edge, views[5], look["lift"])
    show_crosses(grid, views[5], look)
    scene.heading(views[5], "Principal stresses [Pa]")
    for first in views[::3]:
        scene.clock(first, grid)
    scene.link_cameras(views)
    scene.at_time(views, look["busy_time"])
    return layout


def three_views(layout, look, names):
    """Three in a row."""
    left = layout.SplitHorizontal(0, 1.0 / 3.0)
    middle = layout.SplitHorizontal(left + 1, 0.5)
    return [scene.render_view(layout, place, name, look["camera"]["map"], flat=True, scale="scale_row")
            for place, name in zip([left, middle, middle + 1], names)]


def show_crosses(grid, view, look):
    """Two bars a sample: along each principal direction, as long as the stress is large, in the colour of its sign."""
    few = ExtractSubset(registrationName="every few nodes", Input=grid)
    few.VOI = look["cross"]["extent"]
    few.SampleRateI = few.SampleRateJ = look["cross"]["stride"]
    lifted = WarpByScalar(registrationName="samples on the surface", Input=few)
    lifted.Scalars = ["POINTS", "surface"]
    samples = Threshold(registrationName="samples", Input=lifted)
    samples.Scalars, samples.UpperThreshold = ["POINTS", "depth"], look["thin"]
    samples.ThresholdMethod = "Above Upper Threshold"
    samples.AllScalars = 0  # a cell of samples is wider than many a flow; where it is dry the bars have no length
    for number, (sign, along, across) in enumerate([("+", "cos", "sin"), ("-", "sin", "-cos")], 1):
        name = "principal_%d" % number
        size = calculated(samples, name, "%s%s%s" % (MEAN, sign, RADIUS))
        across = across.replace("-cos", "-1*cos")
        bars = calculated(size, name + "_vector", "abs(%s)*(%s(%s)*iHat+%s(%s)*jHat)" % (name, along, ANGLE, across,
                                                                                     ANGLE))
        glyphs = Glyph(registrationName="bars %d" % number, Input=bars, GlyphType="Line")
        glyphs.OrientationArray = ["POINTS", name + "_vector"]
        glyphs.ScaleArray = ["POINTS", name + "_vector"]
        glyphs.VectorScaleMode = "Scale by Magnitude"
        glyphs.ScaleFactor = look["cross"]["scale"]
        glyphs.GlyphMode = "All Points"
        display = Show(glyphs, view)
        display.LineWidth = 2.0
        display.Position = [0.0, 0.0, look["lift"]]
        colours = scene.paint(display, view, name, look["bar"]["stress"], look["range"]["stress"], DIVERGING)
        scene.without_lamp(display)
        display.SetScalarBarVisibility(view, number == 1)
