#!/usr/bin/env python3
"""The parts of the QGIS plugin that need no QGIS, on programs made of a few lines of shell: plain.py SOURCE FRANA"""
import importlib
import os
import stat
import sys
import tempfile
import types
import unittest

sys.dont_write_bytecode = True
SOURCE, FRANA = sys.argv[1:3]
PLUGIN = os.path.join(SOURCE, "apps", "qgis", "frana_qgis")
# As a package without its __init__, whose other modules need QGIS only when they are imported.
package = types.ModuleType("frana_qgis")
package.__path__ = [PLUGIN]
sys.modules["frana_qgis"] = package
program = importlib.import_module("frana_qgis.program")
case_text = importlib.import_module("frana_qgis.case_text")
staged = importlib.import_module("frana_qgis.staged")


class Plain(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def script(self, text):
        path = os.path.join(self.folder.name, f"program{len(os.listdir(self.folder.name))}")
        with open(path, "w", encoding="utf-8") as file:
            file.write("#!/bin/sh\n" + text)
        os.chmod(path, os.stat(path).st_mode | stat.S_IXUSR)
        return path

    def refused(self, words, call, *arguments):
        with self.assertRaisesRegex(program.Trouble, words) as trouble:
            call(*arguments)
        self.assertNotIn("\n", str(trouble.exception))

    def test_a_case_is_read_back_as_it_was_given(self):
        try:
            import tomllib
        except ImportError:
            self.skipTest("Python before 3.11 reads no TOML")
        name = 'a "b" \\ c\n\x7f é'
        text = case_text.text({"case.title": name, "grid.cell": 5.0, "release.depth": 1e-3, "release.outline": "r.gpkg",
                               "material.bed.mu": 0.1, "time.stop_at_rest": True, "terrain.window": [0, 1.5]})
        self.assertEqual(tomllib.loads(text), {
            "case": {"title": name}, "grid": {"cell": 5.0}, "release": [{"depth": 1e-3, "outline": "r.gpkg"}],
            "material": {"bed": {"mu": 0.1}}, "time": {"stop_at_rest": True}, "terrain": {"window": [0, 1.5]}})

    def test_other_keys_are_lines(self):
        self.assertEqual(case_text.sets('\n# no\n scheme.cfl=0.4 \nmaterial.bed.mu = "a b.tif"\n'),
                         ["--set", "scheme.cfl=0.4", "--set", 'material.bed.mu = "a b.tif"'])
        self.assertEqual(case_text.sets(""), [])
        for wrong in ("cfl", "cfl=1", "scheme.cfl=", "--out=x", "scheme.cfl 1"):
            self.refused("SET: found .*expected a line KEY=VALUE", case_text.sets, wrong)

    def test_the_program_is_found_or_the_way_to_it_told(self):
        os.environ["FRANA_PROGRAM"] = "/no/frana"
        self.refused("found no program at /no/frana.*Settings > Options", program.find)
        self.refused("found no program at /none", program.find, "/none")  # the setting is asked first
        del os.environ["FRANA_PROGRAM"]
        path, os.environ["PATH"] = os.environ["PATH"], ""
        try:
            self.refused("found no frana on this machine.*build and install", program.find)
        finally:
            os.environ["PATH"] = path

    def test_programs_that_are_none_or_too_old(self):
        self.refused("is version 0.0.9; this plugin needs 0.1.0", program.ready, self.script("echo frana 0.0.9"))
        self.refused("is not frana", program.ready, self.script("echo hello 1.0.0"))
        self.refused("describe --json failed: what", program.ready,
                     self.script('[ $1 = --version ] && echo frana 0.1.0 && exit; echo what >&2; exit 2'))
        self.refused("does not start", program.ready, self.binary_of_nothing())
        self.assertEqual(program.parse_version("frana 1.2.30\nbuild"), (1, 2, 30))

    def binary_of_nothing(self):
        path = self.script("")
        with open(path, "wb") as file:
            file.write(b"\x7fELFnothing")
        return path

    def test_lines_of_a_run_are_told_and_its_end_is(self):
        told = []
        ended = program.call([self.script(
            'echo "{\\"event\\": \\"progress\\", \\"share\\": 0.5}"; echo plain; echo "{not json"; echo bad >&2; exit 2')],
            lambda event, text: told.append(event or text))
        self.assertEqual(told, [{"event": "progress", "share": 0.5}, "plain", "{not json"])
        self.assertEqual((ended.code, ended.errors, ended.stopped), (2, "bad", False))
        self.assertEqual(program.sentence(ended), "bad")
        self.assertIn("please report", program.sentence(program.Ended(1, errors="x")))
        self.assertIn("signal 9", program.sentence(program.Ended(-9)))
        self.assertIn("can be resumed", program.sentence(program.Ended(130)))
        self.assertIsNone(program.sentence(program.Ended(130, stopped=True)))

    def test_cancel_is_sigterm_and_what_comes_after_it_counts(self):
        told = []
        ended = program.call([self.script(
            "trap 'echo \"{\\\"event\\\": \\\"end\\\"}\"; exit 130' TERM; echo started; while :; do sleep 0.05; done")],
            lambda event, text: told.append(text), lambda: "started" in told)
        self.assertTrue(ended.stopped)
        self.assertEqual(ended.code, 130)
        self.assertIn("end", ended.last)

    def test_a_run_that_must_be_killed_is_not_told_to_have_never_begun(self):
        begun = '{\\"event\\": \\"start\\"}'
        patience, program.STOP_PATIENCE = program.STOP_PATIENCE, 0.3
        try:
            told = []
            ended = program.call([self.script(f"trap '' TERM; echo \"{begun}\"; echo started; while :; do sleep 0.05; done")],
                                 lambda event, text: told.append(text), lambda: "started" in told)
        finally:
            program.STOP_PATIENCE = patience
        self.assertTrue(ended.stopped and ended.killed)
        self.assertEqual(ended.code, -9)
        self.assertRegex(program.sentence(ended), "ended by force since it did not end by itself within 120 s")
        before = program.Ended(-15, stopped=True, last={"start": {}})
        self.assertEqual(program.sentence(before), "canceled before the run began")
        after = program.Ended(-15, stopped=True, last={"start": {}, "scene": {}})
        self.assertEqual(program.sentence(after), "canceled; what it wrote before may be resumed")

    def test_inputs_of_an_earlier_run_stay_until_others_are_accepted(self):
        def put(path, text):
            with open(path, "w", encoding="utf-8") as file:
                file.write(text)

        def found():
            with open(os.path.join(self.folder.name, "run", "input", "case.toml"), encoding="utf-8") as file:
                return file.read()

        folder = os.path.join(self.folder.name, "run")
        first = staged.Inputs(folder)
        self.assertFalse(first.replaces())
        put(os.path.join(first.path, "case.toml"), "first")
        put(os.path.join(first.path, "release.gpkg"), "old")
        first.accept()
        first.drop()
        self.assertEqual(found(), "first")
        refused = staged.Inputs(folder)
        self.assertTrue(refused.replaces())
        put(os.path.join(refused.path, "case.toml"), "refused")
        refused.drop()
        self.assertEqual(found(), "first")
        second = staged.Inputs(folder)
        put(os.path.join(second.path, "case.toml"), "second")
        self.assertEqual(second.place(os.path.join(second.path, "dem.vrt")), os.path.join(folder, "input", "dem.vrt"))
        self.assertEqual(second.place("/data/dem.tif"), "/data/dem.tif")
        second.accept()
        second.drop()
        self.assertEqual(found(), "second")
        self.assertEqual(os.listdir(folder), ["input"])
        # What was not replaced is still there: it may be what the new case names.
        self.assertEqual(sorted(os.listdir(os.path.join(folder, "input"))), ["case.toml", "release.gpkg"])
        third = staged.Inputs(folder)
        put(os.path.join(third.path, "release.gpkg"), "new")
        put(os.path.join(third.final, "release.gpkg-wal"), "of the old one")
        third.accept()
        third.drop()
        self.assertEqual(sorted(os.listdir(third.final)), ["case.toml", "release.gpkg"])
        with open(os.path.join(third.final, "release.gpkg"), encoding="utf-8") as file:
            self.assertEqual(file.read(), "new")
        put(os.path.join(self.folder.name, "file"), "")
        self.refused("OUTPUT: found .*nothing can be written", staged.Inputs, os.path.join(self.folder.name, "file"))

    def test_inputs_that_were_left_go_and_those_that_fail_leave_the_earlier(self):
        folder = os.path.join(self.folder.name, "run")
        os.makedirs(os.path.join(folder, "input"))
        staged.Inputs(folder)  # canceled between prepare and work
        later = staged.Inputs(folder)
        self.assertEqual(sorted(os.listdir(folder)), [os.path.basename(later.path), "input"])
        os.mkdir(os.path.join(later.final, "case.toml"))  # cannot be replaced by a file
        with open(os.path.join(later.path, "case.toml"), "w", encoding="utf-8"):
            pass
        self.refused("OUTPUT: the inputs cannot be put into .*choose another one", later.accept)
        later.drop()
        self.assertEqual(os.listdir(folder), ["input"])

    def test_the_plugin_is_of_the_programs_version(self):
        with open(os.path.join(PLUGIN, "metadata.txt"), encoding="utf-8") as file:
            version = [line.split("=")[1].strip() for line in file if line.startswith("version=")]
        self.assertEqual([program.version_text(program.parse_version(program._output(FRANA, "--version")))], version)

    def test_every_key_is_described(self):
        keys = program.keys(FRANA)
        self.assertGreater(len(keys), 200)
        for key, entry in keys.items():
            self.assertTrue(entry["help"] and entry["value"] and entry["kind"], key)
        self.assertEqual(keys["grid.cell"]["unit"], "m")
        self.assertEqual(keys["grid.cell"]["range"], {"low": 0.0, "low_open": True})
        self.assertEqual(keys["material.bed.mu"]["range"],
                         {"low": 0.0, "low_open": False, "high": 10.0, "high_open": False})
        self.assertIn("voellmy", keys["material.bed.law"]["choices"])
        self.assertEqual(keys["particles.per_cell"]["default"], 4)
        self.assertIs(keys["release.depth"]["repeated"], True)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
