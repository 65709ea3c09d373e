"""Cases: keys, values, problems."""
import gc
import os
import pickle
import types
import unittest

import numpy

import frana
from common import CELL, NORTH, UTM, WEST, InFolder, slope


class Keys(InFolder):
    def test_values_are_those_of_the_file_or_defaults(self):
        self.assertEqual(self.case["material.bed.mu"], 0.15)
        self.assertEqual(self.case["release.0.depth"], 1.5)
        self.assertIs(type(self.case["particles.per_cell"]), int)
        self.assertEqual(self.case["output.formats"], ["vtk", "geotiff"])
        self.assertFalse(self.case["time.stop_at_rest"])
        self.assertIn("material.bed.mu", self.case)
        self.assertNotIn("time.stop_at_rest", self.case)

    def test_a_key_that_is_set_overrides_the_file(self):
        self.case["material.bed.mu"] = numpy.float64(0.2)
        self.assertEqual(self.case["material.bed.mu"], 0.2)
        self.case.update({"release.0.depth": 2, "time.stop_at_rest": True})
        self.assertEqual((self.case["release.0.depth"], self.case["time.stop_at_rest"]), (2.0, True))
        self.assertIn("mu = 0.2", self.case.resolved)

    def test_an_unknown_key_names_the_nearest(self):
        for use in (lambda: self.case["material.bed.nu"], lambda: self.case.__setitem__("material.bed.nu", 1)):
            with self.assertRaisesRegex(KeyError, "did you mean material.bed.mu"):
                use()
        with self.assertRaisesRegex(KeyError, "release.0.depth"):
            self.case["release.depth"]

    def test_a_value_that_is_refused_leaves_the_old_one(self):
        for wrong in (-1.0, float("nan"), "steep", [0.1, 0.2]):
            with self.subTest(wrong), self.assertRaises(frana.CaseError) as caught:
                self.case["material.bed.mu"] = wrong
            self.assertEqual(caught.exception.problems[0].key, "material.bed.mu")
        self.assertEqual(self.case["material.bed.mu"], 0.15)
        with self.assertRaisesRegex(TypeError, "material.bed.mu: found complex"):
            self.case["material.bed.mu"] = 1j

    def test_problems_are_data(self):
        with open(self.case_file, encoding="utf-8") as file:
            text = file.read().replace("mu = 0.15", "mu = -1.0").replace("end = 2.0", "ende = 2.0")
        with open(self.case_file, "w", encoding="utf-8") as file:
            file.write(text)
        with self.assertRaises(frana.CaseError) as caught:
            frana.Case(self.case_file)
        found = {problem.key: problem for problem in caught.exception.problems}
        line = 1 + text.splitlines().index("mu = -1.0")
        self.assertEqual(found["material.bed.mu"].line, line)
        self.assertIn("expected", found["material.bed.mu"].sentence)
        self.assertIn("time.ende", found)
        again = pickle.loads(pickle.dumps(caught.exception))
        self.assertEqual(again.problems[0].line, caught.exception.problems[0].line)

    def test_check_tells_all_problems_or_what_the_case_holds(self):
        good = self.case.check()
        self.assertTrue(good)
        self.assertEqual(good.particles, 64)
        self.assertAlmostEqual(good.volume, 20 * 20 * 1.5, places=6)  # of the outline, to round-off
        self.assertIn("ready to run", str(good))
        os.remove(self.path("release.geojson"))
        bad = self.case.check()
        self.assertFalse(bad)
        self.assertEqual([problem.key for problem in bad.problems], ["release.0.outline"])
        self.assertIn("release.geojson", str(bad))

    def test_a_check_tells_what_a_run_would_of_the_page(self):
        self.case["output.formats"] = ["web"]
        try:
            self.case.run().close()
        except frana.CaseError as error:  # built without libjs-three
            self.assertEqual(self.case.check().problems, error.problems)
        else:
            self.assertTrue(self.case.check())

    def test_a_dictionary_is_a_case(self):
        case = frana.Case({"terrain": {"dem": self.path("dem.tif")},
                           "release": [{"outline": self.path("release.geojson"), "depth": 1.5}],
                           "particles": {"per_cell": 4},
                           "material": {"density": 1800, "bed": {"law": "voellmy", "mu": 0.15, "xi": 500}},
                           "profile": [{"name": "axis", "line": numpy.array([[WEST + 10, NORTH - 75], [WEST + 200, NORTH - 75]])}],
                           "time": {"end": 2}})
        self.assertEqual(case.check().particles, 64)
        self.assertEqual(case["profile.0.line"], [(WEST + 10, NORTH - 75), (WEST + 200, NORTH - 75)])

    def test_describe_tells_of_a_key(self):
        self.assertIn("friction", frana.describe("material.bed.mu"))
        with self.assertRaisesRegex(frana.Error, "did you mean"):
            frana.describe("material.bed.nu")
        self.assertIn("release.depth", frana.keys())


