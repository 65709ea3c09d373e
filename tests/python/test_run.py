"""Runs: frames as views, the same bytes as the program, threads, Ctrl-C."""
import _thread
import ctypes
import filecmp
import gc
import os
import re
import resource
import signal
import subprocess
import sys
import threading
import time
import unittest

import numpy

import frana
from common import CELL, COLUMNS, NORTH, PROGRAM, ROWS, WEST, InFolder


def gdal():
    """The GDAL library that the module uses."""
    with open("/proc/self/maps", encoding="utf-8") as maps:
        return ctypes.CDLL(re.search(r"\S+/libgdal\.so\S*", maps.read())[0])


def read_by_gdal(path):
    """(geotransform, WKT, array) of a raster, by GDAL's own functions."""
    lib = gdal()
    lib.GDALAllRegister()
    lib.GDALOpen.restype = lib.GDALGetRasterBand.restype = ctypes.c_void_p
    lib.GDALGetProjectionRef.restype = ctypes.c_char_p
    dataset = ctypes.c_void_p(lib.GDALOpen(path.encode(), 0))
    transform = (ctypes.c_double * 6)()
    lib.GDALGetGeoTransform(dataset, transform)
    columns, rows = lib.GDALGetRasterXSize(dataset), lib.GDALGetRasterYSize(dataset)
    array = numpy.empty((rows, columns))
    lib.GDALRasterIO(ctypes.c_void_p(lib.GDALGetRasterBand(dataset, 1)), 0, 0, 0, columns, rows,
                     array.ctypes.data_as(ctypes.c_void_p), columns, rows, 7, 0, 0)  # 7: GDT_Float64
    wkt = lib.GDALGetProjectionRef(dataset).decode()
    lib.GDALClose(dataset)
    return tuple(transform), wkt, array


