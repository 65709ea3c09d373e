"""Many runs: the files that say what varies are written by hand (apps/README.md), so they are run as they are."""
import json
import os

from qgis.core import (
    QgsProcessingOutputFile,
    QgsProcessingOutputString,
    QgsProcessingParameterFile,
    QgsProcessingParameterFolderDestination,
)

from . import results
from .base import FranaAlgorithm, existing
from .layers import require_folder


class ManyRuns(FranaAlgorithm):
    COMMAND = ""

    def initAlgorithm(self, config=None):
        self.addParameter(QgsProcessingParameterFile("FILE", "What varies (TOML)", extension="toml"))
        self.add_threads()
        self.add_flag("RESUME", "Go on with what has been run in the folder")
        self.add_more()
        self.add_flag("LOAD", "Load the maps into the project, in a group of their own", True)
        self.addParameter(QgsProcessingParameterFolderDestination("OUTPUT", "Folder of the runs and the maps"))
        self.addOutput(QgsProcessingOutputFile("REPORT", "Report"))

    def add_more(self):
        pass

    def run_many(self, more, maps, parameters, context, feedback):
        folder = require_folder(self.parameterAsString(parameters, "OUTPUT", context))
        file = self.parameterAsFile(parameters, "FILE", context)
        more = more + self.threads(parameters, context) + self.ticked(parameters, context, "RESUME")
        ended = self.call([self.COMMAND, file, "--out", folder, "--progress", "json", *more], feedback)
        if ended.stopped:
            feedback.pushWarning(f"stopped before its end: the runs in {folder} are kept; \"Go on\" takes the others")
        elif self.parameterAsBool(parameters, "LOAD", context):
            results.load(results.of_maps(os.path.join(folder, maps)), os.path.basename(folder), context)
        return {"OUTPUT": folder, "REPORT": existing(folder, "report.md")}


class Ensemble(ManyRuns):
    NAME = COMMAND = "ensemble"
    TITLE = "Ensemble"
    HELP = "Many runs of a case whose keys vary, and maps of probability, quantiles and arrival."

    def work(self, parameters, context, feedback):
        return self.run_many([], "", parameters, context, feedback)


class Calibrate(ManyRuns):
    NAME = COMMAND = "calibrate"
    TITLE = "Calibrate"
    HELP = "What surveyed events tell of friction and volume: best values, and what they leave open."

    def add_more(self):
        self.add_flag("OVERWRITE", "Replace an earlier calibration in the folder")
        self.addOutput(QgsProcessingOutputString("BEST", "Best values (JSON)"))

    def work(self, parameters, context, feedback):
        found = self.run_many(self.ticked(parameters, context, "OVERWRITE"), "predict", parameters, context, feedback)
        result = existing(found["OUTPUT"], "calibrate.json")
        if result:
            with open(result, encoding="utf-8") as file:
                found["BEST"] = json.dumps(json.load(file)["best"])
            feedback.pushInfo(f"best: {found['BEST']}")
        return found
