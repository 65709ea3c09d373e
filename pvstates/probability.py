"""Many runs: the share of them that comes to each place, draped over the terrain, with lines at 5, 50 and 95 %."""
import os

from paraview.simple import Clip, Contour, Show, WarpByScalar, XMLImageDataReader

import frana_scene as scene

SIZE = [1500, 1000]  # of a picture [pixels]
LEAST = 0.001  # share that is shown
LINES = [0.05, 0.5, 0.95]


def build(run_dir):
    look = scene.look_of(run_dir, "probability")
    layout = scene.new_layout("probability")
    view = scene.render_view(layout, 0, "probability", look["camera"]["view"], flat=False)
    scene.show_terrain(scene.terrain_surface(run_dir), view)
    maps = XMLImageDataReader(registrationName="maps", FileName=[os.path.join(run_dir, "maps.vti")])
    draped = WarpByScalar(registrationName="draped maps", Input=maps)
    draped.Scalars = ["POINTS", "elevation"]
    show_share(draped, view, look)
    show_lines(draped, view, look)
    scene.heading(view, "Share of the runs that come, with lines at 5, 50 and 95 %")
    return layout


def show_share(draped, view, look):
    reached = Clip(registrationName="reached", Input=draped)
    reached.ClipType, reached.Scalars, reached.Value, reached.Invert = (
        "Scalar", ["POINTS", "probability_reached"], LEAST, 0)
    display = Show(reached, view)
    display.Position = [0.0, 0.0, look["lift"]]
    scene.paint(display, view, "probability_reached", "share of the runs [1]", look["range"]["probability"],
                "Viridis (matplotlib)", True)
    display.Ambient, display.Diffuse, display.Specular = 0.7, 0.3, 0.0


def show_lines(draped, view, look):
    lines = Contour(registrationName="lines", Input=draped)
    lines.ContourBy, lines.Isosurfaces = ["POINTS", "probability_reached"], LINES
    lines.ComputeScalars = 0
    scene.show_line(lines, view, look["lift_outlines"])