class Frames(InFolder):
    def test_frames_come_at_output_times_with_shapes_and_units(self):
        with self.case.run() as run:
            times = []
            for frame in run:
                times.append(frame.time)
                self.assertEqual(frame.grid["depth"].shape, (ROWS, COLUMNS))
                self.assertEqual(frame.grid["velocity"].shape, (ROWS, COLUMNS, 3))
                self.assertEqual(frame.particles["position"].shape, (frame.status.particles, 3))
                self.assertEqual(frame.particles["depth"].dtype, numpy.float64)
                self.assertEqual((frame.grid.unit("depth"), frame.particles.unit("velocity")), ("m", "m/s"))
                volume = frame.grid["depth"].sum() * CELL * CELL
                self.assertAlmostEqual(volume, 600.0, delta=1e-9 * 600)  # 20 x 20 x 1.5 m3: mass is kept to round-off
                with self.assertRaisesRegex(KeyError, "there are elevation, "):
                    frame.grid["height"]
        self.assertEqual(times, [0.0, 0.5, 1.0, 1.5, 2.0])
        self.assertEqual(frame.number, 4)
        self.assertEqual(run.result.reason, "end")

    def test_rows_run_to_the_north_inside_and_to_the_south_outside(self):
        with self.case.run() as run:
            frame = next(run)
            y, elevation = frame.grid.y, frame.grid["elevation"]
            self.assertEqual(y[0], NORTH - ROWS * CELL + CELL / 2)
            self.assertEqual(frame.grid.x[0], WEST + CELL / 2)
            self.assertGreater(elevation[-1, 0], elevation[0, 0])
            position = frame.particles["position"]
            self.assertTrue(((position[:, 1] > NORTH - 85) & (position[:, 1] < NORTH - 65)).all())
            wet = numpy.argwhere(frame.grid["depth"] > 0.1)
            self.assertTrue((abs(y[wet[:, 0]] - (NORTH - 75)) < 10 + 2 * CELL).all())  # the release, and shape functions
            run.finish()
        peak = run.result.peak_depth
        row = numpy.argwhere(peak.array > 0.1)[:, 0]
        self.assertTrue((abs(NORTH - (row + 0.5) * CELL - (NORTH - 75)) < 50).all())

    def test_views_cost_nothing_are_read_only_and_stay_as_they_are(self):
        with self.case.run() as run:
            frame = next(run)
            depth = frame.grid["depth"]
            self.assertEqual(depth.ctypes.data, frame.grid["depth"].ctypes.data)  # no copy
            self.assertFalse(depth.flags.owndata)
            with self.assertRaises(ValueError):
                depth[0, 0] = 1.0
            with self.assertRaises(ValueError):
                depth.flags.writeable = True
            was, part, place = depth.copy(), depth[10:20:2], frame.particles["position"]
            where = place.copy()
            after = next(run)
            self.assertFalse((after.grid["depth"] == was).all())
            with self.assertRaisesRegex(ValueError, "the frame is over"):
                frame.grid["depth"]
            numpy.testing.assert_array_equal(depth, was)
            for _ in run:
                pass
            numpy.testing.assert_array_equal(depth, was)
        del run, frame, after
        gc.collect()
        numpy.testing.assert_array_equal(part, was[10:20:2])
        numpy.testing.assert_array_equal(place, where)

    def test_frames_of_a_closed_or_forgotten_run_raise(self):
        run = self.case.run()
        frame, depth = next(run), None
        depth = frame.grid["depth"]
        run.close()
        with self.assertRaisesRegex(ValueError, "over"):
            frame.particles["depth"]
        self.assertEqual(frame.time, 0.0)
        run = self.case.run()
        frame = next(run)
        del run
        gc.collect()
        with self.assertRaisesRegex(ValueError, "over"):
            list(frame.grid)
        self.assertGreater(depth.max(), 1.0)

    def test_advance_looks_between_outputs_and_changes_no_step(self):
        plain = self.case.run().finish()
        with self.case.run() as run:
            frame = run.advance(until=0.6)
            self.assertGreaterEqual(frame.time, 0.6)
            self.assertLess(frame.time - 0.6, frame.status.dt + 1e-12)
            with self.assertRaisesRegex(ValueError, "after the present one"):
                run.advance(until=0.1)
            self.assertEqual(next(run).time, 1.0)
            self.assertIsNone(run.advance(until=99.0) and run.advance(until=99.0))
        self.assertEqual(run.result.record["steps"], plain.record["steps"])
        numpy.testing.assert_array_equal(run.result.final_depth.array, plain.final_depth.array)

    def test_leaving_early_ends_the_run_where_it_is(self):
        with self.case.run(self.path("out")) as run:
            next(run)
            with self.assertRaisesRegex(RuntimeError, "finish"):
                run.result
        self.assertEqual(run.result.reason, "interrupted")
        self.assertEqual(frana.open(self.path("out")).record["exit_reason"], "interrupted")
        self.assertIsNone(run.advance(until=1.0))
        self.assertEqual(list(run), [])

    def test_relative_paths_are_of_the_folder_at_the_start(self):
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(self.folder)
        case = frana.Case("case.toml")
        os.mkdir("elsewhere")
        with case.run("out") as run:
            next(run)
            os.chdir("elsewhere")
            run.finish()
        self.assertEqual(os.listdir("."), [])
        self.assertEqual(run.result.folder, os.path.abspath("../out"))
        self.assertTrue(frana.open("../out").finished)
        self.assertTrue(case.check())


