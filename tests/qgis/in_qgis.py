#!/usr/bin/env python3
"""The plugin in QGIS, called by tests/qgis.sh: in_qgis.py FRANA SOURCE WORK QGIS_PROCESS

From outside by qgis_process, which starts a new QGIS for each call (3 s); from inside by PyQGIS what needs a project.
"""
import json
import os
import shlex
import shutil
import struct
import subprocess
import sys
import time
import unittest

FRANA, SOURCE, WORK, PROCESS = sys.argv[1:5]
PLUGINS = os.path.join(os.environ["HOME"], ".local/share/QGIS/QGIS3/profiles/default/python/plugins")
sys.path[:0] = ["/usr/share/qgis/python/plugins", PLUGINS]
os.environ["FRANA_PROGRAM"] = FRANA
os.makedirs(PLUGINS)
shutil.copytree(os.path.join(SOURCE, "apps/qgis/frana_qgis"), os.path.join(PLUGINS, "frana_qgis"),
                ignore=shutil.ignore_patterns("__pycache__"))

from osgeo import gdal, osr  # noqa: E402
from qgis.core import (  # noqa: E402
    QgsApplication,
    QgsCoordinateReferenceSystem,
    QgsCoordinateTransform,
    QgsFeature,
    QgsGeometry,
    QgsProcessingContext,
    QgsProcessingException,
    QgsProcessingFeedback,
    QgsProject,
    QgsRasterLayer,
    QgsRectangle,
    QgsVectorLayer,
)

gdal.UseExceptions()
UTM = "EPSG:32632"
WEST, SOUTH, CELL = 600000.0, 5100000.0, 10.0  # a slope of 60 x 40 pixels


def slope(file, crs=UTM, turn=0.0, cell=CELL, west=WEST, south=SOUTH):
    data = gdal.GetDriverByName("GTiff").Create(file, 60, 40, 1, gdal.GDT_Float32)
    data.SetGeoTransform([west, cell, turn, south + 40 * cell, turn, -cell])
    if crs:
        data.SetSpatialRef(spatial(crs))
    row = bytes().join(struct.pack("f", 1000.0 - 0.4 * column * CELL) for column in range(60))
    data.WriteRaster(0, 0, 60, 40, row * 40, buf_type=gdal.GDT_Float32)
    return file


def spatial(crs):
    found = osr.SpatialReference()
    found.SetFromUserInput(crs)
    return found


def square(x, y, side=80.0, crs=UTM, depth=2.0):
    """A layer in memory with one square."""
    layer = QgsVectorLayer(f"Polygon?crs={crs}&field=thick:double" if crs else "Polygon?field=thick:double", "scar", "memory")
    feature = QgsFeature(layer.fields())
    feature.setAttributes([depth])
    feature.setGeometry(QgsGeometry.fromRect(QgsRectangle(x, y, x + side, y + side)))
    layer.dataProvider().addFeature(feature)
    layer.updateExtents()
    if not crs:
        layer.setCrs(QgsCoordinateReferenceSystem())
    return layer


def volcano(folder):
    """The terrain and the release of cases/maungawhau, which has local coordinates, set down at a place in UTM."""
    case = os.path.join(SOURCE, "cases/maungawhau")
    terrain = gdal.Open(os.path.join(case, "dem.asc"))
    x, cell, _, y, _, _ = terrain.GetGeoTransform()
    bounds = [WEST + x, SOUTH + y, WEST + x + cell * terrain.RasterXSize, SOUTH + y - cell * terrain.RasterYSize]
    dem = os.path.join(folder, "volcano.tif")
    gdal.Translate(dem, terrain, outputSRS=UTM, outputBounds=bounds)
    with open(os.path.join(case, "release.geojson"), encoding="utf-8") as file:
        rings = json.load(file)["features"][0]["geometry"]["coordinates"]
    rings = [[[WEST + px, SOUTH + py] for px, py in ring] for ring in rings]
    release = os.path.join(folder, "rim.geojson")
    with open(release, "w", encoding="utf-8") as file:
        json.dump({"type": "FeatureCollection", "crs": {"type": "name", "properties": {"name": UTM}}, "features": [
            {"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": rings}}]}, file)
    return dem, release


