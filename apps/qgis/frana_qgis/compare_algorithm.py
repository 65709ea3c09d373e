import json
import os

from qgis.core import (
    QgsProcessing,
    QgsProcessingOutputFile,
    QgsProcessingOutputNumber,
    QgsProcessingParameterFeatureSource,
    QgsProcessingParameterFile,
    QgsProcessingParameterRasterLayer,
    QgsRasterLayer,
)

from . import layers
from .base import FranaAlgorithm, existing
from .program import Trouble

_SCORES = {"IOU": "iou", "PRECISION": "precision", "RECALL": "recall", "AREA_RATIO": "area_ratio",
           "RUNOUT_DIFFERENCE": "runout_difference", "BOUNDARY_DISTANCE_MEAN": "boundary_distance_mean"}


class CompareWithSurvey(FranaAlgorithm):
    NAME = "compare"
    TITLE = "Compare with survey"
    HELP = ("Holds a finished run against the mapped extent of the event and, if there is one, against a raster of its "
            "deposit. The scores go to compare.json and compare.md in the run's folder. Where the case has "
            "another survey, they are named after the one given here.")

    def initAlgorithm(self, config=None):
        self.addParameter(QgsProcessingParameterFile("RUN", "Folder of the run",
                                                     behavior=QgsProcessingParameterFile.Folder))
        self.addParameter(QgsProcessingParameterFeatureSource("SURVEY", "Surveyed extent, polygons",
                                                              [QgsProcessing.TypeVectorPolygon]))
        self.addParameter(QgsProcessingParameterRasterLayer("DEPOSIT", "Depth of the deposit [m]", None, True))
        self.addParameter(QgsProcessingParameterFeatureSource("PATH", "Line along which the runout is measured",
                                                              [QgsProcessing.TypeVectorLine], None, True))
        for name, key in _SCORES.items():
            self.addOutput(QgsProcessingOutputNumber(name, key.replace("_", " ")))
        self.addOutput(QgsProcessingOutputFile("SCORES", "All scores (compare.json)"))
        self.addOutput(QgsProcessingOutputFile("TABLE", "The scores for people (compare.md)"))

    def prepare(self, parameters, context, feedback):
        folder = self.parameterAsFile(parameters, "RUN", context)
        peak = existing(folder, "rasters/peak_depth.tif")
        if peak is None:
            raise Trouble(f"RUN: found no rasters/peak_depth.tif in {folder}; expected the folder of a finished run")
        crs = QgsRasterLayer(peak).crs()
        inputs = layers.require_folder(os.path.join(folder, "input"))
        self._arguments = ["compare", folder, "--survey", self._vector("SURVEY", crs, inputs, parameters, context, feedback)]
        if self.given(parameters, "DEPOSIT"):
            deposit = self.parameterAsRasterLayer(parameters, "DEPOSIT", context)
            if not crs.isValid():
                layers.accept_local("DEPOSIT", deposit, feedback)
            as_file = layers.elevation_file if crs.isValid() else layers.raster_file
            self._arguments += ["--deposit", as_file("DEPOSIT", deposit, inputs)]
        if self.given(parameters, "PATH"):
            self._arguments += ["--path", self._vector("PATH", crs, inputs, parameters, context, feedback)]

    def work(self, parameters, context, feedback):
        ended = self.call(self._arguments, feedback)
        written = ended.lines[ended.lines.index("Written:") + 1:]
        scores, table = (next(name for name in written if name.endswith(kind)) for kind in (".json", ".md"))
        with open(scores, encoding="utf-8") as file:
            told = json.load(file)
        found = {name: told[key] for name, key in _SCORES.items() if told.get(key) is not None}
        found.update(SCORES=scores, TABLE=table)
        return found

    def _vector(self, name, crs, inputs, parameters, context, feedback):
        source = self.parameterAsSource(parameters, name, context)
        layer = self.parameterAsVectorLayer(parameters, name, context)
        if not crs.isValid():
            layers.accept_local(name, layer, feedback)
        return layers.vector_file(name, layer, source, crs, inputs, context)