class Outside(InFolder):
    def test_transform_crs_and_numbers_are_those_that_gdal_reads(self):
        result = self.case.run(self.path("out")).finish()
        for name in ("peak_depth", "arrival_time", "final_depth"):
            raster, stored = result.rasters[name], frana.open(self.path("out")).rasters[name]
            transform, wkt, array = read_by_gdal(self.path("out", "rasters", name + ".tif"))
            self.assertEqual(raster.transform.to_gdal(), transform)
            self.assertEqual(raster.profile["width"], array.shape[1])
            self.assertIn('"WGS 84 / UTM zone 32N"', raster.crs)
            self.assertIn('"WGS 84 / UTM zone 32N"', wkt)
            array[array == -9999] = numpy.nan
            self.assertTrue(numpy.isnan(array).any() and (array >= 0.0).any())  # nodata where the flow never came
            numpy.testing.assert_array_equal(raster.array.astype(numpy.float32), array)  # files hold float32
            numpy.testing.assert_array_equal(stored.array, array)
            self.assertEqual(stored.unit, raster.unit)
        self.assertEqual(result.peak_depth.bounds, (WEST, NORTH - ROWS * CELL, WEST + COLUMNS * CELL, NORTH))
        x, y = result.peak_depth.transform * (8.5, 14.5)
        self.assertEqual(result.peak_depth.at(x, y), result.peak_depth.array[14, 8])
        self.assertTrue(numpy.isnan(result.peak_depth.at(WEST - 1, NORTH)))

    def test_the_folder_has_the_bytes_of_the_programs_run(self):
        subprocess.run([PROGRAM, "run", self.case_file, "--out", self.path("out"), "--quiet"], check=True, timeout=60)
        os.rename(self.path("out"), self.path("program"))  # ParaView's states know their folder
        with self.case.run(self.path("out"), threads=1) as run:
            for frame in run:
                frame.grid["depth"].sum()
        os.rename(self.path("out"), self.path("module"))
        files = sorted(os.path.relpath(os.path.join(at, name), self.path("program"))
                       for at, _, names in os.walk(self.path("program")) for name in names)
        there = sorted(os.path.relpath(os.path.join(at, name), self.path("module"))
                       for at, _, names in os.walk(self.path("module")) for name in names)
        self.assertEqual(there, files)
        self.assertIn("grid.pvd", files)
        told = {"run.json", "report.md", "checkpoint.h5"}  # wall clock
        _, differ, lost = filecmp.cmpfiles(self.path("program"), self.path("module"), set(files) - told, shallow=False)
        self.assertEqual((differ, lost), ([], []))

    def test_two_runs_do_not_share_a_folder(self):
        with self.case.run(self.path("out")) as run:
            next(run)
            with self.assertRaisesRegex(frana.DataError, "still going on"):
                self.case.run(self.path("out"))
        with self.assertRaisesRegex(frana.DataError, "overwrite"):
            self.case.run(self.path("out"))
        self.assertEqual(self.case.run(self.path("out"), overwrite=True).finish().reason, "end")


class Together(InFolder):
    def test_two_runs_at_once_are_as_one_after_the_other(self):
        alone = self.case.run(threads=1).finish()
        results = [None, None]

        def work(k):
            with frana.Case(self.case_file).run(threads=1 + k) as run:
                for frame in run:
                    frame.grid["depth"].sum()
            results[k] = run.result

        threads = [threading.Thread(target=work, args=(k,)) for k in range(2)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for result in results:
            numpy.testing.assert_array_equal(result.peak_depth.array, alone.peak_depth.array)

    def test_the_interpreter_is_free_while_the_run_steps(self):
        """Whoever waits for a thread's turn with the lock taken would count nothing before the run ends.

        On a busy machine the other thread may get no turn in a short step, so one of many outputs is enough.
        """
        self.case["time.end"] = 20.0
        self.case["output.every"] = 0.5
        self.case["time.stop_at_rest"] = False
        counted, over = [0], threading.Event()

        def count():
            while not over.is_set():
                counted[0] += 1
                time.sleep(0)

        run = self.case.run(threads=1)
        next(run)
        counter = threading.Thread(target=count)
        counter.start()
        most = 0
        for _ in range(39):
            before = counted[0]
            next(run)
            most = max(most, counted[0] - before)
        self.assertGreater(most, 10)
        over.set()
        counter.join()

    def test_a_fork_leaves_the_parents_run_alone_and_runs_its_own(self):
        run = self.case.run(threads=2)
        frame = next(run)
        child = os.fork()
        if child == 0:
            code = 1
            try:
                signal.alarm(60)
                try:
                    next(run)
                except RuntimeError as error:
                    code = 2 if "fork" not in str(error) else 0
                try:
                    frame.grid["depth"]
                    code = 3
                except ValueError:
                    pass
                if frana.Case(self.case_file).run(threads=2).finish().reason != "end":
                    code = 4
                del run, frame
            finally:
                os._exit(code)
        self.assertEqual(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), 0)
        self.assertGreater(frame.grid["depth"].max(), 1.0)
        self.assertEqual(run.finish().reason, "end")

    def test_a_hundred_runs_leave_nothing_behind(self):
        def some(count):
            for _ in range(count):
                with self.case.run(threads=1) as run:
                    kept = next(run).grid["depth"]
                    next(run)
                    self.assertGreater(kept.max(), 0.0)

        def pages():
            with open("/proc/self/statm", encoding="utf-8") as file:
                return int(file.read().split()[1])

        self.case["time.end"] = 0.02
        self.case["output.every"] = 0.01
        some(20)
        before = pages()
        some(100)
        grown = (pages() - before) * resource.getpagesize()
        # A leaked frame alone would be 100 * 20 fields * 1800 nodes * 8 bytes = 29 MB; allocators keep a few.
        self.assertLess(grown, 8e6)


