#!/usr/bin/env python3
"""What frana finds on real terrain, figure by figure, as a table.

    python3 tests/real/table.py build/bin/frana DATA OUT [NAME ...]

reads terrain and surveys in DATA where they lie and leaves its runs in OUT; what is there is not run again. Names pick rows:
ryggfonn, alr, codes, rest, reach, deposit. Needs numpy and GDAL's module. The table stands in src/checks/verify/README.md.
"""
import json
import math
import pathlib
import subprocess
import sys

import numpy
from osgeo import gdal

PROGRAM, DATA, OUT = sys.argv[1], pathlib.Path(sys.argv[2]).resolve(), pathlib.Path(sys.argv[3]).resolve()
GRAVITY = 9.81
SHOWN = 0.1  # [m], as output.footprint_depth


def run(name, text):
    """Runs a case, once, and returns its folder. The text may use {data}."""
    folder = OUT / name
    if not (folder / "run.json").exists():
        OUT.mkdir(parents=True, exist_ok=True)
        case = OUT / f"{name}.toml"
        case.write_text(text.replace("{data}", str(DATA)))
        done = subprocess.run([PROGRAM, "run", str(case), "--out", str(folder), "--quiet", "--overwrite"],
                              capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"{case}: {done.stderr}")
    return Run(folder)


class Grid:
    """A single band, north row first; NaN for nodata."""

    def __init__(self, path):
        source = gdal.Open(str(path))
        band = source.GetRasterBand(1)
        self.array = band.ReadAsArray().astype(float)
        if band.GetNoDataValue() is not None:
            self.array[self.array == band.GetNoDataValue()] = numpy.nan
        self.west, self.cell, _, self.north, _, _ = source.GetGeoTransform()


class Run:
    """The folder of a run."""

    def __init__(self, folder):
        self.folder = folder
        self.record = json.loads((folder / "run.json").read_text())

    def __getitem__(self, name):
        return Grid(self.folder / "rasters" / f"{name}.tif")

    def __contains__(self, name):
        return (self.folder / "rasters" / f"{name}.tif").exists()


def row(what, before, now):
    print(f"| {what} | {before} | {now} |", flush=True)


def output(every=1000, formats='["geotiff"]'):
    return f"[output]\nevery = {every}\nformats = {formats}\nextent = \"terrain\"\n"


def ryggfonn(cell=5, mu=0.4, end=800, at_rest=True, every=1000, extra=""):
    return f"""
[terrain]
dem = "{{data}}/ryggfonn_2021/dem.tif"
[grid]
cell = {cell}
[material]
density = 250.0
bed = {{ law = "voellmy", mu = {mu}, xi = 9810.0 }}
[time]
end = {end}
stop_at_rest = {str(at_rest).lower()}
[[release]]
outline = "{{data}}/ryggfonn_2021/release.geojson"
depth = 1.0
thickness = "normal"
{extra}
{output(every)}"""


def alr():
    return f"""
[terrain]
dem = "{{data}}/avaframe_alr/dem.tif"
[material]
density = 200.0
bed = {{ law = "voellmy", mu = 0.155, xi = 4000.0 }}
[time]
end = 118.8
[[release]]
outline = "{{data}}/avaframe_alr/release.geojson"
depth = 1.0
thickness = "normal"
{output()}"""


def isee(name, law):
    return f"""
[terrain]
dem = "{{data}}/{name}/dem.tif"
[material]
density = 200.0
bed = {law}
[time]
end = 400
stop_at_rest = true
[[release]]
outline = "{{data}}/{name}/release.geojson"
depth = 1.5
thickness = "normal"
{output()}"""


def frank(end=400, at_rest=True):
    return f"""
[terrain]
dem = "{{data}}/frank_1903/dem.tif"
[material]
density = 2000.0
bed = {{ law = "coulomb", friction_angle_deg = 15.0 }}
[time]
end = {end}
stop_at_rest = {str(at_rest).lower()}
[[release]]
depth = "{{data}}/frank_1903/release.tif"
{output()}"""


def olivares(track, end=7200, at_rest=True, every=1000, extra=""):
    sources = json.loads((DATA / "olivares_east/sources.geojson").read_text())
    [place] = [f["geometry"]["coordinates"] for f in sources["features"] if f["properties"]["id"] == track]
    ring = [[place[0] + 40 * math.cos(math.radians(a)), place[1] + 40 * math.sin(math.radians(a))]
            for a in range(0, 361, 30)]
    sources["features"] = [{"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": [ring]}}]
    OUT.mkdir(parents=True, exist_ok=True)
    (OUT / f"olivares_{track}.geojson").write_text(json.dumps(sources))
    return f"""
[terrain]
dem = "{{data}}/olivares_east/dem.tif"
[material]
density = 2000.0
bed = {{ law = "voellmy", mu = 0.25, xi = 1500.0 }}
[time]
end = {end}
stop_at_rest = {str(at_rest).lower()}
[[release]]
outline = "olivares_{track}.geojson"
depth = 2.0
{extra}
{output(every)}"""


