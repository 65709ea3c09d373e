"""Ensembles: the program's bytes, probabilities against the runs, Ctrl-C, problems."""
import _thread
import filecmp
import os
import re
import subprocess
import threading
import time
import unittest
import warnings

import numpy

import frana
from common import CELL, COLUMNS, NORTH, PROGRAM, ROWS, WEST, InFolder

FILE = """[ensemble]
case = "case.toml"
method = "sobol"
samples = {samples}
fields = ["peak_depth", "peak_speed"]
exceed = {{ peak_depth = [0.5] }}
quantiles = [0.5]
[[ensemble.vary]]
key = "material.bed.mu"
range = [0.05, 0.35]
[[ensemble.vary]]
key = "release.0.depth"
range = [0.5, 2.0]
"""


class InEnsemble(InFolder):
    def setUp(self):
        super().setUp()
        self.file = self.write(6)

    def write(self, samples, more=""):
        path = self.path("ensemble.toml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(FILE.format(samples=samples) + more)
        return path


class Bytes(InEnsemble):
    def test_the_folder_has_the_bytes_of_the_program(self):
        subprocess.run([PROGRAM, "ensemble", self.file, "--out", self.path("out"), "--threads", "1", "--exceed",
                        "peak_depth=0.25", "--quiet"], check=True, timeout=300)
        os.rename(self.path("out"), self.path("program"))  # ParaView's states know their folder
        told = []
        ensemble = frana.Ensemble(self.file, exceed={"peak_depth": 0.25})
        self.assertEqual((ensemble.samples, ensemble.keys), (6, ["material.bed.mu", "release.0.depth"]))
        found = ensemble.run(self.path("out"), threads=2, progress=lambda now: told.append(str(now)))
        self.assertTrue(found.finished)
        self.assertEqual(told[-1], "6 of 6 runs, 0 failed")
        os.rename(self.path("out"), self.path("module"))

        def names(folder):
            return sorted(os.path.relpath(os.path.join(at, name), folder) for at, _, names in os.walk(folder) for name in names)

        files = names(self.path("program"))
        self.assertEqual(names(self.path("module")), files)
        self.assertIn("rasters/probability_peak_depth_0.25.tif", files)
        self.assertIn("figures/runout.png", files)
        # Wall clock; HDF5 notes when it writes: what it holds is in the maps.
        timed = {"ensemble.json", "shards/0_of_1/runs.csv", "shards/0_of_1/peaks_0000000.h5"}
        _, differ, lost = filecmp.cmpfiles(self.path("program"), self.path("module"), set(files) - timed, shallow=False)
        self.assertEqual((differ, lost), ([], []))

        def untimed(name, pattern):
            texts = []
            for folder in ("program", "module"):
                with open(self.path(folder, name), encoding="utf-8") as file:
                    texts.append(re.sub(pattern, "", file.read()))
            return texts

        self.assertEqual(*untimed("ensemble.json", r'"(core_)?seconds": [\d.e+-]+'))
        # The fifth field of the shard's rows is the wall time.
        self.assertEqual(*untimed("shards/0_of_1/runs.csv", r"(?m)^(\d+,\w+,[^,]*,\d+,)[\d.]+"))


class Maps(InEnsemble):
    def test_probabilities_are_shares_of_the_runs(self):
        many = frana.Ensemble(self.file).run(threads=2)
        runs = many.runs
        self.assertEqual(runs["sample"].tolist(), list(range(6)))
        self.assertEqual(runs["sample"].dtype.kind, "i")
        self.assertEqual(set(runs["reason"]), {"end"})
        self.assertTrue(((runs["material.bed.mu"] > 0.05) & (runs["material.bed.mu"] < 0.35)).all())
        self.assertEqual(runs["release.0.depth"].tolist(), many.samples["release.0.depth"].tolist())
        peaks = []
        for run in runs:
            case = frana.Case(self.case_file, set={"material.bed.mu": run["material.bed.mu"],
                                                   "release.0.depth": run["release.0.depth"]})
            peaks.append(case.run(threads=1).finish().peak_depth)
        for above in (0.5, 0.75):  # one of the file, one that is counted now
            share = many.probability("peak_depth", above=above)
            self.assertEqual(share.array.shape, (ROWS, COLUMNS))
            self.assertEqual(tuple(share.transform)[:6], (CELL, 0, WEST, 0, -CELL, NORTH))
            self.assertIn('"WGS 84 / UTM zone 32N"', share.crs)
            self.assertEqual((share.unit, share.name), ("1", f"probability_peak_depth_{above}"))
            self.assertEqual(share.description, f"share of the runs with peak depth above {above} m")
            counted = sum(peak.array > above for peak in peaks) / 6
            numpy.testing.assert_allclose(numpy.nan_to_num(share.array), counted, atol=1e-7)  # files hold float32
            self.assertGreater(counted.max(), 0.5)
        self.assertIn("mean_peak_speed", many.rasters)
        self.assertEqual(many.rasters["mean_peak_speed"].unit, "m/s")
        self.assertEqual(many.record["run"], 6)
        with self.assertRaisesRegex(frana.DataError, "found no peak_height"):
            many.probability("peak_height", above=1.0)
        for below in (-1.0, float("nan"), float("inf")):
            with self.assertRaisesRegex(frana.DataError, "expected a number from 0 on"):
                many.probability("peak_speed", above=below)
        with self.assertRaisesRegex(frana.DataError, "footprint_depth"):
            many.probability("peak_depth", above=0.01)
        with self.assertRaisesRegex(KeyError, "probability_reached"):
            many.rasters["nothing"]
        folder = many.path
        del many
        self.assertFalse(os.path.exists(folder))  # was nobody's

    def test_open_knows_an_ensembles_folder(self):
        frana.Ensemble(self.file).run(self.path("many"), threads=1)
        found = frana.open(self.path("many"))
        self.assertIsInstance(found, frana.EnsembleFolder)
        self.assertEqual(len(found.runs), 6)
        self.assertIn("# ", found.report)
        os.remove(self.path("many", "runs.csv"))
        with self.assertRaisesRegex(frana.DataError, "runs.csv: No such file"):
            found.runs


class Stopping(InEnsemble):
    def test_ctrl_c_keeps_what_has_run_and_a_later_call_goes_on(self):
        self.write(4000)
        started = threading.Event()

        def stop():
            started.wait(60)
            _thread.interrupt_main()

        stopper = threading.Thread(target=stop)
        stopper.start()
        start = time.monotonic()
        with self.assertRaises(KeyboardInterrupt):
            frana.Ensemble(self.file).run(self.path("many"), threads=1,
                                          progress=lambda now: now.done > 2 and started.set())
        self.assertLess(time.monotonic() - start, 30)
        stopper.join()
        found = frana.open(self.path("many"))
        self.assertFalse(found.finished)
        with open(self.path("many", "shards", "0_of_1", "runs.csv"), encoding="utf-8") as file:
            done = len(file.readlines()) - 2
        self.assertGreater(done, 2)
        self.write(done + 2)  # Sobol's samples stay when there are fewer
        with self.assertRaisesRegex(frana.DataError, "earlier ensemble"):
            frana.Ensemble(self.file).run(self.path("many"), threads=1)
        told = []
        frana.Ensemble(self.file).run(self.path("many"), threads=1, resume=True, progress=told.append)
        self.assertEqual((told[-1].done, told[-1].runs), (2, 2))
        self.assertEqual(len(found.runs), done + 2)

    def test_what_progress_raises_ends_it(self):
        self.write(4000)

        def progress(now):
            raise LookupError("enough")

        with self.assertRaisesRegex(LookupError, "enough"):
            frana.Ensemble(self.file).run(threads=1, progress=progress)

    def test_the_interpreter_is_free_meanwhile(self):
        counted, over = [0], threading.Event()

        def count():
            while not over.is_set():
                counted[0] += 1
                time.sleep(0.001)

        counter = threading.Thread(target=count)
        counter.start()
        frana.Ensemble(self.file).run(threads=1)
        over.set()
        counter.join()
        self.assertGreater(counted[0], 10)


class Problems(InEnsemble):
    def test_problems_of_the_file_come_at_once(self):
        with self.assertRaisesRegex(frana.Error, "material.bed.nu") as caught:
            with open(self.file, "a", encoding="utf-8") as file:
                file.write('[[ensemble.vary]]\nkey = "material.bed.nu"\nrange = [0, 1]\nwrong = 1\n')
            frana.Ensemble(self.file)
        self.assertGreaterEqual(len(caught.exception.problems), 2)
        with self.assertRaisesRegex(frana.Error, "none.toml"):
            frana.Ensemble(self.path("none.toml"))

    def test_problems_of_the_case_come_before_anything_is_written(self):
        os.remove(self.path("release.geojson"))
        with self.assertRaisesRegex(frana.Error, "release.geojson"):
            frana.Ensemble(self.file).run(self.path("many"))
        self.assertFalse(os.path.exists(self.path("many")))
        with self.assertRaisesRegex(ValueError, "resume"):
            frana.Ensemble(self.file).run(resume=True)
        with self.assertRaisesRegex(frana.Error, "--exceed: found"):
            frana.Ensemble(self.file, exceed={"peak_height": [1.0]})

    def test_many_failures_are_warned_of(self):
        with open(self.path("ensemble.toml"), "w", encoding="utf-8") as file:
            file.write('[ensemble]\ncase = "case.toml"\nmethod = "grid"\n[[ensemble.vary]]\nkey = "release.0.outline"\n'
                       'distribution = "discrete"\nvalues = ["release.geojson", "gone.geojson"]\n')
        ensemble = frana.Ensemble(self.file)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            found = ensemble.run(threads=1)
        self.assertIn("more than 5 %", str(caught[-1].message))
        runs = found.runs
        self.assertIn("refused", runs["reason"])
        numpy.testing.assert_array_equal(numpy.isnan(runs["runout_m"]), runs["reason"] == "refused")


if __name__ == "__main__":
    unittest.main()
