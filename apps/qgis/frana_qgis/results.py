"""Results as layers in a group of the project, with the styles that lie beside them."""
import os

from qgis.core import (
    QgsFillSymbol,
    QgsProcessingContext,
    QgsProcessingLayerPostProcessorInterface,
    QgsSingleSymbolRenderer,
    QgsVectorLayer,
)

# The first is drawn on top. Only the first raster is ticked, and the ground: the others cover the same place.
_RUN = ("footprint.geojson", "rasters/peak_depth.tif", "rasters/peak_speed.tif", "rasters/peak_dynamic_pressure.tif",
        "rasters/peak_pressure.tif", "rasters/arrival_time.tif", "rasters/lying_depth.tif", "rasters/final_depth.tif",
        "rasters/bed_change.tif", "rasters/elevation.tif")
_PLACE = "frana/place"
_TITLES = {"peak_pressure": "peak pressure on the bed"}  # which would be taken for that of an impact


class _IntoGroup(QgsProcessingLayerPostProcessorInterface):
    """Called for each layer once it stands in the project."""

    _alive = []  # QGIS does not own them

    def __init__(self, group, project, place, shown):
        super().__init__()
        self._group, self._project, self._place, self._shown = group, project, place, shown
        self._alive.append(self)

    def postProcessLayer(self, layer, context, feedback):
        style = os.path.splitext(layer.source().split("|")[0])[0] + ".qml"
        if os.path.exists(style):
            layer.loadNamedStyle(style)
        elif isinstance(layer, QgsVectorLayer):  # a filled polygon would cover the rasters
            layer.setRenderer(QgsSingleSymbolRenderer(QgsFillSymbol.createSimple({"style": "no", "outline_width": "0.4"})))
        root = self._project.layerTreeRoot()
        node = root.findLayer(layer.id())
        if node is None:
            return
        group = root.findGroup(self._group) or root.insertGroup(0, self._group)
        moved = node.clone()
        moved.setItemVisibilityChecked(self._shown)
        moved.setExpanded(self._shown)
        moved.setCustomProperty(_PLACE, self._place)  # QGIS loads them by the alphabet
        behind = [node.customProperty(_PLACE, 0) for node in group.children()]
        group.insertChildNode(sum(int(place) < self._place for place in behind), moved)
        node.parent().removeChildNode(node)
        self._alive.remove(self)


def title_of(file):
    """What a file of results is called in QGIS."""
    name = os.path.splitext(os.path.basename(file))[0]
    return _TITLES.get(name, name.replace("_", " "))


def of_run(folder):
    """Files of a run that are layers, as far as they are there."""
    found = [os.path.join(folder, *name.split("/")) for name in _RUN]
    return [file for file in found if os.path.exists(file)]


def of_maps(folder):
    """Rasters of an ensemble."""
    rasters = os.path.join(folder, "rasters")
    if not os.path.isdir(rasters):
        return []
    return [os.path.join(rasters, name) for name in sorted(os.listdir(rasters)) if name.endswith(".tif")]


def load(files, group, context):
    """Has QGIS load the files when the algorithm is over. Scripts and qgis_process, which load nothing, pass this by."""
    project = context.project()
    if project is None:
        return
    rasters = 0
    for place, file in enumerate(files):
        raster = file.endswith(".tif")
        rasters += raster
        shown = not raster or rasters == 1 or file.endswith("elevation.tif")
        name = title_of(file)
        details = QgsProcessingContext.LayerDetails(name, project, name)
        details.forceName = True
        details.setPostProcessor(_IntoGroup(group, project, place, shown))
        context.addLayerToLoadOnCompletion(file, details)
