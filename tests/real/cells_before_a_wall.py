#!/usr/bin/env python3
"""How what a wall feels in 3D hangs on the cells over the depth of the flow that strikes it.

    python3 tests/real/cells_before_a_wall.py build/bin/frana OUT [CELL ...]

lets a slide under Coulomb's law go down a plane of 25 degrees, in a lane 2 m wide with smooth sides, against a wall of 5 m. It
prints a row for each cell of the 3D stage (1, 0.5 and 0.25 m; the last takes seven minutes). Runs that are in OUT are not made
again. Needs numpy and GDAL's module. The table stands in src/coupling/README.md.
"""
import json
import pathlib
import subprocess
import sys

import numpy
from osgeo import gdal

PROGRAM, OUT = sys.argv[1], pathlib.Path(sys.argv[2]).resolve()
PIXEL, LENGTH, WIDTH, WALL = 0.5, 120.0, 2.0, 90.0  # [m]
SLOPE = numpy.tan(numpy.radians(25.0))
CASE = """[terrain]
dem = "dem.tif"
[grid]
cell = 0.5
[[release]]
outline = "release.geojson"
depth = 1.0
[material]
density = 1500.0
bed = {{ law = "coulomb", mu = 0.2 }}
[boundary]
sides = "wall"
[time]
end = 14
[output]
every = 0.5
formats = ["geotiff"]
[[barrier]]
name = "wall"
line = [[{wall}, 0], [{wall}, {width}]]
height = 5.0
[[stage]]
model = "depth_averaged"
until = 4.5
[[stage]]
model = "mpm3d"
window = [60, 0, 100, {width}]
cell = {cell}
"""


def write_terrain():
    columns, rows = round(LENGTH / PIXEL) + 1, round(WIDTH / PIXEL) + 1
    heights = SLOPE * (LENGTH - PIXEL * numpy.arange(columns))
    raster = gdal.GetDriverByName("GTiff").Create(str(OUT / "dem.tif"), columns, rows, 1, gdal.GDT_Float32)
    raster.SetGeoTransform((-PIXEL / 2, PIXEL, 0, WIDTH + PIXEL / 2, 0, -PIXEL))
    raster.GetRasterBand(1).WriteArray(numpy.tile(heights, (rows, 1)))
    ring = [[5, 0], [30, 0], [30, WIDTH], [5, WIDTH], [5, 0]]
    (OUT / "release.geojson").write_text(json.dumps({"type": "FeatureCollection", "features": [
        {"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": [ring]}}]}))


def result_on(cell):
    folder = OUT / f"cell_{cell:g}"
    if not (folder / "report.md").exists():
        case = OUT / f"cell_{cell:g}.toml"
        case.write_text(CASE.format(cell=cell, wall=WALL, width=WIDTH))
        done = subprocess.run([PROGRAM, "run", str(case), "--out", str(folder), "--quiet", "--overwrite"],
                              capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"{case}: {done.stderr}")
    return json.loads((folder / "run.json").read_text())["barriers"][0]


OUT.mkdir(parents=True, exist_ok=True)
write_terrain()
foot = SLOPE * (LENGTH - WALL)
print("| Cell | Force on a metre of the wall | Run-up above the foot | Over a metre of the wall |\n|---|---|---|---|")
for cell in [float(text) for text in sys.argv[3:]] or [1.0, 0.5, 0.25]:
    wall = result_on(cell)
    [force] = [mean["largest"] for mean in wall["mean_forces"] if mean["averaged_over"] == 1.0]
    print(f"| {cell:g} m | {force / WIDTH / 1e3:.0f} kN | {wall['run_up'] - foot:.1f} m | "
          f"{wall['overtopped_volume'] / WIDTH:.1f} m3 |", flush=True)
