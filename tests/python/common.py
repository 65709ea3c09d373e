"""What the tests of the Python module share: a small case on made-up ground, and the program beside the module."""
import json
import os
import shutil
import tempfile
import unittest

import numpy

import frana

PROGRAM = os.environ.get("FRANA_PROGRAM", "frana")
SOURCE = os.environ.get("FRANA_SOURCE", os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))))
UTM = ('PROJCS["WGS 84 / UTM zone 32N",GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],'
       'PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],'
       'PARAMETER["latitude_of_origin",0],PARAMETER["central_meridian",9],PARAMETER["scale_factor",0.9996],'
       'PARAMETER["false_easting",500000],PARAMETER["false_northing",0],UNIT["metre",1],AUTHORITY["EPSG","32632"]]')
ROWS, COLUMNS, CELL = 30, 60, 5.0
WEST, NORTH = 500000.0, 5000000.0


def slope():
    """Elevation that falls to the east by 0.4 [m], north row first; higher in the north, so that no row is another."""
    x = CELL * (numpy.arange(COLUMNS) + 0.5)
    y = CELL * (numpy.arange(ROWS) + 0.5)
    return 200.0 - 0.4 * x[None, :] - 0.01 * y[:, None]


def write_case(folder):
    """dem.tif, release.geojson and case.toml: 16 cells with 4 particles each, 2 s."""
    frana.Raster(slope(), (CELL, 0, WEST, 0, -CELL, NORTH), crs=UTM, unit="m").save(os.path.join(folder, "dem.tif"))
    west, south = WEST + 40.0, NORTH - 85.0
    ring = [[west, south], [west + 20, south], [west + 20, south + 20], [west, south + 20], [west, south]]
    with open(os.path.join(folder, "release.geojson"), "w", encoding="utf-8") as file:
        json.dump({"type": "FeatureCollection", "crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::32632"}},
                   "features": [{"type": "Feature", "properties": {},
                                 "geometry": {"type": "Polygon", "coordinates": [ring]}}]}, file)
    with open(os.path.join(folder, "case.toml"), "w", encoding="utf-8") as file:
        file.write('[terrain]\ndem = "dem.tif"\n[[release]]\noutline = "release.geojson"\ndepth = 1.5\n'
                   '[particles]\nper_cell = 4\n[material]\ndensity = 1800.0\n'
                   '[material.bed]\nlaw = "voellmy"\nmu = 0.15\nxi = 500.0\n[time]\nend = 2.0\n[output]\nevery = 0.5\n'
                   'formats = ["vtk", "geotiff"]\n')
    return os.path.join(folder, "case.toml")


class InFolder(unittest.TestCase):
    """A test with the case in a folder of its own."""

    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="frana_test_")
        self.addCleanup(shutil.rmtree, self.folder)
        self.case_file = write_case(self.folder)
        self.case = frana.Case(self.case_file)

    def path(self, *names):
        return os.path.join(self.folder, *names)
