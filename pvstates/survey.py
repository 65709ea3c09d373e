"""The simulated and the surveyed extent on the terrain: what both have, what only one has, and the two outlines."""
import os

from paraview.simple import (
    ColorBy, GetColorTransferFunction, Show, Threshold, XMLPolyDataReader,
)

import frana_scene as scene

SIZE = [1500, 1000]  # of a picture [pixels]
# The colours of figures/compare.png (src/base/colour.h: hit, beyond, missed, survey).
AREAS = [("1", "simulated and surveyed", [0.0, 0.62, 0.451]), ("2", "simulated only", [0.941, 0.706, 0.157]),
         ("3", "surveyed only", [0.0, 0.243, 0.51])]
SURVEYED = [0.902, 0.0, 0.235]


def build(run_dir):
    look = scene.look_of(run_dir, "survey")
    layout = scene.new_layout("survey")
    view = scene.render_view(layout, 0, "survey", look["camera"]["survey"], flat=True, scale="scale_wide")
    scene.show_terrain(scene.terrain_surface(run_dir), view)
    show_areas(run_dir, view, look)
    show_outlines(run_dir, view, look)
    scene.heading(view, "Simulated (black) and surveyed (red) extent")
    return layout


def show_areas(run_dir, view, look):
    areas = XMLPolyDataReader(registrationName="areas", FileName=[os.path.join(run_dir, "survey_areas.vtp")])
    display = Show(areas, view)
    ColorBy(display, ("CELLS", "agreement"))
    colours = GetColorTransferFunction("agreement")
    colours.InterpretValuesAsCategories = 1
    colours.Annotations = [text for value, meaning, _ in AREAS for text in (value, meaning)]
    colours.IndexedColors = [part for _, _, colour in AREAS for part in colour]
    bar = scene.bar_of(colours, view, "extent")
    bar.ScalarBarLength = 0.2
    display.SetScalarBarVisibility(view, True)
    display.Opacity = 0.75
    display.Position = [0.0, 0.0, look["lift_areas"]]
    scene.without_lamp(display)


def show_outlines(run_dir, view, look):
    outlines = XMLPolyDataReader(registrationName="outlines", FileName=[os.path.join(run_dir, "survey_outlines.vtp")])
    for value, name, colour, width in ((1, "simulated outline", scene.BLACK, 1.5),
                                       (2, "surveyed outline", SURVEYED, 3.0)):
        one = Threshold(registrationName=name, Input=outlines)
        one.Scalars = ["CELLS", "extent"]
        one.LowerThreshold = one.UpperThreshold = float(value)
        scene.show_line(one, view, look["lift_outlines"], colour, width)