class Arrays(InFolder):
    def test_arrays_of_any_layout_and_type_are_copied_and_never_misread(self):
        where = (CELL, 0, WEST, 0, -CELL, NORTH)
        plain = slope()
        for array in (numpy.asfortranarray(plain), numpy.repeat(plain, 2, axis=1)[:, ::2], plain.astype(">f8")):
            raster = frana.Raster(array, where, crs=UTM)
            self.assertTrue(raster.array.flags.c_contiguous)
            numpy.testing.assert_array_equal(raster.array, plain)
        for wrong in (plain.astype(complex), plain[0], plain[None], numpy.array([["a"]]), numpy.zeros((0, 3))):
            with self.assertRaises(frana.DataError):
                frana.Raster(wrong, where)
        for bent in ((CELL, 1, WEST, 0, -CELL, NORTH), (CELL, 0, WEST, 0, CELL, NORTH), (CELL, 0, WEST, 0, -2 * CELL, NORTH)):
            with self.assertRaisesRegex(frana.DataError, "transform"):
                frana.Raster(plain, bent)

    def test_nan_is_no_data_and_infinity_is_refused(self):
        hole = slope()
        hole[0, 0] = numpy.nan
        where = (CELL, 0, WEST, 0, -CELL, NORTH)
        frana.Raster(hole, where, crs=UTM, unit="m").save(self.path("dem.tif"))
        with self.case.run() as run:
            elevation = next(run).grid["elevation"]
        self.assertTrue(numpy.isnan(elevation[-1, 0]))  # north-west: rows run to the north inside
        self.assertEqual(numpy.isnan(elevation).sum(), 1)
        hole[0, 0] = numpy.inf
        with self.assertRaisesRegex(frana.DataError, "infinite"):
            frana.Raster(hole, where, crs=UTM).save(self.path("dem.tif"))

    def test_what_a_masked_array_masks_is_no_data_and_a_crs_may_be_an_object(self):
        where = (CELL, 0, WEST, 0, -CELL, NORTH)
        numbers = numpy.full(slope().shape, 99, dtype="u1")
        numbers[13:17, 8:12] = 2
        crs = types.SimpleNamespace(to_wkt=lambda: UTM)
        raster = frana.Raster(numpy.ma.masked_equal(numbers, 99), where, crs=crs)
        self.assertEqual(raster.crs, UTM)
        numpy.testing.assert_array_equal(numpy.isnan(raster.array), numbers == 99)
        self.assertFalse(numpy.isnan(frana.Raster(numpy.ma.array(numbers), where).array).any())
        self.assertEqual(frana.Raster(numbers, where, crs=None).crs, "")
        case = frana.Case.from_rasters(dem=frana.Raster(slope(), where, crs=UTM), release=raster, density=1800, end=1.0,
                                       law="coulomb", friction_angle_deg=15.0)
        self.assertAlmostEqual(case.check().volume, 16 * CELL * CELL * 2.0, places=6)

    def test_a_case_from_rasters(self):
        depth = numpy.zeros(slope().shape)
        depth[13:17, 8:12] = 1.5
        where = (CELL, 0, WEST, 0, -CELL, NORTH)
        case = frana.Case.from_rasters(dem=frana.Raster(slope(), where, crs=UTM), release=frana.Raster(depth, where, crs=UTM),
                                       density=1800, end=1.0, law="coulomb", friction_angle_deg=15.0)
        self.assertAlmostEqual(case.check().volume, 16 * CELL * CELL * 1.5, places=6)
        run = case.run()
        folder = os.path.dirname(case["terrain.dem"])
        del case
        gc.collect()
        self.assertTrue(os.path.exists(folder))  # as long as the run may read it
        run.close()
        del run
        gc.collect()
        self.assertFalse(os.path.exists(folder))

    def test_a_depth_may_be_a_number_of_any_kind(self):
        for depth in (2, 2.0, numpy.float32(2), numpy.int64(2)):
            case = frana.Case.from_rasters(dem=self.path("dem.tif"), release=self.path("release.geojson"), depth=depth,
                                           density=1800, law="coulomb", friction_angle_deg=15.0)
            self.assertEqual(case["release.0.depth"], 2.0)


class Numerics(unittest.TestCase):
    def test_the_solvers_sentence_is_read(self):
        error = frana.errors.of_numerics("step 7, t = 1.25 s, dt = 0.001 s: the point at (12.5, -3) has depth 0.3 m and would "
                                         "move more than four cells in one step or is not finite; reduce scheme.cfl (now 1)")
        self.assertEqual((error.step, error.time, error.point, error.value), (7, 1.25, (12.5, -3.0), 0.3))


if __name__ == "__main__":
    unittest.main()