class Listener(QgsProcessingFeedback):
    """What a person would see in the log; cancels once a run moves, where that is asked for."""

    def __init__(self, cancel=False):
        super().__init__()
        self.log, self.shares, self._cancel = [], [], cancel

    def pushInfo(self, text):
        self.log.append(text)

    pushWarning = pushCommandInfo = pushInfo

    def reportError(self, text, fatal=False):
        self.log.append(text)

    def setProgressText(self, text):
        self.log.append(text)
        if self._cancel and text.startswith("t = "):
            self.cancel()

    def said(self):
        return "\n".join(self.log)


def process(*arguments):
    done = subprocess.run([PROCESS, *arguments], capture_output=True, text=True, timeout=300, check=False)
    return done.returncode, done.stdout, done.stderr


class FromOutside(unittest.TestCase):
    """As scripts call it."""

    @classmethod
    def setUpClass(cls):
        code, out, err = process("plugins", "enable", "frana_qgis")
        assert code == 0, out + err
        cls.dem, cls.release = volcano(WORK)

    def run_with(self, *more):
        return process("run", "frana:run", f"--DEM={self.dem}", f"--RELEASE={self.release}", "--END=5", *more)

    def test_1_all_algorithms_are_listed(self):
        code, out, err = process("list")
        self.assertEqual(code, 0, err)
        for name in ("run", "check", "runcase", "compare", "ensemble", "calibrate"):
            self.assertIn(f"frana:{name}\t", out)

    def test_2_help_tells_units_ranges_and_keys(self):
        code, out, err = process("help", "frana:run")
        self.assertEqual(code, 0, err)
        for words in ("material.bed.mu: friction coefficient", "a number at least 0 and at most 10", "[m/s^2]",
                      "DEPTH_FIELD", "MANNING_N", "voellmy"):
            self.assertIn(words, out)
        for name, title in {"PEAK_PRESSURE": "Peak pressure on the bed", "PEAK_DYNAMIC_PRESSURE": "Peak dynamic pressure",
                            "PEAK_DEPTH": "Peak depth"}.items():
            self.assertRegex(out, rf"(?m)^{name}:.*\n\s*{title}$")

    def test_3_a_run_of_a_shipped_terrain_is_that_of_its_case(self):
        by_hand, folder = os.path.join(WORK, "by_hand"), os.path.join(WORK, "outside")
        subprocess.run([FRANA, "run", os.path.join(SOURCE, "cases/maungawhau/case.toml"), "--out", by_hand, "--quiet",
                        "--set", "grid.cell=10", "--set", "particles.per_cell=4", "--set", "time.end=5", "--set",
                        'output.formats=["geotiff"]'], check=True)
        code, out, err = self.run_with("--DEPTH=4", "--MU=0.1", "--XI=300", "--DENSITY=1800",
                                       '--SET=output.formats=["geotiff"]', f"--OUTPUT={folder}")
        self.assertEqual(code, 0, out + err)
        self.assertIn(f"PEAK_DEPTH:\t{folder}/rasters/peak_depth.tif", out)
        self.assertIn(f"PEAK_DYNAMIC_PRESSURE:\t{folder}/rasters/peak_dynamic_pressure.tif", out)
        deepest, volumes = [], []
        for run in (by_hand, folder):
            peak = gdal.Open(os.path.join(run, "rasters/peak_depth.tif"))
            deepest.append(peak.GetRasterBand(1).ComputeStatistics(False)[1])
            with open(os.path.join(run, "run.json"), encoding="utf-8") as file:
                record = json.load(file)
            volumes.append(record["budgets"]["mass"]["initial"])
        self.assertEqual(peak.GetSpatialRef().GetAuthorityCode(None), UTM.split(":")[1])
        # Coordinates of 5e6 m have lost ten bits to those of 5e2 m.
        self.assertAlmostEqual(volumes[0] / volumes[1], 1.0, places=9)
        self.assertAlmostEqual(deepest[0] / deepest[1], 1.0, places=4)
        for remark in record["remarks"]:
            self.assertIn(f"remark: {remark}", out + err)
        with open(os.path.join(folder, "case.toml"), encoding="utf-8") as file:
            case = file.read()
        for line in ("mu = 0.1\n", "xi = 300.0\n", "depth = 4.0\n", "end = 5.0\n", 'law = "voellmy"\n'):
            self.assertIn(line, case)

    def test_4_the_programs_sentence_is_the_error(self):
        code, _, err = self.run_with("--DEPTH=2", "--MU=0.1", f"--OUTPUT={WORK}/no_xi")
        self.assertEqual(code, 1)
        self.assertIn("material.bed.xi", err)
        self.assertIn("voellmy", err)

    def test_5_without_a_program_it_says_what_to_do(self):
        kept, os.environ["FRANA_PROGRAM"] = os.environ["FRANA_PROGRAM"], "/no/frana"
        try:
            code, out, err = self.run_with("--DEPTH=2", f"--OUTPUT={WORK}/no_program")
        finally:
            os.environ["FRANA_PROGRAM"] = kept
        self.assertNotEqual(code, 0)
        self.assertIn("found no program at /no/frana", out + err)


