#!/usr/bin/env python3
"""A flow on ground that is made of arrays: a slope of 25 degrees that ends on a plain.

    own_ground.py
"""
import numpy

import frana

cell = 2.0
x = cell * (numpy.arange(150) + 0.5)
y = cell * (numpy.arange(40) + 0.5)
elevation = numpy.tile(numpy.maximum(0.0, (180.0 - x) * numpy.tan(numpy.radians(25.0))), (len(y), 1))
depth = numpy.zeros_like(elevation)
depth[15:25, 20:30] = 2.0
where = (cell, 0.0, 0.0, 0.0, -cell, cell * len(y))  # as rasterio has it: the first row is the northern one
case = frana.Case.from_rasters(dem=frana.Raster(elevation, where, unit="m"), release=frana.Raster(depth, where, unit="m"),
                               density=1800.0, end=20.0, every=5.0, law="voellmy", mu=0.2, xi=400.0)
with case.run() as run:
    for frame in run:
        place = frame.particles["position"]
        print(f"{frame.time:4.1f} s: {len(place)} particles, x from {place[:, 0].min():.0f} to {place[:, 0].max():.0f} m")
final = run.result.final_depth
row, column = numpy.unravel_index(numpy.nanargmax(final.array), final.array.shape)
deepest = final.transform * (column + 0.5, row + 0.5)
print(f"deepest at the foot of the slope, x = 180 m? {final.array[row, column]:.2f} m at x = {deepest[0]:.0f} m")
