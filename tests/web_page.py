"""What pages say of themselves (#check), and what the probe found in them, against what runs left. web_page.py WORK_FOLDER"""
import csv
import ctypes
import ctypes.util
import html
import json
import math
import pathlib
import re
import sys

work = pathlib.Path(sys.argv[1])
wrong = []


def expect(right, text):
    if not right:
        wrong.append(text)


def told(name, what):
    """What a page wrote into an element of its own."""
    dom = (work / (name + ".dom")).read_text(encoding="utf-8")
    found = re.search(rf'<pre id="{what}">(.*?)</pre>', dom, re.S)
    if not found:
        sys.exit(f"{name}: no #{what}: " + " ".join(re.findall(r'<p id="trouble"[^>]*>(.*?)</p>', dom)))
    return json.loads(html.unescape(found.group(1)))


def ready(name):
    return re.search(r'data-ready="(\d+)"', (work / (name + ".dom")).read_text(encoding="utf-8")).group(1)


def page_of(folder):
    """The data of a page, whose file is no larger than can be sent on."""
    text = (work / folder / "figures" / "view.html").read_text(encoding="utf-8")
    expect(len(text.encode()) < 1.5e6, f"{folder}: the page has {len(text.encode())} bytes; expected less than 1.5e6")
    return json.loads(re.search(r'id="data">(.*?)</script>', text, re.S).group(1))


def table(file):
    with open(file, encoding="utf-8") as stream:
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