class FromInside(unittest.TestCase):
    """As a person at a project does."""

    @classmethod
    def setUpClass(cls):
        cls.app = QgsApplication([], True)
        cls.app.initQgis()
        import processing
        from frana_qgis.plugin import FranaPlugin
        from processing.core.Processing import Processing

        Processing.initialize()
        cls.plugin = FranaPlugin()
        cls.plugin.initProcessing()
        cls.processing = processing
        cls.dem = QgsRasterLayer(slope(os.path.join(WORK, "inside_dem.tif")), "slope")

    @classmethod
    def tearDownClass(cls):
        QgsProject.instance().clear()
        cls.dem = None
        cls.plugin.unload()

    def inputs(self, name, **more):
        return {"DEM": self.dem, "RELEASE": square(WEST + 100, SOUTH + 160), "DEPTH": 2.0, "MU": 0.1, "XI": 500.0,
                "END": 5.0, "SET": 'output.formats=["geotiff"]', "OUTPUT": os.path.join(WORK, name), **more}

    def call(self, algorithm, parameters, listener=None):
        context = QgsProcessingContext()
        context.setProject(QgsProject.instance())
        self.listener = listener or Listener()
        return self.processing.run(algorithm, parameters, context=context, feedback=self.listener)

    def refused(self, words, **more):
        with self.assertRaisesRegex(QgsProcessingException, words):
            self.call("frana:run", self.inputs("refused", **more))
        self.assertFalse(os.path.exists(os.path.join(WORK, "refused", "run.json")))

    def test_layers_in_memory_fields_and_other_systems(self):
        """A release in memory, its depth in a field, in a system of its own, gives the run that the number gives."""
        plain = self.call("frana:run", self.inputs("plain"))
        there = square(WEST + 100, SOUTH + 160)
        field = self.call("frana:run", self.inputs("field", RELEASE=there, DEPTH=None, DEPTH_FIELD="thick"))
        degrees = QgsVectorLayer("Polygon?crs=EPSG:4326", "scar", "memory")
        for feature in there.getFeatures():
            geometry = feature.geometry()
            geometry.transform(QgsCoordinateTransform(there.crs(), degrees.crs(), QgsProject.instance()))
            moved = QgsFeature(degrees.fields())
            moved.setGeometry(geometry)
            degrees.dataProvider().addFeature(moved)
        degrees.updateExtents()
        other = self.call("frana:run", self.inputs("degrees", RELEASE=degrees))
        volumes = []
        for found in (plain, field, other):
            with open(os.path.join(found["OUTPUT"], "run.json"), encoding="utf-8") as file:
                volumes.append(json.load(file)["budgets"]["mass"]["initial"])
            self.assertEqual(found["STOPPED"], 0)
        self.assertEqual(volumes[0], volumes[1])
        self.assertAlmostEqual(volumes[2] / volumes[0], 1.0, places=6)  # to degrees and back: 1e-9 of the coordinates
        self.assertAlmostEqual(volumes[0] / (80 * 80 * 2 * 1000), 1.0, places=6)

    def test_results_come_into_a_group_with_their_styles(self):
        self.call("frana:run", self.inputs("group"))  # makes the folder that the styles are put into
        style = os.path.join(WORK, "group/rasters/peak_speed.qml")
        if os.path.exists(style):
            os.remove(style)
        layer = QgsRasterLayer(os.path.join(WORK, "group/rasters/peak_speed.tif"), "x")
        layer.renderer().setOpacity(0.37)
        layer.saveNamedStyle(style)
        from frana_qgis import results
        from processing.gui.Postprocessing import handleAlgorithmResults

        context = QgsProcessingContext()
        context.setProject(QgsProject.instance())
        files = results.of_run(os.path.join(WORK, "group"))
        results.load(files, "My run", context)
        algorithm = QgsApplication.processingRegistry().algorithmById("frana:run")
        self.assertTrue(handleAlgorithmResults(algorithm, context, QgsProcessingFeedback(), parameters={}))
        group = QgsProject.instance().layerTreeRoot().findGroup("My run")
        names = [node.name() for node in group.findLayers()]
        self.assertEqual(names[:5], ["footprint", "peak depth", "peak speed", "peak dynamic pressure",
                                     "peak pressure on the bed"])
        self.assertEqual(len(names), len(files))
        self.assertEqual(len(QgsProject.instance().layerTreeRoot().findLayers()), len(files))
        self.assertEqual([node.itemVisibilityChecked() for node in group.findLayers()][:3], [True, True, False])
        outline = group.findLayers()[0].layer().renderer().symbol().symbolLayer(0)
        self.assertEqual((outline.layerType(), outline.width()), ("SimpleLine", 0.5))  # of footprint.qml
        alone = QgsVectorLayer(os.path.join(WORK, "group/footprint.geojson"), "alone")  # dragged into any map
        self.assertEqual(alone.renderer().symbol().symbolLayer(0).layerType(), "SimpleLine")
        speed = group.findLayers()[2].layer()
        self.assertAlmostEqual(speed.renderer().opacity(), 0.37)

    def test_cancel_leaves_a_run_that_goes_on(self):
        long = self.inputs("canceled", END=100000.0, STOP_AT_REST=False, MU=0.0, SET="boundary.sides=\"wall\"\n"
                           "output.every=1000\noutput.formats=[\"geotiff\"]")
        start = time.monotonic()
        found = self.call("frana:run", long, Listener(cancel=True))
        self.assertLess(time.monotonic() - start, 60)
        self.assertEqual(found["STOPPED"], 1)
        self.assertIn("can be resumed", self.listener.said())
        with open(os.path.join(found["OUTPUT"], "run.json"), encoding="utf-8") as file:
            run = json.load(file)
        self.assertEqual(run["exit_reason"], "interrupted")
        on = {"CASE": os.path.join(found["OUTPUT"], "case.toml"), "OUTPUT": found["OUTPUT"], "RESUME": True,
              "SET": long["SET"]}
        self.call("frana:runcase", on, Listener(cancel=True))
        with open(os.path.join(found["OUTPUT"], "run.json"), encoding="utf-8") as file:
            self.assertGreater(json.load(file)["steps"], run["steps"])

    def test_compare_gives_scores(self):
        run = self.call("frana:run", self.inputs("compared"))["OUTPUT"]
        found = self.call("frana:compare", {"RUN": run, "SURVEY": QgsVectorLayer(os.path.join(run, "footprint.geojson"), "f")})
        self.assertAlmostEqual(found["IOU"], 1.0, places=3)  # against itself
        self.assertTrue(os.path.exists(found["SCORES"]))

    def test_a_run_on_local_coordinates_is_compared_with_a_survey_on_them(self):
        """Neither has a coordinate system; maungawhau's do not."""
        run = os.path.join(WORK, "local")
        subprocess.run([FRANA, "run", os.path.join(SOURCE, "cases/maungawhau/case.toml"), "--out", run, "--quiet", "--set",
                        "time.end=5", "--set", 'output.formats=["geotiff"]'], check=True)
        layer = QgsVectorLayer(os.path.join(run, "footprint.geojson"), "f")
        layer.setCrs(QgsCoordinateReferenceSystem())
        deposit = QgsRasterLayer(os.path.join(run, "rasters/final_depth.tif"), "d")
        deposit.setCrs(QgsCoordinateReferenceSystem())
        found = self.call("frana:compare", {"RUN": run, "SURVEY": layer, "DEPOSIT": deposit})
        self.assertAlmostEqual(found["IOU"], 1.0, places=3)
        self.assertNotIn("coordinate system", self.listener.said())
        layer.setCrs(QgsCoordinateReferenceSystem(UTM))
        found = self.call("frana:compare", {"RUN": run, "SURVEY": layer})
        self.assertAlmostEqual(found["IOU"], 1.0, places=3)
        self.assertIn(f'SURVEY: the layer "f" has a coordinate system ({UTM}), and the run has none', self.listener.said())
        with self.assertRaisesRegex(QgsProcessingException, r'SURVEY: the layer "scar" is in degrees \(EPSG:4326\)'):
            self.call("frana:compare", {"RUN": run, "SURVEY": square(10.3, 46.0, side=0.01, crs="EPSG:4326")})

    def test_a_temporary_folder_is_one_folder(self):
        found = self.call("frana:run", self.inputs("unused", OUTPUT="TEMPORARY_OUTPUT"))
        self.assertTrue(os.path.exists(os.path.join(found["OUTPUT"], "run.json")))
        self.assertTrue(os.path.exists(os.path.join(found["OUTPUT"], "input", "release.gpkg")))
        with open(os.path.join(found["OUTPUT"], "case.toml"), encoding="utf-8") as file:
            self.assertIn(os.path.join(found["OUTPUT"], "input"), file.read())

    def test_a_refused_case_leaves_the_earlier_runs_inputs(self):
        run = self.call("frana:run", self.inputs("keeps"))["OUTPUT"]
        before = sorted(os.listdir(run)), os.stat(os.path.join(run, "input", "release.gpkg")).st_mtime_ns
        with self.assertRaisesRegex(QgsProcessingException, "scheme.cfl"):
            self.call("frana:run", self.inputs("keeps", OVERWRITE=True, SET="scheme.cfl=-1"))
        self.assertEqual((sorted(os.listdir(run)), os.stat(os.path.join(run, "input", "release.gpkg")).st_mtime_ns), before)
        self.call("frana:run", self.inputs("keeps", OVERWRITE=True))
        self.assertGreater(os.stat(os.path.join(run, "input", "release.gpkg")).st_mtime_ns, before[1])

    def test_layers_among_the_earlier_runs_inputs_are_read(self):
        run = self.call("frana:run", self.inputs("again"))["OUTPUT"]
        dem = QgsRasterLayer(slope(os.path.join(run, "input", "mine.tif"), None), "mine")
        dem.setCrs(QgsCoordinateReferenceSystem(UTM))
        self.call("frana:run", self.inputs("again", OVERWRITE=True, DEM=dem))
        other = QgsRasterLayer(os.path.join(run, "input", "dem.vrt"), "other")  # of mine.tif
        other.setCrs(QgsCoordinateReferenceSystem("EPSG:32633"))
        release = square(WEST + 100, SOUTH + 160, crs="EPSG:32633")
        found = self.call("frana:run", self.inputs("again", OVERWRITE=True, DEM=other, RELEASE=release))
        self.assertEqual(QgsRasterLayer(found["PEAK_DEPTH"]).crs().authid(), "EPSG:32633")

    def test_cancel_while_a_case_is_checked_leaves_the_earlier_runs_inputs(self):
        class Impatient(Listener):
            def pushInfo(self, text):
                super().pushInfo(text)
                if text == "checking":
                    self.cancel()

        run = self.call("frana:run", self.inputs("impatient"))["OUTPUT"]
        case = os.path.join(run, "input", "case.toml")
        before = os.stat(case).st_mtime_ns
        slow = os.path.join(WORK, "slow")
        with open(slow, "w", encoding="utf-8") as file:
            file.write("#!/bin/sh\n[ $1 = check ] || exec " + shlex.quote(FRANA) + " \"$@\"\n"
                       "trap 'exit 0' TERM; echo checking; while :; do sleep 0.05; done\n")
        os.chmod(slow, 0o755)
        kept, os.environ["FRANA_PROGRAM"] = os.environ["FRANA_PROGRAM"], slow
        try:
            with self.assertRaisesRegex(QgsProcessingException, "canceled before the run began; the earlier run keeps"):
                self.call("frana:run", self.inputs("impatient", OVERWRITE=True), Impatient())
        finally:
            os.environ["FRANA_PROGRAM"] = kept
        self.assertEqual(os.stat(case).st_mtime_ns, before)

    def test_the_command_in_the_log_can_be_pasted_into_a_shell(self):
        self.call("frana:run", self.inputs("with blanks"))
        command = next(line for line in self.listener.log if line.startswith("frana run "))
        self.assertIn(os.path.join(WORK, "with blanks"), shlex.split(command))

    def test_check_tells_what_a_run_would_take(self):
        found = self.call("frana:check", {"CASE": os.path.join(SOURCE, "cases/maungawhau/case.toml")})
        self.assertIn("particles", found["FOUND"])

    def test_an_ensemble_leaves_maps(self):
        case = os.path.join(SOURCE, "cases/ensemble/case.toml")
        file = os.path.join(WORK, "two.toml")
        with open(file, "w", encoding="utf-8") as stream:
            stream.write(f'[ensemble]\ncase = "{case}"\nsamples = 2\nexceed = {{ peak_depth = [0.5] }}\n'
                         '[[ensemble.vary]]\nkey = "material.bed.mu"\nrange = [0.3, 0.4]\n')
        found = self.call("frana:ensemble", {"FILE": file, "OUTPUT": os.path.join(WORK, "two")})
        self.assertTrue(os.path.exists(found["REPORT"]))
        self.assertIn("2 of 2 runs, 0 failed", self.listener.said())

    def test_a_calibration_tells_the_best_values(self):
        case = os.path.join(SOURCE, "cases/calibrate/case.toml")
        file = os.path.join(WORK, "few.toml")
        with open(file, "w", encoding="utf-8") as stream:
            stream.write('[calibrate]\nsamples = 4\nrounds = 1\nsearch = "none"\n[[calibrate.vary]]\n'
                         'key = "material.bed.mu"\nrange = [0.3, 0.4]\n'
                         f'[[event]]\nname = "first"\ncase = "{case}"\nobjective = ["outline"]\n')
        parameters = {"FILE": file, "OUTPUT": os.path.join(WORK, "few")}
        best = json.loads(self.call("frana:calibrate", parameters)["BEST"])
        self.assertTrue(0.3 <= best["material.bed.mu"] <= 0.4)
        self.assertIn("4 of 4 runs, 0 failed", self.listener.said())

    # One sentence each for what cannot be read right.

    def test_degrees_and_no_system_are_refused_with_the_way_out(self):
        degrees = QgsRasterLayer(slope(os.path.join(WORK, "degrees.tif"), "EPSG:4326", cell=1e-4, west=10.3, south=46.0), "d")
        self.refused(r'DEM: the layer "d" is in degrees \(EPSG:4326\).*UTM zone 32N \(EPSG:32632\)', DEM=degrees)
        feet = QgsRasterLayer(slope(os.path.join(WORK, "feet.tif"), "EPSG:2263"), "f")
        self.refused('DEM: the layer "f" is in .*feet.*expected metres', DEM=feet)
        none = QgsRasterLayer(slope(os.path.join(WORK, "none.tif"), None), "n")
        none.setCrs(QgsCoordinateReferenceSystem())
        self.refused('DEM: the layer "n" has no coordinate system', DEM=none)
        self.refused('RELEASE: the layer "scar" has no coordinate system',
                     RELEASE=square(WEST + 100, SOUTH + 160, crs=None))

    def test_a_system_that_only_the_project_knows_is_used(self):
        told = QgsRasterLayer(slope(os.path.join(WORK, "told.tif"), None), "told")
        told.setCrs(QgsCoordinateReferenceSystem(UTM))
        found = self.call("frana:run", self.inputs("told", DEM=told))
        self.assertEqual(QgsRasterLayer(found["PEAK_DEPTH"]).crs().authid(), UTM)

    def test_rotated_rasters_and_places_elsewhere(self):
        turned = QgsRasterLayer(slope(os.path.join(WORK, "turned.tif"), turn=1.0), "t")
        self.refused('DEM: the raster of the layer "t" is rotated', DEM=turned)
        self.refused("RELEASE: lies outside of DEM", RELEASE=square(WEST - 5000, SOUTH))
        empty = square(WEST + 100, SOUTH + 160)
        empty.dataProvider().truncate()
        self.refused("RELEASE: .*no features", RELEASE=empty)

    def test_layers_that_are_edited(self):
        edited = square(WEST + 100, SOUTH + 160)
        edited.startEditing()
        self.refused('RELEASE: the layer "scar" is being edited.*pencil', RELEASE=edited)
        edited.rollBack()

    def test_folders_of_others_and_lines_that_are_no_keys(self):
        self.refused("SET: found 'nonsense'", SET="nonsense")
        file = os.path.join(WORK, "file")
        open(file, "w", encoding="utf-8").close()
        with self.assertRaisesRegex(QgsProcessingException, "OUTPUT: found .*nothing can be written"):
            self.call("frana:run", self.inputs("file/below"))

    def test_an_earlier_run_stays_as_it_is(self):
        parameters = self.inputs("earlier", END=1.0)
        release = os.path.join(self.call("frana:run", parameters)["OUTPUT"], "input/release.gpkg")
        made = os.path.getmtime(release)
        with self.assertRaisesRegex(QgsProcessingException, "OUTPUT: found an earlier run in .*OVERWRITE"):
            self.call("frana:run", parameters)
        self.assertEqual(os.path.getmtime(release), made)
        self.call("frana:run", {**parameters, "OVERWRITE": True})
        self.assertGreater(os.path.getmtime(release), made)

    def test_a_program_that_is_too_old(self):
        old = os.path.join(WORK, "old")
        with open(old, "w", encoding="utf-8") as file:
            file.write("#!/bin/sh\necho frana 0.0.1\n")
        os.chmod(old, 0o755)
        kept, os.environ["FRANA_PROGRAM"] = os.environ["FRANA_PROGRAM"], old
        try:
            self.refused("is version 0.0.1; this plugin needs")
        finally:
            os.environ["FRANA_PROGRAM"] = kept


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