def over_the_line(folder):
    """Largest v^2 / 2 g over the drop from the release's top, half a cell allowed for the node's own place."""
    z, speed, depth, arrival = (folder[n].array for n in ("elevation", "peak_speed", "peak_depth", "arrival_time"))
    wet, start = depth > SHOWN, arrival == 0
    top = numpy.nanmax((z + depth)[start & wet])
    drop = numpy.maximum(top - z + 0.5 * folder["peak_speed"].cell, 1e-3)
    return float(numpy.nanmax((speed / numpy.sqrt(2 * GRAVITY * drop))[wet]))


def peaks_on_ryggfonn():
    high, most, ratio, told = [], [], [], []
    for cell in (10, 5, 2.5):
        folder = run(f"ryggfonn_{cell:g}m", ryggfonn(cell, end=60, at_rest=False))
        speed, depth = folder["peak_speed"].array, folder["peak_depth"].array
        wet = numpy.sort(speed[depth > SHOWN])
        high.append(wet[int(0.999 * (len(wet) - 1))])
        most.append(wet[-1])
        ratio.append(over_the_line(folder))
        told.append(folder.record["results"]["max_speed"])
    three = lambda values: ", ".join(f"{v:.1f}" for v in values)
    row("Ryggfonn, 99.9th percentile of the peak speed on 10, 5, 2.5 m [m/s]", "41.8, 43.4, 48.2", three(high))
    row("Ryggfonn, largest peak speed in the raster on 5 m; fastest in the report [m/s]", "48.2; 33.7",
        f"{most[1]:.1f}; {told[1]:.1f}")
    row("Ryggfonn, largest speed over that of the energy line, on 10, 5, 2.5 m", "", ", ".join(f"{r:.2f}" for r in ratio))


def thickness(folder):
    """Largest thickness across the bed: the vertical one times the cosine of the slope."""
    z = folder["elevation"]
    dy, dx = numpy.gradient(z.array, z.cell)
    return numpy.nan_to_num(folder["peak_depth"].array / numpy.sqrt(1 + dx ** 2 + dy ** 2))


def error(ours, theirs):
    """Relative L1, and how much deeper ours are where both are [%]."""
    both = (ours > SHOWN) & (theirs > SHOWN)
    return numpy.abs(ours - theirs).sum() / theirs.sum(), 100 * (ours[both].sum() / theirs[both].sum() - 1)


def compare_on_alr():
    for transfer in ("tpic", "pic"):
        folder = run(f"alr_{transfer}", alr() + f'[scheme]\ntransfer = "{transfer}"\n')
        ours, depth = thickness(folder), folder["peak_depth"]
        wet = ours > SHOWN
        theirs = {kind: on(depth, Grid(DATA / f"avaframe_alr/com1dfa_{kind}_peak_thickness.tif")) for kind in ("visc", "novisc")}
        iou = {kind: (wet & (t > SHOWN)).sum() / (wet | (t > SHOWN)).sum() for kind, t in theirs.items()}
        what = "Alr" if transfer == "tpic" else 'Alr with scheme.transfer = "pic"'
        first = transfer == "tpic"
        row(f"{what}: IoU with com1DFA with and without its viscosity", "0.39, 0.71" if first else "",
            f"{iou['visc']:.2f}, {iou['novisc']:.2f}")
        row(f"{what}: area above 0.1 m [1000 m2] (com1DFA 362, 679)", "713" if first else "",
            f"{wet.sum() * depth.cell ** 2 / 1000:.0f}")
        speed = folder["peak_speed"].array[wet]
        row(f"{what}: largest and 99th percentile of the peak speed [m/s] (com1DFA 57, 54)", "82, 62" if first else "",
            f"{speed.max():.0f}, {numpy.percentile(speed, 99):.0f}")
        mass = folder.record["budgets"]["mass"]
        row(f"{what}: mass that leaves the map [%]", "16 to 18" if first else "", f"{100 * mass['left_domain'] / mass['initial']:.1f}")
        for kind, t in theirs.items():
            l1, bias = error(ours, t)
            row(f"{what}: peak thickness from com1DFA {'with' if kind == 'visc' else 'without'} viscosity (relative L1; bias)", "",
                f"{l1:.2f}; {bias:+.0f} %")
        if first:
            row("Alr: largest speed over that of the energy line", "above 1", f"{over_the_line(folder):.2f}")


def on(target, source):
    """A raster's values at the pixels of another with the same cells; 0 elsewhere."""
    rows, columns = target.array.shape
    x0 = round((target.west - source.west) / source.cell)
    y0 = round((source.north - target.north) / source.cell)
    result = numpy.zeros((rows, columns))
    r = numpy.arange(rows)[:, None] + y0
    c = numpy.arange(columns)[None, :] + x0
    inside = (r >= 0) & (r < source.array.shape[0]) & (c >= 0) & (c < source.array.shape[1])
    result[inside] = numpy.nan_to_num(source.array[numpy.broadcast_to(r, inside.shape)[inside],
                                                   numpy.broadcast_to(c, inside.shape)[inside]])
    return result


