"""Layers of a project as files that the program reads. What it could not read right is refused here, in one sentence."""
import os
import tempfile

from osgeo import gdal
from qgis.core import (
    QgsCoordinateReferenceSystem,
    QgsCoordinateTransform,
    QgsCoordinateTransformContext,
    QgsFeature,
    QgsFeatureRequest,
    QgsGeometry,
    QgsProject,
    QgsRasterFileWriter,
    QgsRasterPipe,
    QgsRectangle,
    QgsUnitTypes,
    QgsVectorFileWriter,
    QgsVectorLayer,
)

from .program import Trouble


def require_folder(folder):
    """Makes the folder of the results; Trouble where nothing can be written."""
    try:
        os.makedirs(folder, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise Trouble(f"OUTPUT: found {folder}, where nothing can be written ({error.strerror}); expected a folder of "
                      "yours; choose another one") from error
    return folder


def utm_zone(point):
    """(EPSG code, name) of the UTM zone of a point in degrees."""
    zone = min(max(int((point.x() + 180.0) // 6.0) + 1, 1), 60)
    south = point.y() < 0.0
    return f"EPSG:{(32700 if south else 32600) + zone}", f"UTM zone {zone}{'S' if south else 'N'}"


def _zone_of(extent, crs):
    to_degrees = QgsCoordinateTransform(crs, QgsCoordinateReferenceSystem("EPSG:4326"), QgsCoordinateTransformContext())
    return utm_zone(to_degrees.transform(extent.center()))


def _require_crs(name, layer):
    if layer.crs().isValid():
        return
    raise Trouble(f"{name}: the layer \"{layer.name()}\" has no coordinate system; expected one that is projected in "
                  "metres, such as the UTM zone of the place; right-click the layer, Layer CRS, Set Layer CRS")


def _require_saved(name, layer):
    if isinstance(layer, QgsVectorLayer) and layer.isEditable():
        raise Trouble(f"{name}: the layer \"{layer.name()}\" is being edited; expected a layer whose edits are saved; "
                      "save or discard them with the pencil of its toolbar")


def _require_metres(name, layer):
    crs = layer.crs()
    if crs.isGeographic():
        code, zone = _zone_of(layer.extent(), crs)
        raise Trouble(f"{name}: the layer \"{layer.name()}\" is in degrees ({crs.authid() or crs.description()}); "
                      f"expected metres; bring it to {zone} ({code}) with Raster > Projections > Warp")
    if crs.mapUnits() != QgsUnitTypes.DistanceMeters:
        raise Trouble(f"{name}: the layer \"{layer.name()}\" is in {QgsUnitTypes.toString(crs.mapUnits())}; expected "
                      "metres; bring it to the UTM zone of the place with Raster > Projections > Warp")


def _require_upright(name, layer, source):
    data = gdal.Open(source)
    if data is None:
        raise Trouble(f"{name}: GDAL cannot open {source}; expected a raster; export the layer to a GeoTIFF")
    corner = data.GetGeoTransform()
    if corner[2] != 0.0 or corner[4] != 0.0:
        raise Trouble(f"{name}: the raster of the layer \"{layer.name()}\" is rotated; expected rows from west to east; "
                      "write it anew with Raster > Projections > Warp")
    return data


def _written_raster(name, layer, file):
    """A layer of a database or a service as GeoTIFF."""
    provider = layer.dataProvider().clone()
    pipe = QgsRasterPipe()
    pipe.set(provider)
    writer = QgsRasterFileWriter(file)
    code = writer.writeRaster(pipe, layer.width(), layer.height(), layer.extent(), layer.crs())
    if code != QgsRasterFileWriter.NoError:
        raise Trouble(f"{name}: the layer \"{layer.name()}\" cannot be written to {file}; export it to a GeoTIFF yourself")
    return file


def _file_beside(source, name, ending, folder):
    """Where a copy of a source goes: never in the place of what it is read from, which may be an input of an earlier run."""
    file = os.path.join(folder, name.lower() + ending)
    own = os.path.basename(source.split("|")[0]) == os.path.basename(file)
    return os.path.join(folder, f"{name.lower()}_again{ending}") if own else file


def raster_file(name, layer, folder):
    """File of a raster layer, with the coordinate system that the project gives it."""
    source = layer.source()
    if layer.providerType() != "gdal":
        source = _written_raster(name, layer, os.path.join(folder, f"{name.lower()}.tif"))
    data = _require_upright(name, layer, source)
    crs = data.GetSpatialRef()
    known = QgsCoordinateReferenceSystem.fromWkt(crs.ExportToWkt()) if crs else QgsCoordinateReferenceSystem()
    if layer.crs().isValid() and known != layer.crs():
        # What the layer is told to have in QGIS the file does not know.
        file = _file_beside(source, name, ".vrt", folder)
        gdal.Translate(file, data, format="VRT", outputSRS=layer.crs().toWkt())
        return file
    return os.path.abspath(source) if os.path.exists(source) else source


def elevation_file(name, layer, folder):
    """The same for an elevation model, which has to be projected in metres."""
    _require_crs(name, layer)
    _require_metres(name, layer)
    return raster_file(name, layer, folder)


def accept_local(name, layer, feedback):
    """A layer for a run on local coordinates: those of one with a coordinate system are taken too, unless in degrees."""
    crs = layer.crs()
    if not crs.isValid():
        return
    system = crs.authid() or crs.description()
    # A GeoJSON without a system is told to be in degrees whatever its numbers are.
    if crs.isGeographic() and QgsRectangle(-360.0, -90.0, 360.0, 90.0).contains(layer.extent()):
        raise Trouble(f"{name}: the layer \"{layer.name()}\" is in degrees ({system}), and the run on local coordinates; "
                      "expected the run's metres; where its numbers are metres, take its system away with Layer CRS")
    feedback.pushWarning(f"{name}: the layer \"{layer.name()}\" has a coordinate system ({system}), and the run has none: "
                         "its numbers are taken as the run's metres")


def _plain(geometry):
    """Arcs as chords: the program reads straight edges."""
    if geometry.isNull() or not geometry.constGet().hasCurvedSegments():
        return geometry
    return QgsGeometry(geometry.constGet().segmentize())


def vector_file(name, layer, source, crs, folder, context):
    """
    Features of a layer (of those selected, where only they are asked for) as a GeoPackage in `folder`, in `crs`. So layers
    in memory, in a database and with a filter are all the same, and the folder holds what its run was made from. Without a
    `crs`, that of a run on local coordinates, places are taken as they are.
    """
    _require_saved(name, layer)
    if crs.isValid():
        _require_crs(name, layer)
    file = _file_beside(layer.source(), name, ".gpkg", folder)
    if os.path.exists(file):
        os.remove(file)
    options = QgsVectorFileWriter.SaveVectorOptions()
    options.driverName = "GPKG"
    options.layerName = name.lower()
    writer = QgsVectorFileWriter.create(file, source.fields(), source.wkbType(), crs, context.transformContext(), options)
    request = QgsFeatureRequest()
    if crs.isValid():
        request.setDestinationCrs(crs, context.transformContext())
    count = 0
    for feature in source.getFeatures(request):
        kept = QgsFeature(source.fields())
        attributes = feature.attributes()
        fid = source.fields().lookupField("fid")
        if fid >= 0:
            attributes[fid] = None  # GeoPackage's own number, which need not be unique here
        kept.setAttributes(attributes)
        kept.setGeometry(_plain(feature.geometry()))
        writer.addFeature(kept)
        count += 1
    failed = writer.hasError() != QgsVectorFileWriter.NoError
    said = writer.errorMessage()
    del writer  # closes the file
    if failed:
        raise Trouble(f"{name}: the layer \"{layer.name()}\" cannot be written to {file}: {said}")
    if count == 0:
        raise Trouble(f"{name}: the layer \"{layer.name()}\" has no features; expected polygons; draw or select one")
    return file


def require_overlap(name, source, terrain_name, terrain):
    """Trouble when nothing of a source lies on the terrain."""
    project = QgsProject.instance().transformContext()
    there = QgsCoordinateTransform(source.sourceCrs(), terrain.crs(), project)
    extent = there.transformBoundingBox(source.sourceExtent())
    if extent.isNull() or not terrain.extent().intersects(extent):
        raise Trouble(f"{name}: lies outside of {terrain_name}: {extent.toString(0)} against "
                      f"{terrain.extent().toString(0)}; expected a place on it; check both coordinate systems")
