#!/usr/bin/env python3
"""What flows past a line, step by step: a run that is told how far to go.

    hydrograph.py cases/maungawhau/case.toml
"""
import sys

import numpy

import frana

case = frana.Case(sys.argv[1])
case.update({"particles.per_cell": 4, "grid.cell": 5.0})
density = case["material.density"]
with case.run(until=12.0) as run:
    start = next(run).particles["position"]
    centre = start.mean(axis=0)
    before = 0.0
    for time in numpy.arange(2.0, 12.1, 2.0):
        frame = run.advance(until=time)
        away = numpy.hypot(*(frame.particles["position"] - centre)[:, :2].T)
        passed = frame.particles["mass"][away > 40.0].sum() / density
        print(f"{frame.time:5.2f} s: {(passed - before) / 2.0:6.1f} m3/s pass 40 m from the release")
        before = passed
print(f"in all passes {before:.0f} m3 of {run.result.record['release_volume']:.0f} m3")
