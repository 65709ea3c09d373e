"""The run's budgets over time, from history.csv: energy, motion, and how well mass is kept."""
import os

from paraview.simple import Calculator, CSVReader

import frana_scene as scene

SIZE = [1600, 1000]  # of a picture [pixels]


def build(run_dir):
    look = scene.look_of(run_dir, "budgets")
    layout = scene.new_layout("budgets")
    lower = layout.SplitVertical(0, 0.5) + 1
    upper_right, lower_right = layout.SplitHorizontal(1, 0.5), layout.SplitHorizontal(2, 0.5)
    time = "time [s]"
    energy = scene.chart_view(layout, upper_right, "energy", "Energy", time, "energy [J]")
    speed = scene.chart_view(layout, upper_right + 1, "speed", "Speed", time, "speed [m/s]")
    reach = scene.chart_view(layout, lower_right, "front", "Front", time, "distance from the release's centre [m]",
                             legend=False)
    mass = scene.chart_view(layout, lower_right + 1, "mass", "Mass error", time, "mass error, relative [1]")
    energy.LegendLocation = "TopLeft"
    history = CSVReader(registrationName="history", FileName=[os.path.join(run_dir, "history.csv")])
    budget = Calculator(registrationName="potential energy from the start", Input=history)
    budget.AttributeType = "Row Data"
    budget.ResultArrayName, budget.Function = "potential_from_start", look["potential_from_start"]
    scene.show_curves(budget, energy, "t",
                      {"kinetic": ("kinetic", scene.BLUE, 2, 1),
                       "potential_from_start": ("potential, from the start", scene.ORANGE, 2, 1),
                       "dissipated": ("dissipated", scene.GREEN, 2, 1),
                       "energy_left": ("left the domain", scene.GREY, 2, 2),
                       "energy_residual": ("residual", scene.VERMILION, 2, 2)}, "ROWS")
    scene.show_curves(history, speed, "t", {"max_speed": ("fastest", scene.VERMILION, 2, 1),
                                            "mean_speed": ("mean", scene.BLUE, 2, 1)}, "ROWS")
    scene.show_curves(history, reach, "t", {"front": ("front", scene.BLUE, 2, 1)}, "ROWS")
    scene.show_curves(history, mass, "t", {"mass_error": ("mass of the run", scene.BLUE, 2, 1),
                                           "p2g_mass_error": ("particles to grid", scene.ORANGE, 2, 1)}, "ROWS")
    return layout
