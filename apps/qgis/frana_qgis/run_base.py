"""What the two algorithms that run a case share."""
import os

from qgis.core import (
    QgsProcessingOutputFile,
    QgsProcessingOutputNumber,
    QgsProcessingOutputRasterLayer,
    QgsProcessingOutputVectorLayer,
    QgsProcessingParameterFolderDestination,
    QgsProcessingParameterString,
)

from . import results
from .base import FranaAlgorithm, existing
from .layers import require_folder
from .widgets import set_advanced

_RASTERS = {"PEAK_DEPTH": "rasters/peak_depth.tif", "PEAK_SPEED": "rasters/peak_speed.tif",
            "PEAK_DYNAMIC_PRESSURE": "rasters/peak_dynamic_pressure.tif", "PEAK_PRESSURE": "rasters/peak_pressure.tif",
            "ARRIVAL_TIME": "rasters/arrival_time.tif", "FINAL_DEPTH": "rasters/final_depth.tif"}


class RunAlgorithm(FranaAlgorithm):
    def add_output(self):
        self.addParameter(set_advanced(QgsProcessingParameterString(
            "SET", "Other keys, a line KEY=VALUE each, texts in quotes (`frana describe` lists them)", "", True, True)))
        self.add_threads()
        self.add_flag("OVERWRITE", "Replace an earlier run in the folder")
        self.add_flag("LOAD", "Load the results into the project, in a group of their own", True)
        self.addParameter(QgsProcessingParameterFolderDestination("OUTPUT", "Folder of the run"))
        for name, file in _RASTERS.items():
            self.addOutput(QgsProcessingOutputRasterLayer(name, results.title_of(file).capitalize()))
        self.addOutput(QgsProcessingOutputVectorLayer("FOOTPRINT", "Footprint"))
        self.addOutput(QgsProcessingOutputFile("REPORT", "Report"))
        self.addOutput(QgsProcessingOutputFile("PROJECT", "Project of the run, where the program writes one"))
        self.addOutput(QgsProcessingOutputNumber("STOPPED", "1 where the run was stopped before its end"))

    def prepare(self, parameters, context, feedback):
        # Asked for once: a temporary folder would be another one each time.
        self._folder = require_folder(self.parameterAsString(parameters, "OUTPUT", context))

    def run_case(self, case, more, parameters, context, feedback):
        """`frana run`, its results, and the words about going on where it was stopped."""
        folder = self._folder
        ended = self.call(["run", case, "--out", folder, "--progress", "json", *more], feedback)
        if ended.stopped:
            feedback.pushWarning(f"stopped before its end: what lies in {folder} is whole and can be resumed: use Run case "
                                 f"file with {os.path.join(folder, 'case.toml')}, the same folder and \"Go on\"")
        group = ended.last.get("scene", {}).get("title") or os.path.basename(folder)
        if self.parameterAsBool(parameters, "LOAD", context) and not ended.stopped:
            results.load(results.of_run(folder), group, context)
        found = {name: existing(folder, file) for name, file in _RASTERS.items()}
        found.update(OUTPUT=folder, FOOTPRINT=existing(folder, "footprint.geojson"),
                     REPORT=existing(folder, "report.md"), PROJECT=existing(folder, "run.qgz"), STOPPED=int(ended.stopped))
        feedback.pushInfo(f"report: {found['REPORT']}")
        return {name: value for name, value in found.items() if value is not None}
