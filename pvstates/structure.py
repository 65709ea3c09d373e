"""Solids that hold together, from above, through time: damage of the particles, depth, what is left of their cohesion,
and the larger principal stress of the structure (tension positive)."""
from paraview.simple import Calculator

import frana_scene as scene

SIZE = [1600, 1200]  # of a picture [pixels]
TENSION = ("0.5*(stress_xx+stress_yy)+sqrt(0.25*(stress_xx-stress_yy)*(stress_xx-stress_yy)+"
           "stress_xy*stress_xy)")


def build(run_dir):
    look = scene.look_of(run_dir, "structure")
    layout = scene.new_layout("structure")
    upper = layout.SplitVertical(0, 0.5)
    places = [layout.SplitHorizontal(row, 0.5) for row in (upper, upper + 1)]
    views = [scene.render_view(layout, place, name, look["camera"]["map"], flat=True)
             for place, name in zip([places[0], places[0] + 1, places[1], places[1] + 1],
                                    ("damage", "depth", "cohesion", "tension"))]
    terrain = scene.terrain_surface(run_dir)
    grid = scene.open_grid(run_dir)
    flow, edge = scene.flow_surface(grid, look)
    for view in views:
        scene.show_terrain(terrain, view)
        scene.show_line(edge, view, look["lift"])
    scene.show_particles(run_dir, views[0], look, look["lift_areas"],  # 0 is whole, 1 is grains
                         ("damage", "damage", [0.0, 1.0], "Inferno (matplotlib)", True))
    scene.show_flow(flow, views[1], look, "depth", look["bar"]["depth"], look["range"]["depth"], "Viridis (matplotlib)")
    scene.show_flow(flow, views[2], look, "cohesion", look["bar"]["cohesion"], look["range"]["cohesion"],
                    "Viridis (matplotlib)")
    tension = Calculator(registrationName="tension", Input=flow)
    tension.AttributeType = "Point Data"
    tension.ResultArrayName, tension.Function = "tension", TENSION
    scene.show_flow(tension, views[3], look, "tension", look["bar"]["stress"], look["range"]["stress"],
                    "Blue Orange (divergent)")
    for view, text in zip(views, ("Damage", "Depth", look["cohesion_text"], "Larger principal stress")):
        scene.heading(view, text, "cohesion" if text == look["cohesion_text"] else text)
    scene.clock(views[0], grid)
    scene.link_cameras(views)
    scene.at_time(views, look["last_time"])
    return layout
