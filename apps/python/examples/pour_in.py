"""Material poured into a run from outside: pour_in.py CASE X Y"""
import sys

import frana

case = frana.Case(sys.argv[1], set={"time.stop_at_rest": False})
x, y = float(sys.argv[2]), float(sys.argv[3])
with case.run() as run:
    next(run)
    while not run.over and run.time < 0.5 * run.end:
        run.add_mass(x, y, 2.0e4, velocity=(0.0, 0.0), size=10.0)  # 20 t on a square of 10 m
        frame = run.advance(until=run.time + 1.0)
        print(f"{frame.time:6.2f} s: {frame.status.mass_in:.0f} kg came in, {frame.status.mass:.0f} kg are there")
    run.finish()
print(f"{run.result.record['budgets']['mass']['relative_error']:.1e} of the mass is unaccounted for")
