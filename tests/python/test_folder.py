"""Folders of runs read back."""
import os
import shutil
import sys
import types
import unittest
from unittest import mock

import numpy

import frana
from common import COLUMNS, ROWS, InFolder


class Folders(InFolder):
    def setUp(self):
        super().setUp()
        self.frames = []
        with self.case.run(self.path("out")) as run:
            for frame in run:
                self.frames.append((frame.time, frame.grid["depth"], frame.particles["position"]))
        self.result = run.result
        self.old = frana.open(self.path("out"))

    def test_frames_are_those_that_were_seen_to_float32(self):
        self.assertEqual(len(self.old.frames), len(self.frames))
        for stored, (time, depth, position) in zip(self.old.frames, self.frames):
            self.assertEqual(stored.time, time)
            numpy.testing.assert_array_equal(stored.grid["depth"], depth.astype(numpy.float32))
            numpy.testing.assert_allclose(stored.particles["position"], position, rtol=2**-23)
            self.assertEqual(stored.grid.unit("depth"), "m")
            self.assertEqual(stored.grid["velocity"].shape, (ROWS, COLUMNS, 3))
        self.assertEqual(self.old.frames.at(1.4).time, 1.5)
        self.assertEqual(self.old.frames[-1].number, 4)
        with self.assertRaises(IndexError):
            self.old.frames[5]

    def test_frames_have_places_and_a_system_as_those_of_a_run(self):
        with self.case.run() as run:
            live = next(run)
            stored = self.old.frames[0]
            for name in ("x", "y"):
                numpy.testing.assert_array_equal(getattr(stored.grid, name), getattr(live.grid, name))
            self.assertEqual((stored.grid.cell, stored.grid.crs), (live.grid.cell, live.grid.crs))
            self.assertEqual(stored.particles.crs, run.crs)
        shutil.rmtree(self.path("out", "rasters"))  # as while the run goes on
        self.assertEqual(self.old.frames[0].grid.crs, stored.grid.crs)
        with mock.patch.dict(sys.modules, {"xarray": types.SimpleNamespace(Dataset=lambda columns, coords, attrs: (
                columns, coords, attrs))}):  # a stand-in where the package is not installed
            columns, coords, attributes = stored.grid.to_xarray()
        numpy.testing.assert_array_equal(coords["x"][1], stored.grid.x)
        self.assertEqual(attributes["crs_wkt"], stored.grid.crs)
        arrival = columns["arrival_time"][1]
        never = stored.grid["arrival_time"] == -1.0
        self.assertTrue(never.any() and not never.all())
        numpy.testing.assert_array_equal(numpy.isnan(arrival), never)

    def test_history_is_a_structured_array(self):
        history = self.old.history
        self.assertEqual((history["t"][0], history["t"][-1]), (0.0, 2.0))
        self.assertEqual(len(history), 1 + self.result.record["steps"])  # a line a step
        self.assertAlmostEqual(history["mass"][0], 600.0 * 1800.0, places=3)

    def test_a_row_that_is_being_written_is_left_out_and_words_are_refused(self):
        whole = self.old.history
        with open(self.path("out", "history.csv"), "a", encoding="utf-8") as file:
            file.write("2.5,1")
        numpy.testing.assert_array_equal(self.old.history, whole)
        for text in ("", "t [s],name\n0,bridge\n", "t [s],depth [m]\n0\n"):
            with open(self.path("out", "words.csv"), "w", encoding="utf-8") as file:
                file.write(text)
            with self.subTest(text), self.assertRaisesRegex(frana.DataError, "words.csv: .*expected"):
                self.old.table("words.csv")

    def test_record_and_rasters_are_those_of_the_result(self):
        self.assertTrue(self.old.finished)
        self.assertEqual(self.old.record, self.result.record)
        self.assertEqual(set(self.old.rasters), set(self.result.rasters))
        self.assertIn("# ", self.old.report)

    def test_compare_holds_it_against_a_survey(self):
        scores = self.old.compare(self.path("out", "footprint.geojson"))
        self.assertAlmostEqual(scores["iou"], 1.0, places=9)  # its own outline, to round-off
        with self.assertRaises(frana.Error):
            self.old.compare(self.path("nothing.geojson"))

    def test_a_folder_that_is_none_is_refused(self):
        for path in (self.path("nowhere"), self.folder):
            with self.assertRaises(frana.DataError):
                frana.open(path)
        os.remove(self.path("out", "history.csv"))
        with self.assertRaisesRegex(frana.DataError, "history.csv"):
            self.old.history


if __name__ == "__main__":
    unittest.main()
