"""Terrain, initial, present and final surface along a line of the case ([[profile]]), beside the map with that line.
On high relief depths are drawn so many times larger, as the chart's title says, that the surfaces can be told apart.
All surfaces are drawn so from the terrain at the start: what has become bed is as thick as while it flowed.

The chart and the map show the same source: stations selected in one light up in the other. With several profiles, the
source "profile" (a Threshold) chooses which: 0 is the first of the case.
"""
import os

from paraview.simple import Calculator, ForceTime, PVDReader, Threshold

import frana_scene as scene

SIZE = [1600, 1000]  # of a picture [pixels]


def build(run_dir):
    look = scene.look_of(run_dir, "profiles")
    layout = scene.new_layout("profiles")
    left = layout.SplitHorizontal(0, 0.4)
    lower = layout.SplitVertical(left + 1, 0.6)
    map_view = scene.render_view(layout, left, "map", look["camera"]["map"], flat=True, scale="scale_tall")
    surfaces = scene.chart_view(layout, lower, "surfaces", look["profile"]["title"], "distance along the line [m]",
                                "elevation [m]")
    depths = scene.chart_view(layout, lower + 1, "depth along", "Depth along the line",
                              "distance along the line [m]", "depth [m]", legend=False)
    surfaces.LegendLocation = look["legend"]
    profile, final = lines_of(run_dir, look)
    show_map(run_dir, map_view, profile, look)
    scene.show_curves(final, surfaces, "distance", {"drawn_surface": ("final surface", scene.VERMILION, 2, 1)})
    scene.show_curves(profile, surfaces, "distance",
                      {"drawn_initial_surface": ("initial surface", scene.GREY, 2, 2),
                       "drawn_surface": ("surface at this time", scene.BLUE, 2, 1),
                       "initial_elevation": ("terrain at the start", scene.BLACK, 2, 1)})
    scene.show_curves(final, depths, "distance", {"depth": ("final depth", scene.VERMILION, 2, 1)})
    scene.show_curves(profile, depths, "distance", {"depth": ("depth at this time", scene.BLUE, 2, 1)})
    scene.at_time([map_view, surfaces, depths], look["last_time"])
    return layout


def lines_of(run_dir, look):
    """One profile at the time of the views, and at the run's end."""
    reader = PVDReader(registrationName="profiles", FileName=os.path.join(run_dir, "profiles.pvd"))
    profile = Threshold(registrationName="profile", Input=reader)
    profile.Scalars = ["CELLS", "profile"]
    profile.LowerThreshold = profile.UpperThreshold = 0.0
    for name in ("surface", "initial_surface"):
        profile = drawn(profile, "drawn_" + name, look["profile"][name])
    final = ForceTime(registrationName="profile at the end", Input=profile)
    final.ForcedTime = look["last_time"]
    return profile, final


def drawn(source, name, formula):
    result = Calculator(registrationName=name, Input=source)
    result.AttributeType = "Point Data"
    result.ResultArrayName, result.Function = name, formula
    return result


def show_map(run_dir, view, profile, look):
    grid = scene.open_grid(run_dir)
    flow, edge = scene.flow_surface(grid, look)
    scene.show_terrain(scene.terrain_surface(run_dir), view)
    scene.show_flow(flow, view, look, "depth", look["bar"]["depth"], look["range"]["depth"], "Viridis (matplotlib)",
                    True)
    scene.show_line(edge, view, look["lift"])
    scene.show_line(profile, view, look["range"]["depth"][1], scene.VERMILION, 3.0)  # above the flow
    scene.clock(view, grid)