class Stopping(InFolder):
    def test_ctrl_c_is_answered_within_a_step_and_the_run_can_go_on(self):
        self.case["time.end"] = 1e7  # with walls nothing leaves: no machine is so fast
        self.case["output.every"] = 1e7
        self.case["boundary.sides"] = "wall"
        with self.case.run(threads=1) as run:
            next(run)
            timer = threading.Timer(0.1, _thread.interrupt_main)
            self.addCleanup(timer.cancel)
            timer.start()
            with self.assertRaises(KeyboardInterrupt):
                next(run)
            reached = run.time
            self.assertFalse(run.over)
            self.assertGreater(run.advance(until=reached + 0.01).time, reached)
        self.assertEqual(run.result.reason, "interrupted")

    def test_what_a_progress_callback_raises_comes_through(self):
        class Enough(Exception):
            pass

        said = []

        def progress(now):
            said.append(str(now))
            if now.time >= 1.0:
                raise Enough("one second will do")

        with self.assertRaisesRegex(Enough, "will do"), self.case.run(self.path("out"), progress=progress) as run:
            for _ in run:
                pass
        self.assertRegex(said[0], r"0\.000 of 2 s   step 0   64 particles")
        self.assertEqual(run.result.reason, "interrupted")
        self.assertTrue(os.path.exists(self.path("out", "run.json")))

    def test_a_call_that_is_refused_does_not_move_the_run(self):
        refused, times = [], []

        def progress(_):
            for call in (run._run.next, lambda: run._run.advance(99.0)):
                with self.assertRaisesRegex(RuntimeError, "one at a time"):
                    call()
                refused.append(call)

        with self.case.run(progress=progress) as run:
            for frame in run:
                times.append(frame.time)
        self.assertGreaterEqual(len(refused), 2 * 5)
        self.assertEqual(times, [0.0, 0.5, 1.0, 1.5, 2.0])

    def test_what_goes_wrong_while_it_ends_is_told(self):
        def begin(out):
            run = self.case.run(out)
            next(run)
            with open(os.path.join(out, "rasters"), "w", encoding="utf-8"):
                pass  # no folder can be made there
            return run

        with self.assertRaisesRegex(frana.DataError, "rasters"), begin(self.path("one")):
            pass
        with self.assertRaisesRegex(KeyError, "on its way"), begin(self.path("two")):
            raise KeyError("on its way")
        run = begin(self.path("three"))
        with self.assertRaisesRegex(frana.DataError, "rasters"):
            run.close()
        run.close()  # told once

    def test_problems_come_before_anything_is_written(self):
        os.remove(self.path("release.geojson"))
        with self.assertRaisesRegex(frana.CaseError, "release.geojson") as caught:
            self.case.run(self.path("out"))
        self.assertEqual(caught.exception.problems[0].key, "release.0.outline")
        self.assertFalse(os.path.exists(self.path("out")))


class Import(unittest.TestCase):
    def test_the_module_is_there_soon(self):
        """Processor time, which does not hang on what else the machine does; numpy and VTK come when they are needed."""
        def seconds(code):
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            subprocess.run([sys.executable, "-c", code], check=True)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

        cost = min(seconds("import frana") for _ in range(3)) - min(seconds("pass") for _ in range(3))
        self.assertLess(cost, 0.15)
        code = "import frana, sys; assert 'numpy' not in sys.modules; assert 'vtk' not in open('/proc/self/maps').read().lower()"
        subprocess.run([sys.executable, "-c", code], check=True)


if __name__ == "__main__":
    unittest.main()
