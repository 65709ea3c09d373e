"""How likely a depth is at a place, by an ensemble: how_likely.py ENSEMBLE X Y [DEPTH]"""
import math
import sys

import frana

ensemble = frana.Ensemble(sys.argv[1])
x, y, depth = float(sys.argv[2]), float(sys.argv[3]), float(sys.argv[4]) if len(sys.argv) > 4 else 0.5
many = ensemble.run(progress=lambda now: print(now, end="\r", file=sys.stderr))
share = many.probability("peak_depth", above=depth).at(x, y)
if math.isnan(share):  # where no run came there is no value
    share = 0.0
print(f"{ensemble.samples} runs; more than {depth:g} m at the place in {100 * share:.0f} % of them")
for key in ensemble.keys:
    print(f"{key}: {many.runs[key].min():.3g} to {many.runs[key].max():.3g}")
farthest = many.runs[many.runs["reach_m"].argmax()]
print(f"farthest: run {farthest['sample']}, {farthest['reach_m']:.0f} m")
