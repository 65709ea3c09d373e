"""What the page of a run says of itself (its #check) against history.csv, gauges and run.json. web_page.py DOM RUN_DIR"""
import csv
import html
import json
import pathlib
import re
import sys

dom, run = pathlib.Path(sys.argv[1]).read_text(encoding="utf-8"), pathlib.Path(sys.argv[2])
told = re.search(r'<pre id="check">(.*?)</pre>', dom, re.S)
if not told:
    sys.exit("the page told nothing: " + " ".join(re.findall(r'<p id="trouble"[^>]*>(.*?)</p>', dom)))
page = json.loads(html.unescape(told.group(1)))
record = json.loads((run / "run.json").read_text(encoding="utf-8"))
cell = record["grid"]["cell"]


def table(file):
    with open(run / file, encoding="utf-8") as stream:
        rows = list(csv.reader(stream))
    columns = [name.split(" [")[0] for name in rows[0]]
    return [dict(zip(columns, (float(cell or "nan") for cell in row))) for row in rows[1:]]


def at(rows, time, column):
    """Frames stand between steps: linear between two rows."""
    for a, b in zip(rows, rows[1:]):
        if a["t"] <= time <= b["t"]:
            share = (time - a["t"]) / (b["t"] - a["t"])
            return (1 - share) * a[column] + share * b[column]
    return rows[0 if time < rows[0]["t"] else -1][column]


wrong = []
history, gauge = table("history.csv"), table("gauges/rim.csv")
deepest = record["results"]["max_depth"]
for k, time in enumerate(page["times"]):
    # Each depth is known to half a step of its root: a few times sqrt(depth * deepest) / 255, of either sign. What is
    # thinner than a hundredth of the footprint depth is not kept.
    volume = at(history, time, "mass") / record["budgets"]["mass"]["initial"] * record["release_volume"]
    if abs(page["volume"][k] - volume) > 0.01 * volume:
        wrong.append(f"t = {time}: volume {page['volume'][k]:.1f}, by the masses {volume:.1f} m3")
    # From the middle of the depths of the first frame instead of that of the particles.
    front = at(history, time, "front")
    if abs(page["runout"][k] - front) > cell:
        wrong.append(f"t = {time}: runout {page['runout'][k]:.1f}, by history.csv {front:.1f} m")
    depth, found = at(gauge, time, "depth"), page["gauges"][0]["depth"][k]
    # A step is a fifth of the time in which the depth halves: linear between two of them is known to a hundredth.
    if abs(found - depth) > (depth * deepest) ** 0.5 / 255 + 0.01 * depth + 1e-3:
        wrong.append(f"t = {time}: depth at the gauge {found:.4f}, by its table {depth:.4f} m")
ready = re.search(r'data-ready="(\d+)"', dom)
print(f"{len(page['times'])} frames, {3 * len(page['times'])} numbers read back, ready after {ready.group(1)} ms; "
      f"deepest at the gauge {max(page['gauges'][0]['depth']):.2f} m")
if len(page["times"]) < 5 or max(page["gauges"][0]["depth"]) <= 0.1:
    wrong.append("the case shows too little to compare")
for line in wrong:
    print(line)
sys.exit(1 if wrong else 0)
