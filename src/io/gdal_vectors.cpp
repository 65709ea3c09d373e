// Outlines and lines from vector files.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "base/error.h"
#include "base/layer_name.h"
#include "io/gdal_crs.h"
#include "io/gdal_features.h"
#include "io/gdal_reader.h"
#include "io/gdal_shapes.h"
#include "io/gdal_transformation.h"

namespace frana {
namespace {

using gdal::append_polygon;
using gdal::Census;
using gdal::collect_polygons;
using gdal::crs_name;
using gdal::Geometry;
using gdal::vertices;

/// A layer's geometries in the terrain's coordinates, and how they got there.
struct Source {
    std::filesystem::path file;
    std::string layer;   ///< the requested one; empty: the only one
    std::string filter;  ///< of its features; empty: all
    gdal::Dataset dataset;
    std::optional<OGRSpatialReference> terrain;  ///< nothing: unknown
    std::vector<std::string>& log;
    std::string name() const { return file.filename().string(); }
};

/// How to bring a layer's coordinates to the terrain's. Null when they are taken as they are (said in the log).
gdal::Transformation to_terrain(Source& source, OGRLayer& layer) {
    const OGRSpatialReference* declared = layer.GetSpatialRef();
    const std::string name = source.name();
    if (!declared || declared->IsEmpty() || declared->IsLocal()) {
        if (source.terrain) source.log.push_back(name + ": no CRS; coordinates are taken as the terrain's own");
        return nullptr;
    }
    // By its standard (RFC 7946) a GeoJSON without a crs member is WGS 84; local coordinates say nothing of
    // it.
    if (!source.terrain) {
        source.log.push_back(
            fmt::format("{}: coordinates are taken as the terrain's own, since the terrain has "
                        "no CRS (here {} is given)",
                        name, crs_name(*declared)));
        return nullptr;
    }
    OGREnvelope envelope;
    const bool known = layer.GetExtent(&envelope, 1) == OGRERR_NONE;
    if (declared->IsGeographic() && known && !gdal::degrees_possible(envelope)) {
        source.log.push_back(
            fmt::format("{}: coordinates are taken as the terrain's own, since they are no "
                        "degrees, which {} would ask for",
                        name, crs_name(*declared)));
        return nullptr;
    }
    if (gdal::same_crs(*declared, *source.terrain)) return nullptr;
    OGRSpatialReference from(*declared);
    from.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    const gdal::Messages messages;
    gdal::Transformation made =
        known
            ? gdal::transformation(from, *source.terrain, {envelope.MinX, envelope.MinY, envelope.MaxX, envelope.MaxY})
            : gdal::Transformation(OGRCreateCoordinateTransformation(&from, &*source.terrain));
    if (!made)
        throw UserError(
            fmt::format("{}: cannot be brought from {} to the terrain's {} ({}); reproject it with "
                        "ogr2ogr -t_srs",
                        source.file.string(), crs_name(from), crs_name(*source.terrain),
                        messages.reason("no transformation known")));
    source.log.push_back(fmt::format("{}: reprojected from {} to {}", name, crs_name(from), crs_name(*source.terrain)));
    return made;
}

Source open_source(const std::filesystem::path& file, const std::string& crs_wkt, std::vector<std::string>& log) {
    const LayerName name = split_layer(file.string());
    if (!name.rest.empty())
        throw UserError(fmt::format("{}: found \"{}\" after the layer's name; expected {}FILTER or nothing; remove it",
                                    name.file, name.rest, kFilterMark));
    Source source{name.file, name.layer, name.filter, gdal::open(name.file, GDAL_OF_VECTOR), std::nullopt, log};
    if (!crs_wkt.empty()) source.terrain = gdal::crs_from_wkt(crs_wkt);
    return source;
}

/// The layers with features that have a place. Others are tables, such as the styles that QGIS stores in a GeoPackage.
std::vector<OGRLayer*> layers_of(const Source& source) {
    const gdal::Messages quiet;
    std::vector<OGRLayer*> layers;
    for (OGRLayer* layer : source.dataset->GetLayers())
        if (layer->GetGeomType() != wkbNone && layer->GetFeatureCount() != 0) layers.push_back(layer);
    return layers;
}

std::string names_of(const std::vector<OGRLayer*>& layers) {
    std::string names;
    for (OGRLayer* layer : layers) names += fmt::format("{}\"{}\"", names.empty() ? "" : ", ", layer->GetName());
    return names;
}

/// The requested layer, or the only one; null when there is none.
OGRLayer* chosen_layer(const Source& source) {
    const std::vector<OGRLayer*> layers = layers_of(source);
    if (!source.layer.empty()) {
        for (OGRLayer* layer : layers)
            if (layer->GetName() == source.layer) return layer;
        throw UserError(fmt::format("{}: has no layer \"{}\" with features; expected {}; correct the layer's name",
                                    source.file.string(), source.layer,
                                    layers.empty() ? "one" : "one of " + names_of(layers)));
    }
    if (layers.size() > 1)
        throw UserError(fmt::format("{}: has {} layers ({}); expected one, or its name; give {}{}{}",
                                    source.file.string(), layers.size(), names_of(layers), source.name(), kLayerMark,
                                    layers.front()->GetName()));
    if (!layers.empty() && std::filesystem::is_directory(source.file) && source.file.extension() != ".gdb")
        source.log.push_back(
            fmt::format("{}: found a folder, of which the only layer \"{}\" is read; expected a file; "
                        "name it, unless this is meant",
                        source.file.string(), layers.front()->GetName()));
    return layers.empty() ? nullptr : layers.front();
}

/// The features of a filter only, such as QGIS has of a layer.
void set_filter(const Source& source, OGRLayer& layer) {
    if (source.filter.empty()) return;
    const gdal::Messages messages;
    if (layer.SetAttributeFilter(source.filter.c_str()) == OGRERR_NONE) return;
    throw UserError(
        fmt::format("{}: its filter \"{}\" cannot be used ({}); expected a condition on its attributes, such as "
                    "\"kind\" = 1; correct it, or remove {}",
                    source.file.string(), source.filter, messages.reason("no reason given"), kFilterMark));
}

/// Features that draw nothing: they may stand for an outline that was lost on the way.
void refuse_null(const Source& source, const std::vector<GIntBig>& without) {
    if (without.empty()) return;
    constexpr std::size_t most = 5;
    std::string ids;
    for (std::size_t n = 0; n < std::min(most, without.size()); ++n) ids += fmt::format(n ? ", {}" : "{}", without[n]);
    throw UserError(
        fmt::format("{}: {} feature{} ha{} no geometry (feature {}{}); expected one in each; delete them, "
                    "or draw them again",
                    source.file.string(), without.size(), without.size() == 1 ? "" : "s",
                    without.size() == 1 ? "s" : "ve", ids, without.size() > most ? ", ..." : ""));
}

/// Calls `use(feature, geometry, "feature 3")` for each geometry of the layer: flat, without curves, in terrain
/// coordinates.
void for_each_geometry(Source& source, Census& census,
                       const std::function<void(const OGRFeature&, const OGRGeometry&, const std::string&)>& use) {
    OGRLayer* layer = chosen_layer(source);
    if (!layer) return;
    set_filter(source, *layer);
    gdal::Messages messages;
    const gdal::Transformation transformation = to_terrain(source, *layer);
    std::vector<GIntBig> without;
    layer->ResetReading();
    while (const OGRFeatureUniquePtr feature{layer->GetNextFeature()}) {
        ++census.features;
        const OGRGeometry* stored = feature->GetGeometryRef();
        if (!stored || stored->IsEmpty()) {
            without.push_back(feature->GetFID());
            continue;
        }
        const std::string where = fmt::format("feature {}", feature->GetFID());
        const Geometry flat(stored->hasCurveGeometry() ? stored->getLinearGeometry() : stored->clone());
        flat->flattenTo2D();
        if (transformation && flat->transform(transformation.get()) != OGRERR_NONE)
            throw UserError(
                fmt::format("{}: {} lies where its CRS cannot be brought to the terrain's ({}); check "
                            "its coordinates and its CRS",
                            source.file.string(), where, messages.reason("no reason given")));
        use(*feature, *flat, where);
    }
    if (messages.failed())
        throw UserError(
            fmt::format("{}: cannot be read to its end ({}); the file is damaged or incomplete: copy "
                        "or export it again",
                        source.file.string(), messages.reason("")));
    refuse_null(source, without);
}

/// A valid polygon as it is; one that crosses itself repaired, with a remark.
void append_valid(const OGRPolygon& polygon, const std::string& where, Source& source, std::vector<Polygon>& parts) {
    const std::string place = fmt::format("{}: {}", source.file.string(), where);
    std::vector<Polygon> raw;
    append_polygon(polygon, place, raw);  // refuses what is not finite before GEOS sees it
    gdal::Messages messages;
    if (polygon.IsValid()) {
        parts.insert(parts.end(), raw.begin(), raw.end());
        return;
    }
    const std::string reason = messages.reason("it is not valid");
    const Geometry repaired(polygon.MakeValid());
    if (!repaired)
        throw UserError(
            fmt::format("{}: is not a valid polygon ({}); expected an outline that does not cross "
                        "itself; draw it again",
                        place, reason));
    Census rest;
    const std::size_t before = parts.size();
    double area = 0.0;
    collect_polygons(*repaired, rest, [&](const OGRPolygon& part) {
        area += part.get_Area();
        append_polygon(part, place, parts);
    });
    if (parts.size() == before)
        throw UserError(fmt::format("{}: encloses no area ({}); expected an outline; draw it again", place, reason));
    source.log.push_back(fmt::format("{}: {} was not a valid polygon ({}); repaired, it covers {:.6g} m2",
                                     source.name(), where, reason, area));
}

void collect_lines(const OGRGeometry& geometry, Census& census, const std::string& place,
                   std::vector<Polyline>& lines) {
    const OGRwkbGeometryType type = wkbFlatten(geometry.getGeometryType());
    if (type == wkbLineString) {
        ++census.lines;
        Polyline line = vertices(*geometry.toLineString(), false, place);
        if (line.size() >= 2) lines.push_back(std::move(line));
    } else if (OGR_GT_IsSubClassOf(type, wkbGeometryCollection)) {
        for (const OGRGeometry* part : *geometry.toGeometryCollection()) collect_lines(*part, census, place, lines);
    } else {
        ++(type == wkbPoint ? census.points : census.polygons);
    }
}

[[noreturn]] void refuse_content(const Source& source, const Census& census, const char* wanted, const char* way_out) {
    const std::string of_filter = source.filter.empty() ? "" : fmt::format(" of its filter \"{}\"", source.filter);
    throw UserError(fmt::format("{}: {}{}; expected at least one {}; {}", source.file.string(),
                                census.features == 0 ? "holds no features" : "holds " + census.text() + " only",
                                of_filter, wanted, of_filter.empty() ? way_out : "correct the filter"));
}

/// The number that a feature has under `attribute`.
double value_of(const OGRFeature& feature, const std::string& attribute, const Source& source,
                const std::string& where) {
    const int field = feature.GetFieldIndex(attribute.c_str());
    if (field < 0) {
        std::string names;
        for (int n = 0; n < feature.GetFieldCount(); ++n)
            names += fmt::format("{}\"{}\"", n ? ", " : "", feature.GetFieldDefnRef(n)->GetNameRef());
        throw UserError(fmt::format("{}: has no attribute \"{}\"; expected {}; correct its name", source.file.string(),
                                    attribute, names.empty() ? "one, but there is none" : "one of " + names));
    }
    const OGRFieldType type = feature.GetFieldDefnRef(field)->GetType();
    if (type != OFTReal && type != OFTInteger && type != OFTInteger64)
        throw UserError(fmt::format("{}: its attribute \"{}\" holds {}; expected numbers; change its type",
                                    source.file.string(), attribute, OGRFieldDefn::GetFieldTypeName(type)));
    const double value = feature.IsFieldSetAndNotNull(field) ? feature.GetFieldAsDouble(field) : NAN;
    if (!std::isfinite(value))
        throw UserError(fmt::format("{}: {} has no \"{}\"; expected a number for each feature; fill it in",
                                    source.file.string(), where, attribute));
    return value;
}

/// All polygons; with an attribute, a value for each.
ValuedPolygons polygons_of(const std::filesystem::path& file, const std::string& attribute, const std::string& crs_wkt,
                           std::vector<std::string>& log) {
    Source source = open_source(file, crs_wkt, log);
    ValuedPolygons valued;
    Polygons& polygons = valued.polygons;
    polygons.crs_wkt = crs_wkt;
    polygons.source = file.string();
    Census census;
    const auto use = [&](const OGRFeature& feature, const OGRGeometry& geometry, const std::string& where) {
        collect_polygons(geometry, census,
                         [&](const OGRPolygon& polygon) { append_valid(polygon, where, source, polygons.parts); });
        if (attribute.empty() || polygons.parts.size() == valued.values.size()) return;
        valued.values.resize(polygons.parts.size(), value_of(feature, attribute, source, where));
    };
    for_each_geometry(source, census, use);
    if (polygons.parts.empty())
        refuse_content(source, census, "polygon", "draw the outline as a polygon and export it again");
    if (census.points + census.lines > 0)
        log.push_back(fmt::format("{}: only polygons are used; it holds {}", source.name(), census.text()));
    return valued;
}

/// What a feature has besides its geometry.
std::vector<std::pair<std::string, Attribute>> attributes_of(const OGRFeature& feature) {
    std::vector<std::pair<std::string, Attribute>> attributes;
    for (int n = 0; n < feature.GetFieldCount(); ++n) {
        if (!feature.IsFieldSetAndNotNull(n)) continue;
        const OGRFieldDefn& field = *feature.GetFieldDefnRef(n);
        const OGRFieldType type = field.GetType();
        Attribute value = std::string(feature.GetFieldAsString(n));
        if (type == OFTReal) value = feature.GetFieldAsDouble(n);
        if (type == OFTInteger || type == OFTInteger64) value = static_cast<long long>(feature.GetFieldAsInteger64(n));
        attributes.emplace_back(field.GetNameRef(), std::move(value));
    }
    return attributes;
}

}  // namespace

std::vector<AttributedPolygon> read_attributed_polygons(const std::filesystem::path& file, const std::string& crs_wkt,
                                                        std::vector<std::string>& log) {
    Source source = open_source(file, crs_wkt, log);
    std::vector<AttributedPolygon> all;
    Census census;
    for_each_geometry(
        source, census, [&](const OGRFeature& feature, const OGRGeometry& geometry, const std::string& where) {
            std::vector<Polygon> parts;
            collect_polygons(geometry, census,
                             [&](const OGRPolygon& polygon) { append_valid(polygon, where, source, parts); });
            for (Polygon& part : parts) all.push_back({std::move(part), attributes_of(feature)});
        });
    return all;
}

Polygons GdalReader::read_polygons(const std::filesystem::path& file, const std::string& crs_wkt,
                                   std::vector<std::string>& log) const {
    return polygons_of(file, "", crs_wkt, log).polygons;
}

ValuedPolygons GdalReader::read_valued_polygons(const std::filesystem::path& file, const std::string& attribute,
                                                const std::string& crs_wkt, std::vector<std::string>& log) const {
    return polygons_of(file, attribute, crs_wkt, log);
}

std::vector<Polyline> GdalReader::read_lines(const std::filesystem::path& file, const std::string& crs_wkt,
                                             std::vector<std::string>& log) const {
    Source source = open_source(file, crs_wkt, log);
    std::vector<Polyline> lines;
    Census census;
    for_each_geometry(source, census, [&](const OGRFeature&, const OGRGeometry& geometry, const std::string& where) {
        collect_lines(geometry, census, fmt::format("{}: {}", file.string(), where), lines);
    });
    if (lines.empty()) refuse_content(source, census, "line", "draw the path as a line and export it again");
    if (census.points + census.polygons > 0)
        log.push_back(fmt::format("{}: only lines are used; it holds {}", source.name(), census.text()));
    return lines;
}

Polyline GdalReader::read_line(const std::filesystem::path& file, const std::string& crs_wkt,
                               std::vector<std::string>& log) const {
    Source source = open_source(file, crs_wkt, log);
    std::vector<Polyline> lines;
    Census census;
    for_each_geometry(source, census, [&](const OGRFeature&, const OGRGeometry& geometry, const std::string& where) {
        collect_lines(geometry, census, fmt::format("{}: {}", file.string(), where), lines);
    });
    if (lines.size() == 1) return lines.front();
    OGRLayer* layer = chosen_layer(source);
    throw UserError(
        fmt::format("{}: {} holds {}; expected one line of two points or more; draw it as one and export it again",
                    file.string(), layer ? fmt::format("layer \"{}\"", layer->GetName()) : "the file",
                    census.features == 0 ? "no features" : census.text()));
}

}  // namespace frana
