#!/usr/bin/env python3
"""Watches a mudflow for five seconds: where its front is, how fast, how deep.

    watch_a_run.py cases/maungawhau/case.toml
"""
import sys

import numpy

import frana

case = frana.Case(sys.argv[1])
print(case.check())
with case.run(until=5.0) as run:
    for frame in run:
        speed = numpy.linalg.norm(frame.particles["velocity"], axis=1)
        print(f"{frame.time:4.1f} s: front {frame.status.front:5.1f} m from the release's centre, deepest "
              f"{frame.grid['depth'].max():.2f} m, fastest particle {speed.max():.2f} m/s")
peak = run.result.peak_depth
area = (numpy.nan_to_num(peak.array) > 0.1).sum() * peak.cell**2
print(f"over by reason of {run.result.reason}; {area:.0f} m2 were covered")
