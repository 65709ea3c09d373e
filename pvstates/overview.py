"""Flow depth on the terrain, and beside it the particles in the colours of their speed, through time."""
import frana_scene as scene

SIZE = [1600, 800]  # of a picture [pixels]


def build(run_dir):
    look = scene.look_of(run_dir, "overview")
    layout = scene.new_layout("overview")
    left = layout.SplitHorizontal(0, 0.5)
    left_view = scene.render_view(layout, left, "flow depth", look["camera"]["view"], flat=False)
    right_view = scene.render_view(layout, left + 1, "particle speed", look["camera"]["view"], flat=False)
    terrain = scene.terrain_surface(run_dir)
    grid = scene.open_grid(run_dir)
    flow, edge = scene.flow_surface(grid, look)

    scene.show_terrain(terrain, left_view)
    scene.show_flow(flow, left_view, look, "depth", look["bar"]["depth"], look["range"]["depth"],
                    "Viridis (matplotlib)", True)
    scene.show_line(edge, left_view, look["lift"])
    scene.clock(left_view, grid)
    scene.heading(left_view, "Flow depth")

    scene.show_terrain(terrain, right_view)
    scene.show_particles(run_dir, right_view, look, look["lift"],
                         ("speed", look["bar"]["speed"], look["range"]["speed"], "Plasma (matplotlib)"))
    scene.clock(right_view, grid)
    scene.heading(right_view, "Particles and their speed")
    scene.link_cameras([left_view, right_view])
    scene.at_time([left_view, right_view], look["busy_time"])
    return layout
