#!/usr/bin/env python3
"""What frana finds on real terrain, figure by figure, as a table.

    python3 tests/real/table.py build/bin/frana DATA OUT [NAME ...]

reads terrain and surveys in DATA where they lie and leaves its runs in OUT; what is there is not run again. Names pick rows:
ryggfonn, alr, waves, volumes, codes, rest, friction, reach, deposit, torrents, grown. Needs numpy and GDAL's module. The table stands in src/checks/verify/README.md.
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


def row(what, before, now):
    print(f"| {what} | {before} | {now} |", flush=True)


def slide(dem, bed, release, density, end, at_rest=True, every=1000, extra=""):
    """The text of a case, all of whose terrain is in its rasters."""
    return f"""
[terrain]
dem = "{{data}}/{dem}/dem.tif"
[material]
density = {density}
bed = {bed}
[time]
end = {end}
stop_at_rest = {str(at_rest).lower()}
[output]
every = {every}
formats = ["geotiff"]
extent = "terrain"
[[release]]
{release}
{extra}
"""


def across_the_slope(name, depth):
    return f'outline = "{{data}}/{name}/release.geojson"\ndepth = {depth}\nthickness = "normal"'


def ryggfonn(cell=5, mu=0.4, extra="", end=800, **more):
    return slide("ryggfonn_2021", f'{{ law = "voellmy", mu = {mu}, xi = 9810.0 }}', across_the_slope("ryggfonn_2021", 1.0),
                 250.0, end, extra=f"[grid]\ncell = {cell}\n{extra}", **more)


def alr(cell=5, bed='{ law = "voellmy", mu = 0.155, xi = 4000.0 }', extra=""):
    return slide("avaframe_alr", bed, across_the_slope("avaframe_alr", 1.0), 200.0, 118.8, at_rest=False,
                 extra=f"[grid]\ncell = {cell}\n{extra}")


def isee(name, bed):
    return slide(name, bed, across_the_slope(name, 1.5), 200.0, 400)


def frank(end=400, **more):
    return slide("frank_1903", '{ law = "coulomb", friction_angle_deg = 15.0 }', 'depth = "{data}/frank_1903/release.tif"',
                 2000.0, end, **more)


def olivares(track, end=7200, mu=0.25, xi=1500.0, radius=40.0, **more):
    sources = json.loads((DATA / "olivares_east/sources.geojson").read_text())
    [place] = [f["geometry"]["coordinates"] for f in sources["features"] if f["properties"]["id"] == track]
    ring = [[place[0] + radius * math.cos(math.radians(a)), place[1] + radius * math.sin(math.radians(a))]
            for a in range(0, 361, 30)]
    sources["features"] = [{"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": [ring]}}]
    OUT.mkdir(parents=True, exist_ok=True)
    (OUT / f"olivares_{track}_{radius:g}.geojson").write_text(json.dumps(sources))
    return slide("olivares_east", f'{{ law = "voellmy", mu = {mu}, xi = {xi} }}',
                 f'outline = "olivares_{track}_{radius:g}.geojson"\ndepth = 2.0', 2000.0, end, **more)


def torrent(track, growth):
    """A slide of 2900 m3 at a mapped source, on loose ground within the mapped track."""
    mapped = json.loads((DATA / "olivares_east/footprint.geojson").read_text())
    mapped["features"] = [f for f in mapped["features"] if f["properties"]["id"] == track]
    OUT.mkdir(parents=True, exist_ok=True)
    (OUT / f"mapped_{track}.geojson").write_text(json.dumps(mapped))
    loose = f"""[erodible]
law = "growth"
growth = {growth}
depth = 3.0
outline = "mapped_{track}.geojson"
"""
    return olivares(track, mu=0.10, xi=200.0, radius=22.0, end=3600, extra=f"""[survey]
