import os

from qgis.core import (
    QgsProcessing,
    QgsProcessingParameterFeatureSource,
    QgsProcessingParameterField,
    QgsProcessingParameterRasterLayer,
    QgsProcessingParameterString,
)

from . import case_text, layers, program, settings, widgets
from .base import existing
from .run_base import RunAlgorithm
from .staged import Inputs

# Keys that have a widget of their own, and those behind "Advanced". The rest of the table goes by SET.
_FRONT = {"DEPTH": "release.depth", "LAW": "material.bed.law", "MU": "material.bed.mu", "XI": "material.bed.xi",
          "END": "time.end"}
_ADVANCED = {"THICKNESS": "release.thickness", "KIND": "case.kind", "DENSITY": "material.density", "CELL": "grid.cell",
             "PER_CELL": "particles.per_cell", "STOP_AT_REST": "time.stop_at_rest", "EVERY": "output.every"}
_START = {"LAW": "voellmy", "STOP_AT_REST": True, "END": 300.0}  # what a case has no default for, or another one


def _bed_keys(keys):
    """Numbers of the bed's laws beside those in front: MANNING_N, VISCOSITY, ..."""
    return {entry["key"].rsplit(".", 1)[1].upper(): key for key, entry in keys.items()
            if entry["table"] == "material.bed" and entry["kind"] == "number_or_path" and key not in _FRONT.values()}


class Run(RunAlgorithm):
    NAME = "run"
    TITLE = "Run"
    HELP = ("Runs a landslide from an elevation model and an outline of what lets go.\n\n"
            "The depth is a number or a field of the release layer. Friction parameters are yours to choose: see "
            "cases/PARAMETERS.md of frana for those in use and their sources. Each parameter's help says its key in a case "
            "file; keys without a field here go into \"Other keys\", such as material.bed.mu=\"/path/mu.tif\".\n\n"
            "Cancel ends the run with what it has; Run case file goes on with it.")

    def initAlgorithm(self, config=None):
        self.addParameter(QgsProcessingParameterRasterLayer("DEM", "Elevation model, projected in metres"))
        self.addParameter(QgsProcessingParameterFeatureSource("RELEASE", "Release, polygons",
                                                              [QgsProcessing.TypeVectorPolygon]))
        self._keys = self._table()
        self._add_keys(_FRONT, False)
        self.addParameter(QgsProcessingParameterField(
            "DEPTH_FIELD", "Field of the release with its depth [m], instead of the number", None, "RELEASE",
            QgsProcessingParameterField.Numeric, False, True))
        self.addParameter(QgsProcessingParameterString("TITLE", "Title of the run", "", False, True))
        self._add_keys(_ADVANCED, True)
        self._add_keys(_bed_keys(self._keys), True)
        self.add_output()

    @staticmethod
    def _table():
        """Without a program the algorithm is listed all the same; canExecute() says what is missing."""
        try:
            return program.keys(settings.frana())
        except program.Trouble:
            return {}

    def _add_keys(self, names, advanced):
        for name, key in names.items():
            if key in self._keys:
                self.addParameter(widgets.widget(name, self._keys[key], advanced, _START.get(name)))

    def prepare(self, parameters, context, feedback):
        terrain = self.parameterAsRasterLayer(parameters, "DEM", context)
        source = self.parameterAsSource(parameters, "RELEASE", context)
        release = self.parameterAsVectorLayer(parameters, "RELEASE", context)
        self._more = case_text.sets(self.parameterAsString(parameters, "SET", context))
        super().prepare(parameters, context, feedback)
        folder = self._folder
        if existing(folder, "case.toml") and not self.parameterAsBool(parameters, "OVERWRITE", context):
            raise program.Trouble(f"OUTPUT: found an earlier run in {folder}; expected a folder without; choose another one, "
                                  "or tick \"Replace an earlier run\" (OVERWRITE)")
        self._inputs = Inputs(folder)
        try:
            dem = layers.elevation_file("DEM", terrain, self._inputs.path)
            outline = layers.vector_file("RELEASE", release, source, terrain.crs(), self._inputs.path, context)
            layers.require_overlap("RELEASE", source, "DEM", terrain)
            self._values = self._case(dem, outline, parameters, context)
        except BaseException:
            self._inputs.drop()
            raise

    def work(self, parameters, context, feedback):
        try:
            if self._inputs.replaces():  # an earlier run keeps its own until the new ones are known to be right
                stopped = self.call(["check", self._written(self._values), *self._more], feedback).stopped
                if stopped or feedback.isCanceled():
                    raise program.Trouble("canceled before the run began; the earlier run keeps its inputs")
            files = {key: self._inputs.place(self._values[key]) for key in ("terrain.dem", "release.outline")}
            self._written({**self._values, **files})
            self._inputs.accept()
        finally:
            self._inputs.drop()
        more = self._more + self.threads(parameters, context) + self.ticked(parameters, context, "OVERWRITE")
        return self.run_case(os.path.join(self._inputs.final, "case.toml"), more, parameters, context, feedback)

    def _written(self, values):
        """The case as a file among the inputs."""
        path = os.path.join(self._inputs.path, "case.toml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(case_text.text(values))
        return path

    def _case(self, dem, outline, parameters, context):
        """Keys of the case in the order of a case file."""
        title = self.parameterAsString(parameters, "TITLE", context)
        values = {"case.title": title or os.path.basename(self._folder),
                  "terrain.dem": dem, "release.outline": outline}
        if self.given(parameters, "DEPTH_FIELD"):
            values["release.depth"] = "field:" + self.parameterAsString(parameters, "DEPTH_FIELD", context)
        law = self.parameterAsEnumString(parameters, "LAW", context)
        for name, key in {**_FRONT, **_ADVANCED, **_bed_keys(self._keys)}.items():
            entry = self._keys[key]
            value = self._value(name, entry, parameters, context)
            of_other_law = entry.get("switch") == "material.bed.law" and law not in entry["used_by"]
            # Defaults stay the program's: given, they would stand against a key of SET that goes in their place.
            if value is not None and value != entry.get("default") and key not in values and not of_other_law:
                values[key] = value
        return values

    def _value(self, name, entry, parameters, context):
        """What was given, or the widget's default; None: the program's own default."""
        if entry["kind"] == "choice":
            return self.parameterAsEnumString(parameters, name, context) or None
        if entry["kind"] == "flag":
            return self.parameterAsBool(parameters, name, context)
        if not self.given(parameters, name) and self.parameterDefinition(name).defaultValue() is None:
            return None
        if entry["kind"] == "integer":
            return self.parameterAsInt(parameters, name, context)
        return self.parameterAsDouble(parameters, name, context)
