"""What a run through Python costs beside the program's own: bench.py [CASE] [--pairs N] [--count]

Pairs of child processes on one thread, both at the same time, since what else the machine does then touches both. Each makes a
long run and a short one: the difference of their processor times is that of the steps between, without what starting costs. Told is
the median over the pairs; on a busy machine single pairs differ by tens of percent. With --count only the steps are
held, by instructions in place of time (valgrind's callgrind): minutes, the same on any machine. The gates are those of apps/python/README.md; the exit code is 1
where one is missed. Needs PYTHONPATH=build/python and FRANA_PROGRAM=build/bin/frana.
"""
import argparse
import concurrent.futures
import os
import re
import shutil
import statistics
import subprocess
import sys
import tempfile

PROGRAM = os.environ.get("FRANA_PROGRAM", "frana")
HERE = os.path.dirname(os.path.abspath(__file__))
SETS = {"grid.cell": 2.5, "particles.per_cell": 9, "output.formats": [], "time.end": 30.0, "output.every": 0.1,
        "time.stop_at_rest": False}
STEPPING = """
import frana, json, sys
case = frana.Case(sys.argv[1], set=json.loads(sys.argv[3]))
with case.run(sys.argv[2], threads=1, overwrite=True, until=float(sys.argv[4])) as run:
    for frame in run:
        frame.grid["depth"].max()
"""
SMALL = """
import frana, sys, time
case = frana.Case(sys.argv[1])
for _ in range(2):  # the first one loads numpy
    start = time.process_time()
    with case.run(threads=1) as run:
        ready = time.process_time()
        particles = next(run).status.particles
        stepping = time.process_time()
        for frame in run:
            pass
        stepped = time.process_time()
    over = time.process_time()
print(particles, 1e3 * (ready - start + over - stepped), 1e3 * (stepped - stepping))
"""


def cpu(arguments):
    """Processor time of a child [s]."""
    child = subprocess.Popen(arguments, stdout=subprocess.DEVNULL, env={**os.environ, "OMP_NUM_THREADS": "1"})
    _, status, used = os.wait4(child.pid, 0)
    if status != 0:
        raise SystemExit(f"{arguments[0]} failed")
    child.returncode = 0
    return used.ru_utime + used.ru_stime


def instructions(arguments):
    """Instructions of a child, in 10^9."""
    counted = subprocess.run(["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", *arguments], check=True,
                             capture_output=True, text=True, env={**os.environ, "OMP_NUM_THREADS": "1", "PYTHONHASHSEED": "0"})
    return 1e-9 * int(re.search(r"Collected : (\d+)", counted.stderr).group(1))


def toml(value):
    return str(value).lower() if isinstance(value, bool) else str(value)


def steps_by_program(case, out, short, long, cost):
    sets = [part for key, value in SETS.items() for part in ("--set", f"{key}={toml(value)}")]

    def call(until):
        return cost([PROGRAM, "run", case, "--out", out, "--overwrite", "--quiet", "--threads", "1", "--until", str(until), *sets])

    return call(long) - call(short)


def steps_by_python(case, out, short, long, cost):
    import json

    def call(until):
        return cost([sys.executable, "-c", STEPPING, case, out, json.dumps(SETS), str(until)])

    return call(long) - call(short)


def stepping(case, pairs, cost, unit, end):
    """Median excess of Python over the program [1]."""
    ratios = []
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(pairs):
            with concurrent.futures.ThreadPoolExecutor(2) as pool:
                waits = {name: pool.submit(measured, case, os.path.join(folder, name), 1.0, end, cost)
                         for name, measured in (("program", steps_by_program), ("python", steps_by_python))}
                both = {name: wait.result() for name, wait in waits.items()}
            ratios.append(both["python"] / both["program"] - 1.0)
            print(f"  steps: program {both['program']:.3f} {unit}, Python {both['python']:.3f} {unit}, {100 * ratios[-1]:+.2f} %",
                  flush=True)
    return statistics.median(ratios)


def importing():
    """Processor time of the import [s]."""
    return min(cpu([sys.executable, "-c", "import frana"]) for _ in range(5)) - \
        min(cpu([sys.executable, "-c", "pass"]) for _ in range(5))


def beyond_stepping():
    """Of a case of about 1000 particles: what case.run() costs beyond its steps [ms]."""
    sys.path.insert(0, HERE)
    import common

    with tempfile.TemporaryDirectory() as folder:
        case = common.write_case(folder)
        with open(case, encoding="utf-8") as file:
            text = file.read().replace("per_cell = 4", "per_cell = 64")
        with open(case, "w", encoding="utf-8") as file:
            file.write(text)
        said = [subprocess.run([sys.executable, "-c", SMALL, case], check=True, capture_output=True, text=True).stdout.split()
                for _ in range(5)]
    particles, beyond, steps = min(said, key=lambda row: float(row[1]))
    print(f"  {particles} particles: {float(beyond):.1f} ms beyond {float(steps):.1f} ms of steps")
    return float(beyond)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("case", nargs="?", default=os.path.join(HERE, "..", "..", "cases", "maungawhau", "case.toml"))
    parser.add_argument("--pairs", type=int, default=7)
    parser.add_argument("--count", action="store_true")
    given = parser.parse_args()
    steps = (1, instructions, "x 10^9", 5.0) if given.count else (given.pairs, cpu, "s", SETS["time.end"])
    if given.count and shutil.which("valgrind") is None:
        raise SystemExit("--count needs valgrind (package valgrind)")
    timed = [] if given.count else [("import frana", importing(), 0.15, "s"),
                                    ("case.run() beyond its steps", beyond_stepping(), 50.0, "ms")]
    found = [*timed, ("steps through Python", 100.0 * stepping(os.path.abspath(given.case), *steps), 1.0, "% more")]
    for name, value, gate, unit in found:
        print(f"{name}: {value:.3g} {unit}, at most {gate:g}: {'well' if value <= gate else 'MISSED'}")
    return int(any(value > gate for _, value, gate, _ in found))


if __name__ == "__main__":
    sys.exit(main())