def compare_with_codes():
    laws = {"iseesnow_idealized": '{ law = "voellmy", mu = 0.4, xi = 2000.0 }',
            "iseesnow_coulomb": '{ law = "coulomb", mu = 0.4 }'}
    for name, law in laws.items():
        folder = run(name, isee(name, law))
        depth, ours = folder["peak_depth"], thickness(folder)
        median = on(depth, Grid(DATA / name / "reference/ensemble_median_pft.tif"))
        codes = [error(on(depth, Grid(path)), median)[0] for path in sorted((DATA / name / "reference").glob("*_pft.tif"))
                 if not path.name.startswith(("ensemble", "flo2d"))]
        l1, bias = error(ours, median)
        row(f"{name}: peak thickness from the codes' median (relative L1; bias; the codes themselves)", "",
            f"{l1:.2f}; {bias:+.0f} %; {min(codes):.2f} to {max(codes):.2f}")
        speed = numpy.percentile(folder["peak_speed"].array[depth.array > SHOWN], 99)
        row(f"{name}: 99th percentile of the peak speed [m/s]", "", f"{speed:.1f}")
    folder = run("frank_rest", frank())
    theirs = on(folder["peak_depth"], Grid(DATA / "frank_1903/reference/shaltop_delta15_h_max_normal.tif"))
    l1, bias = error(thickness(folder), theirs)
    row("Frank, 15 degrees: peak thickness from SHALTOP (relative L1; bias)", "", f"{l1:.2f}; {bias:+.0f} %")


def in_blocks(raster, count):
    """Sums over blocks of count x count pixels."""
    field = numpy.nan_to_num(raster.array)
    rows, columns = (n // count * count for n in field.shape)
    return field[:rows, :columns].reshape(rows // count, count, columns // count, count).sum((1, 3))


def apart(first, second, count):
    """Relative L1 of two deposits over blocks [%]."""
    a, b = (in_blocks(run["final_depth"], count) for run in (first, second))
    return 100 * numpy.abs(a - b).sum() / a.sum()


def rest_is_rest():
    cases = [("ryggfonn", lambda **k: ryggfonn(**k))] + [(f"olivares_{t}", lambda t=t, **k: olivares(t, **k)) for t in (30, 33, 51)]
    cases.append(("frank", lambda **k: frank(**k)))
    for name, case in cases:
        stopped = run(f"{name}_rest", case())
        time, why = stopped.record["simulated_time"], stopped.record["rest"]
        on_and_on = run(f"{name}_on", case(end=2 * time, at_rest=False))
        share = 0.5 * apart(stopped, on_and_on, 2)  # what goes elsewhere is missing in one block and too much in another
        toes = [f.record["results"]["max_front"] for f in (stopped, on_and_on)]
        row(f"{name}: deposit that lies in other blocks of two cells after twice the time [%]; toe goes on by [cells]",
            {"frank": "10", "ryggfonn": "a branch goes on by 160 m"}.get(name, ""),
            f"{share:.2f}; {(toes[1] - toes[0]) / stopped['final_depth'].cell:.1f} "
            f"(ends at {time:.0f} s, {100 * why['moving_mass_share']:.1f} % moving)")


def reach():
    cases = [("ryggfonn", lambda **k: ryggfonn(**k))] + [(f"olivares_{t}", lambda t=t, **k: olivares(t, **k)) for t in (30, 33, 51)]
    for name, case in cases:
        by_every = [run(f"{name}_every{e}", case(every=e)) for e in (1, 5, 1000)]
        by_number = [run(f"{name}_per{n}", case(extra=f"[particles]\nper_cell = {n}\n")) for n in (4, 9, 16)]
        cell = by_every[0]["final_depth"].cell
        spread = lambda runs: numpy.ptp([r.record["results"]["max_front"] for r in runs]) / cell
        row(f"{name}: reach lies apart by, for output.every 1, 5, 1000 s; per_cell 4, 9, 16 [cells]", "up to 8 (100 m)",
            f"{spread(by_every):.1f}; {spread(by_number):.1f}; "
            f"flow is {by_every[0].record['flow_width_cells']:.1f} cells wide")


def deposits():
    first, second = run("ryggfonn_rest", ryggfonn()), run("ryggfonn_mu", ryggfonn(mu=0.4004))
    row("Ryggfonn, final depth for 0.1 % more friction, blocks of 20 m (relative L1) [%]", "11 for 0.17 %",
        f"{apart(first, second, round(20 / first['final_depth'].cell)):.1f}")


ROWS = {"ryggfonn": peaks_on_ryggfonn, "alr": compare_on_alr, "codes": compare_with_codes, "rest": rest_is_rest,
        "reach": reach, "deposit": deposits}

print("| Figure | 0db0741 | now |\n|---|---|---|")
for name in sys.argv[4:] or ROWS:
    ROWS[name]()
