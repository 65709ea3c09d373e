#!/usr/bin/env python3
"""Leaves a run in a folder, reads it back, and holds it against the same case with half of the friction.

    read_a_run.py cases/maungawhau/case.toml
"""
import os
import sys
import tempfile

import frana

case = frana.Case(sys.argv[1])
case.update({"particles.per_cell": 4, "grid.cell": 5.0, "output.formats": ["vtk", "geotiff"]})
with tempfile.TemporaryDirectory() as folder:
    for name, mu in (("surveyed", 0.05), ("tried", 0.10)):
        case["material.bed.mu"] = mu
        case.run(os.path.join(folder, name), until=8.0).finish()
    tried = frana.open(os.path.join(folder, "tried"))
    for line in tried.history:
        print(f"{line['t']:4.1f} s: kinetic energy {line['kinetic'] / 1e6:.1f} MJ")
    last = tried.frames[-1]
    print(f"frame {last.number} has {', '.join(last.grid)}")
    scores = tried.compare(os.path.join(folder, "surveyed", "footprint.geojson"))
    print(f"of the two footprints IoU is {scores['iou']:.2f}")
