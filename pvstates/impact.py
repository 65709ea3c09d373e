"""3D points in the colours of their speed, barriers in those of the pressure on them, and the terrain."""
import os

from paraview.simple import PVDReader, Show, Threshold, WarpByScalar

import frana_scene as scene

SIZE = [1400, 800]  # of a picture [pixels]


def build(run_dir):
    look = scene.look_of(run_dir, "impact")
    layout = scene.new_layout("impact")
    view = scene.render_view(layout, 0, "impact", look["camera"]["impact"], flat=False)
    scene.show_terrain(scene.terrain_surface(run_dir), view)
    particles = show_points(run_dir, view, look)
    show_barriers(run_dir, view, look)
    scene.clock(view, particles)
    scene.heading(view, "3D points, pressure on barriers")
    scene.at_time([view], look["impact_time"])
    return layout


def show_points(run_dir, view, look):
    """Discs as large as the points in the middle; particles, which have model 0, are left out."""
    particles = PVDReader(registrationName="particles", FileName=os.path.join(run_dir, "particles.pvd"))
    points = Threshold(registrationName="3D points", Input=particles)
    points.Scalars = ["POINTS", "model"]
    points.LowerThreshold, points.UpperThreshold, points.ThresholdMethod = 0.5, 1.5, "Between"
    display = Show(points, view)
    display.SetRepresentationType("Point Gaussian")
    display.GaussianRadius = look["point_radius"]
    display.ShaderPreset = "Plain circle"
    display.ScaleByArray = display.OpacityByArray = 0
    colours = scene.paint(display, view, "speed", look["bar"]["point_speed"], look["range"]["point_speed"],
                          "Plasma (matplotlib)")
    scene.without_lamp(display)
    scene.bar_of(colours, view, look["bar"]["point_speed"]).WindowLocation = "Upper Right Corner"
    return particles


def show_barriers(run_dir, view, look):
    """Faces in patches, from the ground to the barrier's top; a patch has the mean pressure since the output before."""
    faces = PVDReader(registrationName="barriers", FileName=os.path.join(run_dir, "barriers.pvd"))
    barriers = WarpByScalar(registrationName="barriers in their height", Input=faces)
    barriers.Scalars = ["POINTS", "to_true_height"]
    display = Show(barriers, view)
    scene.paint(display, view, "pressure", look["bar"]["pressure"], look["range"]["pressure"], "Greens", True,
                where="CELLS")
    display.Ambient, display.Diffuse, display.Specular = 0.7, 0.3, 0.0