footprint = "mapped_{track}.geojson"
{loose if growth else ""}""")


def events():
    """Names, and their cases by what is changed of them."""
    return [("ryggfonn", ryggfonn)] + [
        (f"olivares_{track}", lambda track=track, **more: olivares(track, **more)) for track in (30, 33, 51)]


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
        folder = run(f"alr_{transfer}", alr(extra=f'[scheme]\ntransfer = "{transfer}"\n'))
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


def waves_on_alr():
    """Sums of peak thickness over com1DFA's without viscosity, in bands of height."""
    theirs, z0 = (Grid(DATA / "avaframe_alr" / f"{name}.tif") for name in ("com1dfa_novisc_peak_thickness", "dem"))
    coulomb = '{ law = "coulomb", mu = 0.4 }'
    for what, more in (("Voellmy", {}), ("Voellmy, no merging", {"extra": "[scheme]\nmerge = false\n"}),
                       ("Coulomb 0.4", {"bed": coulomb})):
        sums = []
        for cell in (10, 5, 2.5):
            folder = run(f"alr_{what}_{cell:g}m".replace(" ", "_").replace(",", ""), alr(cell, **more))
            ours, z = thickness(folder), folder["elevation"].array
            bands = [(z >= low) & (z < low + 200) for low in (2200, 1200)]
            there = [(z0.array >= low) & (z0.array < low + 200) for low in (2200, 1200)]
            sums.append(" and ".join(f"{ours[b].sum() * cell ** 2 / (numpy.nansum(theirs.array[t]) * theirs.cell ** 2):.2f}"
                                     for b, t in zip(bands, there)))
        row(f"Alr, {what}: sum of peak thickness over com1DFA's from 2200 and from 1200 m, on 10, 5, 2.5 m", "", "; ".join(sums))


def as_volumes(text):
    """The same case by finite volumes: the scheme of free water, by the bed law of the case."""
    density = text.split("density = ")[1].split()[0]
    return text.replace(f"density = {density}\n", "") + f'[water]\nmodel = "free"\ndensity = {density}\n'


