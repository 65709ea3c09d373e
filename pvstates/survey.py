"""The simulated and the surveyed extent on the terrain: what both have, what only one has, and the two outlines."""
import os

from paraview.simple import (
    ColorBy, GetColorTransferFunction, Show, Threshold, XMLPolyDataReader,
)

import frana_scene as scene

SIZE = [1500, 1000]  # of a picture [pixels]
AREAS = [("1", "simulated and surveyed", scene.BLUE), ("2", "simulated only", scene.YELLOW),
         ("3", "surveyed only", scene.VERMILION)]


def build(run_dir):
    look = scene.look_of(run_dir, "survey")
    layout = scene.new_layout("survey")
    view = scene.render_view(layout, 0, "survey", look["camera"]["survey"], flat=True, scale="scale_wide")
    scene.show_terrain(scene.terrain_surface(run_dir), view)
    show_areas(run_dir, view, look)
    show_outlines(run_dir, view, look)
    scene.heading(view, "Simulated (white) and surveyed (black) extent")
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
    for value, name, colour, width in ((1, "simulated outline", scene.WHITE, 2.0),
                                       (2, "surveyed outline", scene.BLACK, 3.0)):
        one = Threshold(registrationName=name, Input=outlines)
        one.Scalars = ["CELLS", "extent"]
        one.LowerThreshold = one.UpperThreshold = float(value)
        scene.show_line(one, view, look["lift_outlines"], colour, width)