def raster(file):
    """{(x, y): value} of a raster's pixels that have one, by GDAL."""
    lib = ctypes.CDLL(ctypes.util.find_library("gdal"))
    lib.GDALAllRegister()
    lib.GDALOpen.restype = lib.GDALGetRasterBand.restype = ctypes.c_void_p
    lib.GDALGetRasterNoDataValue.restype = ctypes.c_double
    dataset = ctypes.c_void_p(lib.GDALOpen(str(file).encode(), 0))
    transform = (ctypes.c_double * 6)()
    lib.GDALGetGeoTransform(dataset, transform)
    columns, rows = lib.GDALGetRasterXSize(dataset), lib.GDALGetRasterYSize(dataset)
    values = (ctypes.c_double * (columns * rows))()
    band = ctypes.c_void_p(lib.GDALGetRasterBand(dataset, 1))
    lib.GDALRasterIO(band, 0, 0, 0, columns, rows, values, columns, rows, 7, 0, 0)  # 7: GDT_Float64
    none = lib.GDALGetRasterNoDataValue(band, None)
    lib.GDALClose(dataset)
    return {(round(transform[0] + (n % columns + 0.5) * transform[1], 3),
             round(transform[3] + (n // columns + 0.5) * transform[5], 3)): value
            for n, value in enumerate(values) if value != none and not math.isnan(value)}


def check_frames():
    """Volume, runout and the depth at the gauge of each frame."""
    page, run = told("run", "check"), work / "run"
    record = json.loads((run / "run.json").read_text(encoding="utf-8"))
    cell, deepest = record["grid"]["cell"], record["results"]["max_depth"]
    history, gauge = table(run / "history.csv"), table(run / "gauges" / "rim.csv")
    for k, time in enumerate(page["times"]):
        # Each depth is known to half a step of its root: a few times sqrt(depth * deepest) / 255, of either sign. What is
        # thinner than a hundredth of the footprint depth is not kept.
        volume = at(history, time, "mass") / record["budgets"]["mass"]["initial"] * record["release_volume"]
        expect(abs(page["volume"][k] - volume) <= 0.01 * volume,
               f"t = {time}: volume {page['volume'][k]:.1f}, by the masses {volume:.1f} m3")
        # From the middle of the depths of the first frame instead of that of the particles.
        front = at(history, time, "front")
        expect(abs(page["runout"][k] - front) <= cell,
               f"t = {time}: runout {page['runout'][k]:.1f}, by history.csv {front:.1f} m")
        depth, found = at(gauge, time, "depth"), page["gauges"][0]["depth"][k]
        # A step is a fifth of the time in which the depth halves: linear between two of them is known to a hundredth.
        expect(abs(found - depth) <= (depth * deepest) ** 0.5 / 255 + 0.01 * depth + 1e-3,
               f"t = {time}: depth at the gauge {found:.4f}, by its table {depth:.4f} m")
    expect(len(page["times"]) >= 5 and max(page["gauges"][0]["depth"]) > 0.1, "the case shows too little to compare")
    print(f"{len(page['times'])} frames, {3 * len(page['times'])} numbers read back, ready after {ready('run')} ms; "
          f"deepest at the gauge {max(page['gauges'][0]['depth']):.2f} m")


def check_use():
    """Controls of pages, with and without WebGL; pointing; legends; a run in which nothing flows."""
    for name in ("run", "flat", "thin", "many"):
        errors = told(name, "probe")["errors"]
        expect(not errors, f"{name}: {errors[:3]}")
        expect("cannot show the page" not in told(name, "probe")["notes"], f"{name}: {told(name, 'probe')['notes']}")
        flat = told(name, "probe")["flat"]
        expect(flat == (name == "flat"), f"{name}: pictures in three dimensions are {'not ' if flat else ''}shown")
    found, data = told("run", "probe"), page_of("run")
    for field, top in (("depth", "deepest"), ("speed", "fastest")):
        beyond = max(frame.get(top, 0.0) for frame in data["frames"]) > data[field]["to"]
        expect(found["legends"][field].startswith("≥") == beyond, f"{field}: the legend ends at {found['legends'][field]}")
    pointing = found["pointing"]
    # On the ground behind the flow it would lie some depths away; the ray is halved to a thousandth of a cell.
    apart = math.dist(pointing["place"], pointing["found"] or (0, 0))
    expect(apart < 0.1 and pointing["depth"] > 1.0,
           f"pointing at {pointing['depth']:.2f} m of flow found a place {apart:.2f} m from it")
    for name in ("run", "flat", "many"):
        left = told(name, "probe")["left"]
        expect(left is not None and left >= 0, f"{name}: labels of a chart up to 4e7 m3 begin at {left}, and are cut")
    flowed = "Nothing flowed"
    expect(flowed in told("thin", "probe")["notes"], "a run below the footprint depth does not say that nothing flowed")
    expect(flowed not in found["notes"], "a run that flowed says that nothing did")
    print(f"pointed at {pointing['depth']:.2f} m of flow, found it {apart:.3f} m away")


def check_many():
    """Probabilities at thresholds and quantiles of all pixels; bounds of a probability."""
    page, many, read, compared = told("many", "check"), work / "many", 0, set()
    page_of("many")
    units = {"m": 1.0, "m/s": 1.0, "kPa": 1e3}
    for ladder in page["ladders"]:
        places = [(round(ladder["x"] + ladder["cell"] * (n % ladder["nx"]), 3),
                   round(ladder["y"] + ladder["cell"] * (n // ladder["nx"]), 3)) for n in range(ladder["nx"] * ladder["ny"])]
        for above, likelier in zip(ladder["above"], ladder["likelier"]):
            file = many / "rasters" / f"probability_{ladder['name']}_{above['threshold'] * units[ladder['unit']]:g}.tif"
            if not file.is_file():
                continue
            compared.add(file.name)
            truth = raster(file)
            shown = {place: p for place, p in zip(places, above["percents"]) if p is not None}
            expect(shown.keys() == truth.keys(), f"{file.name}: the page shows {len(shown)} pixels of {len(truth)}")
            # Runs weigh the same: the page holds whole numbers of them, rasters and page have float32.
            off = max(abs(shown[place] - 100 * p) for place, p in truth.items() if place in shown)
            expect(off < 1e-4, f"{file.name}: the page is off by {off} %")
            # Likelier than not: half of the runs is not enough.
            area = ladder["cell"] ** 2 * sum(p > 0.5 + 1e-6 for p in truth.values())
            expect(abs(likelier - area) < 1e-6 * max(1, area), f"{file.name}: {likelier} m2 are likelier than not, not {area}")
            read += len(truth)
        for k, q in enumerate((0.05, 0.5, 0.95)):
            truth = raster(many / "rasters" / f"quantile_{ladder['name']}_{q:g}.tif")
            largest = max(max(row) for row in ladder["quantiles"] if row)
            for place, row in zip(places, ladder["quantiles"]):
                value = truth[place] / units[ladder["unit"]] if row else 0.0
                # To half of a ten-thousandth of the largest.
                expect(row is None or abs(row[k] - value) <= 0.6e-4 * largest, f"{ladder['name']}, {q}: {row} instead of {value}")
            read += len(truth)
    written = {file.name for file in (many / "rasters").glob("probability_peak_*.tif") if file.stem[-1].isdigit()}
    expect(compared == written and written, f"compared {sorted(compared)} of {sorted(written)}")
    expect(read > 2000, f"only {read} numbers could be compared")
    for p, bounds in zip((0.0, 0.3, 1.0), page["wilson"]):
        for bound in bounds:  # where the difference is 1.96 of the bound's own standard errors, or nothing lies beyond
            error = 1.959963984540054 * (bound * (1 - bound) / page["effective"]) ** 0.5
            expect(abs(abs(bound - p) - error) < 1e-9, f"{p}: {bound} is no bound by Wilson")
    pointing, under = told("many", "probe")["pointing"], told("many", "probe")["under"]
    # Place, ground, probability, its bounds, three quantiles.
    expect(math.dist(pointing["place"], pointing["found"] or (0, 0)) < 0.1 and len(under) == 7, f"pointing tells {under}")
    print(f"ensemble: {len(page['ladders'])} fields, {read} numbers read back, ready after {ready('many')} ms; {under}")


check_frames()
check_use()
check_many()
for line in wrong[:20]:
    print(line)
sys.exit(1 if wrong else 0)
