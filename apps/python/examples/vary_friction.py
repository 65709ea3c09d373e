#!/usr/bin/env python3
"""How far a mudflow comes in eight seconds with three coefficients of friction.

    vary_friction.py cases/maungawhau/case.toml
"""
import sys

import frana

case = frana.Case(sys.argv[1])
print(frana.describe("material.bed.mu"))
case.update({"time.end": 8.0, "output.every": 8.0, "particles.per_cell": 4, "grid.cell": 5.0})
for mu in (0.05, 0.15, 0.30):
    case["material.bed.mu"] = mu
    with case.run() as run:
        result = run.finish()
    print(f"mu {mu:.2f} after {run.time:g} s: the front has come {run.status.front:.1f} m")
