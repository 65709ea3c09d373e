from qgis.core import QgsProcessingProvider

from . import settings
from .case_algorithms import CheckCase, RunCaseFile
from .compare_algorithm import CompareWithSurvey
from .many_algorithms import Calibrate, Ensemble
from .run_algorithm import Run


class FranaProvider(QgsProcessingProvider):
    def id(self):
        return "frana"

    def name(self):
        return "frana (landslides)"

    def load(self):
        settings.add(self.name())
        self.refreshAlgorithms()
        return True

    def unload(self):
        settings.remove()

    def loadAlgorithms(self):
        for algorithm in (Run, CheckCase, RunCaseFile, CompareWithSurvey, Ensemble, Calibrate):
            self.addAlgorithm(algorithm())
