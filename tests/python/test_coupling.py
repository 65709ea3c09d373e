"""Coupling from outside: mass that is added, the bed as it is, and the end of Python while a thread steps a run."""
import os
import subprocess
import sys
import unittest

import numpy

import frana
from common import CELL, COLUMNS, NORTH, ROWS, WEST, InFolder, slope

X, Y = WEST + 150.0, NORTH - 75.0


class Mass(InFolder):
    def setUp(self):
        super().setUp()
        self.case["time.stop_at_rest"] = False
        self.case["scheme.cfl"] = 0.25  # what is added enters with a step: these are shorter than outputs are apart

    def test_mass_comes_in_and_is_booked(self):
        with self.case.run(self.path("out"), threads=1) as run:
            first = next(run)
            before = first.status.mass
            run.add_mass(X, Y, 9000.0, velocity=(2.0, 0.0))
            self.assertEqual(first.grid["depth"].max(), 1.5)  # the frame is of before
            frame = next(run)
            self.assertAlmostEqual(frame.status.mass, before + 9000.0, delta=1e-9 * before)
            self.assertAlmostEqual(frame.status.mass_in, 9000.0, delta=1e-9 * 9000)
            near = numpy.hypot(frame.particles["position"][:, 0] - X, frame.particles["position"][:, 1] - Y) < 20.0
            self.assertTrue(near.any())
            self.assertGreater(frame.particles["velocity"][near][:, 0].min(), 0.0)
            run.add_mass([X, X + 10.0], Y, [100.0, 200.0], velocity=[[1.0, 0.0], [0.0, 1.0]], size=12.0)
            run.finish()
        record = run.result.record
        self.assertAlmostEqual(record["budgets"]["mass"]["came_in"], 9300.0, delta=1e-9 * 9300)
        self.assertLess(abs(record["budgets"]["mass"]["relative_error"]), 1e-12)
        self.assertGreater(run.result.peak_depth.at(X, Y), 0.05)  # 5 m3 over some 100 m2

    def test_at_an_output_and_between_two_it_enters_once(self):
        for until in (0.0, 0.5, 0.6):
            with self.case.run(threads=1) as run:
                next(run)
                if until > 0.0:
                    run.advance(until=until)
                run.add_mass(X, Y, 500.0)
                run.advance(until=1.2)
                self.assertAlmostEqual(run.status.mass_in, 500.0, delta=1e-9 * 500)
                run.finish()
                self.assertAlmostEqual(run.status.mass_in, 500.0, delta=1e-9 * 500)

    def test_a_large_square_is_several_particles_over_its_area(self):
        with self.case.run(threads=1) as run:
            count = next(run).status.particles
            run.add_mass(X, Y, 1800.0 * 20 * 20 * 0.5, size=20.0)
            frame = run.advance(until=0.01)
            self.assertEqual(frame.status.particles, count + 64)  # half a cell each
            depth = frame.grid["depth"]
            i, j = int((X - WEST) / CELL), ROWS - 1 - int((NORTH - Y) / CELL)
            self.assertAlmostEqual(depth[j, i], 0.5, delta=0.05)  # shape functions spread the rim only

    def test_what_cannot_enter_is_refused_in_a_sentence(self):
        with self.case.run(threads=1) as run:
            next(run)
            with self.assertRaisesRegex(frana.DataError, r"add_mass: found the place \(.*expected one on the terrain"):
                run.add_mass(WEST - 100.0, Y, 1.0)
            for words, given in (("mass: found 0", (X, Y, 0.0)), ("x: found a number", (float("nan"), Y, 1.0))):
                with self.assertRaisesRegex(ValueError, words):
                    run.add_mass(*given)
            with self.assertRaisesRegex(ValueError, "velocity: found the shape"):
                run.add_mass(X, Y, 1.0, velocity=(1.0, 2.0, 3.0))
            run.finish()
            self.assertEqual(run.status.mass_in, 0.0)
            with self.assertRaisesRegex(RuntimeError, "at its end"):
                run.add_mass(X, Y, 1.0)

    def test_a_run_without_mass_is_as_it_was(self):
        plain = self.case.run(threads=1).finish().final_depth.array
        with self.case.run(threads=1) as run:
            for _ in run:
                run.bed
        numpy.testing.assert_array_equal(run.result.final_depth.array, plain)


class Bed(InFolder):
    def test_the_bed_is_that_of_now_with_erosion(self):
        self.case.update({"erodible.law": "steady", "erodible.growth_per_second": 0.2, "erodible.depth": 1.0})
        with self.case.run(threads=1) as run:
            start = run.bed
            self.assertEqual(start.array.shape, (ROWS, COLUMNS))
            self.assertEqual(start.transform.to_gdal(), (WEST, CELL, 0.0, NORTH, 0.0, -CELL))
            self.assertIn('"WGS 84 / UTM zone 32N"', run.crs)
            with self.assertRaises(ValueError):
                start.array[0, 0] = 1.0
            frame = next(run)
            numpy.testing.assert_array_equal(run.bed.array, frame.grid["elevation"][::-1])
            read = run.ground
            numpy.testing.assert_array_equal(read.array, slope().astype(numpy.float32))
            with self.assertRaises(ValueError):
                read.array[0, 0] = 1.0
            frame = run.advance(until=0.6)
            numpy.testing.assert_array_equal(run.ground.array, read.array + frame.grid["bed_change"][::-1])
            self.assertLess(frame.grid["bed_change"].min(), 0.0)
            now = run.bed.array
            numpy.testing.assert_array_equal(now, frame.grid["elevation"][::-1])
            lost = (start.array - now).sum() * CELL * CELL * 1800.0
            self.assertGreater(lost, 0.0)
            # What the flow gained is what the ground lost, counted from elevations near 200 m.
            self.assertAlmostEqual(frame.status.mass - 600.0 * 1800.0, lost, delta=1e-9 * 600.0 * 1800.0)
            run.finish()
            with self.assertRaisesRegex(RuntimeError, "the run is over"):
                run.bed


class AtTheEnd(InFolder):
    def run_script(self, text):
        return subprocess.run([sys.executable, "-c", text, self.case_file], capture_output=True, text=True, timeout=120)

    def test_a_daemon_thread_in_a_run_does_not_abort_python(self):
        script = """
import frana, sys, threading, time
case = frana.Case(sys.argv[1], set={"time.end": 1000.0, "output.every": 0.01, "time.stop_at_rest": False})
def work():
    with case.run(threads=1, progress=lambda now: None) as run:
        for frame in run:
            frame.grid["depth"].max()
threading.Thread(target=work, daemon=True).start()
time.sleep(0.5)
"""
        for _ in range(3):
            done = self.run_script(script)
            self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_a_run_that_stands_at_the_end_does_not_keep_python(self):
        done = self.run_script("import frana, sys; run = frana.Case(sys.argv[1]).run(); frame = next(run); "
                               "depth = frame.grid['depth']; print(depth.max())")
        self.assertEqual((done.returncode, done.stderr), (0, ""))


if __name__ == "__main__":
    unittest.main()
