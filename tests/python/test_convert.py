"""Arrays as objects of other packages, where they are installed, and what is said where they are not."""
import importlib.util
import sys
import types
import unittest
from unittest import mock

import numpy

import frana
from common import CELL, COLUMNS, NORTH, ROWS, WEST, InFolder


def has(package):
    return importlib.util.find_spec(package) is not None


class Without(InFolder):
    def test_the_packages_to_install_are_told(self):
        with self.case.run() as run:
            frame = next(run)
            bed = run.bed
            calls = {"xarray": (bed.to_xarray, frame.grid.to_xarray),
                     "pyvista": (bed.to_pyvista, frame.grid.to_pyvista, frame.particles.to_pyvista),
                     "geopandas": (bed.to_geodataframe, frame.particles.to_geodataframe)}
            for package, methods in calls.items():
                with mock.patch.dict(sys.modules, {package: None}):  # as if it were not installed
                    for method in methods:
                        with self.assertRaisesRegex(ImportError, rf"\(\) needs {package}: (apt|pip) install "):
                            method()


class Stub(InFolder):
    def test_pyvista_gets_points_and_their_numbers_in_its_order(self):
        """Debian has no package of pyvista: a stand-in with its order of points, the first axis of the arrays fastest."""
        class Mesh:
            def __init__(self, *points):
                if len(points) == 3:
                    points = [numpy.stack([axis.ravel(order="F") for axis in points], axis=1)]
                self.points, self.point_data = points[0], {}

        stand_in = types.SimpleNamespace(StructuredGrid=Mesh, PolyData=Mesh)
        with mock.patch.dict(sys.modules, {"pyvista": stand_in}), self.case.run() as run:
            frame = next(run)
            meshes = frame.grid.to_pyvista(), run.bed.to_pyvista(), frame.particles.to_pyvista()
            ground, flat, particles = meshes
            numpy.testing.assert_array_equal(ground.points[:, 2], ground.point_data["elevation"])
            numpy.testing.assert_array_equal(flat.points[:, :2].max(axis=0),
                                             [WEST + (COLUMNS - 0.5) * CELL, NORTH - 0.5 * CELL])
            self.assertEqual(ground.point_data["velocity"].shape, (ROWS * COLUMNS, 3))
            for mesh, name in ((ground, "depth"), (flat, "elevation")):
                k = 7 * ROWS + 5
                x, y = mesh.points[k, :2]
                field = frame.grid["depth" if name == "depth" else "elevation"]
                i, j = int(round((x - frame.grid.x[0]) / CELL)), int(round((y - frame.grid.y[0]) / CELL))
                self.assertEqual(mesh.point_data[name][k], field[j, i])
            numpy.testing.assert_array_equal(particles.points, frame.particles["position"])
            self.assertIn("depth", particles.point_data)


@unittest.skipUnless(has("xarray"), "no xarray (python3-xarray)")
class Xarray(InFolder):
    def test_fields_have_places_and_units(self):
        with self.case.run() as run:
            frame = next(run)
            data = frame.grid.to_xarray()
            self.assertEqual(data["depth"].attrs["units"], "m")
            self.assertEqual(data["velocity"].shape, (ROWS, COLUMNS, 3))
            x, y = WEST + 52.5, NORTH - 77.5
            self.assertEqual(float(data["depth"].sel(x=x, y=y)), 1.5)
            bed = run.bed.to_xarray()
            self.assertEqual(float(bed.sel(x=x, y=y)), float(data["elevation"].sel(x=x, y=y)))
            kept = data["depth"].values.copy()
            run.finish()
            numpy.testing.assert_array_equal(data["depth"].values, kept)


@unittest.skipUnless(has("geopandas"), "no geopandas (python3-geopandas)")
class Geopandas(InFolder):
    def test_particles_and_pixels_are_shapes_with_a_system(self):
        with self.case.run() as run:
            frame = next(run)
            points = frame.particles.to_geodataframe()
            self.assertEqual(len(points), frame.status.particles)
            numpy.testing.assert_array_equal(points.geometry.x, frame.particles["position"][:, 0])
            numpy.testing.assert_array_equal(points["depth"], frame.particles["depth"])
            self.assertEqual(points.crs.to_epsg(), 32632)
            self.assertIn("velocity_x", points)
            run.finish()
        pixels = run.result.peak_depth.to_geodataframe(above=0.5)
        peak = run.result.peak_depth
        self.assertEqual(len(pixels), int((peak.array > 0.5).sum()))
        self.assertAlmostEqual(pixels.geometry.area.sum(), len(pixels) * CELL * CELL)
        middle = pixels.geometry.iloc[0].centroid
        self.assertEqual(peak.at(middle.x, middle.y), pixels["peak_depth"].iloc[0])


if __name__ == "__main__":
    unittest.main()
