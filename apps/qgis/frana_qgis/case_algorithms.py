from qgis.core import QgsProcessingOutputString, QgsProcessingParameterFile, QgsProcessingParameterString

from . import case_text
from .base import FranaAlgorithm
from .run_base import RunAlgorithm


def _case_parameter():
    return QgsProcessingParameterFile("CASE", "Case file", extension="toml")


class CheckCase(FranaAlgorithm):
    NAME = "check"
    TITLE = "Check case"
    HELP = ("Reads a case file and all that it names, builds the scene and says what is wrong with it, or what a run would "
            "take: particles, volume, memory, time. Nothing is run.")

    def initAlgorithm(self, config=None):
        self.addParameter(_case_parameter())
        self.addParameter(QgsProcessingParameterString("SET", "Other keys, a line KEY=VALUE each", "", True, True))
        self.addOutput(QgsProcessingOutputString("FOUND", "What the check tells"))

    def work(self, parameters, context, feedback):
        sets = case_text.sets(self.parameterAsString(parameters, "SET", context))
        ended = self.call(["check", self.parameterAsFile(parameters, "CASE", context), *sets], feedback)
        return {"FOUND": "\n".join(ended.lines)}


class RunCaseFile(RunAlgorithm):
    NAME = "runcase"
    TITLE = "Run case file"
    HELP = ("Runs a case file as it stands, or goes on with a run that was stopped: its own case.toml, its folder, and "
            "\"Go on\".")

    def initAlgorithm(self, config=None):
        self.addParameter(_case_parameter())
        self.add_flag("RESUME", "Go on where a run in the folder was stopped")
        self.add_output()

    def work(self, parameters, context, feedback):
        more = case_text.sets(self.parameterAsString(parameters, "SET", context)) + self.threads(parameters, context)
        more += self.ticked(parameters, context, "OVERWRITE", "RESUME")
        return self.run_case(self.parameterAsFile(parameters, "CASE", context), more, parameters, context, feedback)
