"""Solids and free water, through time: the depth of each from above, and the surfaces of both aslant, the water's blue and
clear over the particles'."""
from paraview.simple import Calculator, Clip, Contour, Show, WarpByScalar

import frana_scene as scene

SIZE = [1600, 1200]  # of a picture [pixels]


def calculated(source, name, function):
    """A further array on the nodes."""
    made = Calculator(registrationName=name, Input=source)
    made.AttributeType = "Point Data"
    made.ResultArrayName, made.Function = name, function
    return made


def phase(source, name, height, depth, look):
    """A surface at `height` where there is more than look["thin"] of `depth`, and its margin."""
    lifted = WarpByScalar(registrationName=name + " lifted", Input=source)
    lifted.Scalars = ["POINTS", height]
    surface = Clip(registrationName=name, Input=lifted)
    surface.ClipType, surface.Scalars, surface.Value, surface.Invert = "Scalar", ["POINTS", depth], look["thin"], 0
    edge = Contour(registrationName=name + " margin", Input=lifted)
    edge.ContourBy, edge.Isosurfaces = ["POINTS", depth], [look["thin"]]
    edge.ComputeScalars = 0
    return surface, edge


def build(run_dir):
    look = scene.look_of(run_dir, "phases")
    layout = scene.new_layout("phases")
    upper = layout.SplitVertical(0, 0.5)
    left = layout.SplitHorizontal(upper, 0.5)
    views = [scene.render_view(layout, place, name, look["camera"]["map"], flat=True)
             for place, name in ((left, "particles"), (left + 1, "water"))]
    aslant = scene.render_view(layout, upper + 1, "both", look["camera"]["view"], flat=False, scale="scale_wide")
    terrain = scene.terrain_surface(run_dir)
    grid = scene.open_grid(run_dir)
    bound = calculated(grid, "bound_depth", "depth-water_depth")
    both = calculated(bound, "bound_surface", "surface-water_depth")
    particles, particles_edge = phase(both, "particles", "bound_surface", "bound_depth", look)
    water, water_edge = phase(both, "free water", "surface", "water_depth", look)
    for view in views + [aslant]:
        scene.show_terrain(terrain, view)
    for view, (surface, edge), array, preset, invert in (
            (views[0], (particles, particles_edge), "bound_depth", "Viridis (matplotlib)", False),
            (views[1], (water, water_edge), "water_depth", "Linear Blue (8_31f)", False)):
        scene.show_line(edge, view, look["lift"])
        scene.show_flow(surface, view, look, array, look["bar"][array], look["range"][array], preset, invert)
    scene.show_flow(particles, aslant, look, "bound_depth", look["bar"]["bound_depth"], look["range"]["bound_depth"],
                    "Viridis (matplotlib)")
    clear = Show(water, aslant)
    clear.Position = [0.0, 0.0, look["lift"]]
    clear.ColorArrayName = [None, ""]
    clear.AmbientColor = clear.DiffuseColor = scene.BLUE
    clear.Opacity = 0.55
    clear.Ambient, clear.Diffuse, clear.Specular = 0.5, 0.5, 0.3
    for view, text in zip(views + [aslant], ("Particles", "Free water", "Both: water blue over the particles")):
        scene.heading(view, text)
    scene.clock(views[0], grid)
    scene.link_cameras(views)
    scene.at_time(views + [aslant], look["busy_time"])
    return layout