def means_from_the_south_west(raster, count):
    """Means over blocks of count x count pixels."""
    field = numpy.nan_to_num(raster.array)[::-1]
    rows, columns = (n // count * count for n in field.shape)
    return field[:rows, :columns].reshape(rows // count, count, columns // count, count).mean((1, 3))


def beside_finite_volumes():
    """Peak depths of both schemes, on their cells and on half of them, from finite volumes on half: relative L1, over blocks of
    the larger cells; footprints' intersection over union; sums."""
    for name, case, cells in (("frank", lambda cell: frank(end=150, at_rest=False, extra=f"[grid]\ncell = {cell}\n"), (20, 10)),
                              ("ryggfonn", lambda cell: ryggfonn(cell, end=60, at_rest=False), (5, 2.5)),
                              ("olivares_33", lambda cell: olivares(33, end=60, at_rest=False,
                                                                    extra=f"[grid]\ncell = {cell}\n"), (12.5, 6.25))):
        runs = {(way, cell): run(f"{name}_{way}_{cell:g}m", case(cell) if way == "columns" else as_volumes(case(cell)))
                for cell in cells for way in ("columns", "volumes")}
        blocks = {key: means_from_the_south_west(folder["peak_depth"], round(cells[0] / key[1])) for key, folder in runs.items()}
        rows, columns = (min(b.shape[axis] for b in blocks.values()) for axis in (0, 1))
        blocks = {key: b[:rows, :columns] for key, b in blocks.items()}
        fine = blocks["volumes", cells[1]]
        for key, b in blocks.items():
            both = ((b > SHOWN) & (fine > SHOWN)).sum() / ((b > SHOWN) | (fine > SHOWN)).sum()
            row(f"{name}, {key[0]} on {key[1]:g} m: peak depth from finite volumes on {cells[1]:g} m (relative L1; sum; IoU)", "",
                f"{numpy.abs(b - fine).sum() / fine.sum():.3f}; {b.sum() / fine.sum():.2f}; {both:.2f}")


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


def to_rest_and_on(name, case, **changed):
    """A run to its rest, one for twice the time, and the share that lies in other blocks of two cells then [%]."""
    stopped = run(f"{name}_rest", case(**changed))
    on_and_on = run(f"{name}_on", case(end=2 * stopped.record["simulated_time"], at_rest=False, **changed))
    return stopped, on_and_on, 0.5 * apart(stopped, on_and_on, 2)  # missing in one block, too much in another


def rest_is_rest():
    for name, case in events() + [("frank", frank)]:
        stopped, on_and_on, share = to_rest_and_on(name, case)
        time, why = stopped.record["simulated_time"], stopped.record["rest"]
        toes = [f.record["results"]["max_front"] for f in (stopped, on_and_on)]
        row(f"{name}: deposit that lies in other blocks of two cells after twice the time [%]; toe goes on by [cells]",
            "10" if name == "frank" else "",
            f"{share:.2f}; {(toes[1] - toes[0]) / stopped['final_depth'].cell:.1f} "
            f"(ends at {time:.0f} s, {100 * why['moving_mass_share']:.1f} % moving)")


def rest_for_any_friction():
    """One run may be lucky: a heap on a slope as steep as its friction gives way at some time or never."""
    for name, case in events():
        if name == "ryggfonn":
            continue
        shares = [to_rest_and_on(f"{name}_{mu}", case, mu=mu)[2]
                  for mu in (0.248, 0.249, 0.2495, 0.25, 0.2505, 0.251, 0.252)]
        row(f"{name}: the same for seven mu within 1 %, mean; largest", "",
            f"{numpy.mean(shares):.2f}; {max(shares):.1f}")


def reach():
    for name, case in events():
        by_every = [run(f"{name}_every{e}", case(every=e)) for e in (1, 5, 1000)]
        by_number = [run(f"{name}_per{n}", case(extra=f"[particles]\nper_cell = {n}\n")) for n in (4, 9, 16)]
        cell = by_every[0]["final_depth"].cell
        spread = lambda runs: numpy.ptp([r.record["results"]["max_front"] for r in runs]) / cell
        row(f"{name}: reach lies apart by, for output.every 1, 5, 1000 s; per_cell 4, 9, 16 [cells]", "to 100 m in a gully",
            f"{spread(by_every):.1f}; {spread(by_number):.1f}; "
            f"flow is {by_every[0].record['flow_width_cells']:.1f} cells wide")


def growth_of_torrents():
    for growth in (0, 5e-4, 1e-3, 1.5e-3, 2e-3):
        cells = []
        for track in (30, 33, 51):
            done = run(f"torrent_{track}_{growth:g}", torrent(track, growth))
            scores = json.loads((done.folder / "compare.json").read_text())
            cells.append(f"{done.record['budgets']['mass']['final'] / 2000:.0f} m3, {scores['runout_difference']:.0f} m, "
                         f"recall {scores['recall']:.2f}, fastest {done.record['results']['max_speed']:.0f} m/s")
        row(f"growth {growth:g}: volume at the end, toe beyond the mapped one; tracks 30, 33, 51", "", "; ".join(cells))


def growth_on_cells():
    """What a flow takes up must not hang on the cell."""
    laws = {"growth": "growth = 3e-4", "shear": "threshold = 8000.0", "energy": "energy = 5000.0"}
    on = {"Ryggfonn, 10, 5, 2.5 m": (
              (10, 5, 2.5), {"growth": "growth = 5e-4\ndensity = 140"}, 0.5,
              lambda cell, extra: ryggfonn(cell, end=200, at_rest=False, extra=extra)),
          "Olivares track 33, 12.5, 6.25, 4 m": (
              (12.5, 6.25, 4), laws, 1.0,
              lambda cell, extra: olivares(33, mu=0.12, xi=300.0, end=900, extra=f"[grid]\ncell = {cell:g}\n{extra}"))}
    for place, (cells, of_place, depth, case) in on.items():
        for law, keys in of_place.items():
            grown, fastest = [], []
            for cell in cells:
                loose = f'[erodible]\nlaw = "{law}"\ndepth = {depth}\n{keys}\n'
                record = run(f"grown_{law}_{place.split(',')[0].replace(' ', '_')}_{cell:g}", case(cell, loose)).record
                mass = record["budgets"]["mass"]
                grown.append(f"{mass['final'] / mass['initial']:.2f}")
                fastest.append(f"{record['results']['max_speed']:.1f}")
            row(f"{place}: mass at the end over the released, law {law}; fastest [m/s]", "",
                f"{', '.join(grown)}; {', '.join(fastest)}")


def deposits():
    first, second = run("ryggfonn_rest", ryggfonn()), run("ryggfonn_mu", ryggfonn(mu=0.4004))
    row("Ryggfonn, final depth for 0.1 % more friction, blocks of 20 m (relative L1) [%]", "11 for 0.17 %",
        f"{apart(first, second, round(20 / first['final_depth'].cell)):.1f}")


ROWS = {"ryggfonn": peaks_on_ryggfonn, "alr": compare_on_alr, "waves": waves_on_alr, "volumes": beside_finite_volumes, "codes": compare_with_codes, "rest": rest_is_rest,
        "friction": rest_for_any_friction,
        "reach": reach, "deposit": deposits, "torrents": growth_of_torrents, "grown": growth_on_cells}

print("| Figure | 0db0741 | now |\n|---|---|---|")
for name in sys.argv[4:] or ROWS:
    ROWS[name]()
