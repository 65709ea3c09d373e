// Surveyed extents and deposits: what a run is compared with.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "base/error.h"
#include "base/layer_name.h"
#include "base/shell_word.h"
#include "io/gdal_crs.h"
#include "io/gdal_onto.h"
#include "io/gdal_reader.h"
#include "io/gdal_shapes.h"
#include "io/gdal_transformation.h"

namespace frana {
namespace {

namespace fs = std::filesystem;
using gdal::Geometry;

constexpr const char* what_it_is =
    "a surveyed extent, as polygons in a vector file (GeoJSON, GeoPackage, Shapefile, ...) or as a raster above 0";

/// The grid with as many rows and columns added around it as it takes to cover [xmin, ymin, xmax, ymax].
GridGeometry widened(const GridGeometry& grid, const std::array<double, 4>& extent) {
    const auto has = grid.pixel_extent();
    const auto extra = [&](double by) {
        constexpr double round_off = 1e-6;  // of a cell: edges that are meant to coincide
        constexpr double most = 1e8;        // more than anyone has memory for, and a product that is still a number
        const double cells = std::ceil(by / grid.cell - round_off);
        return cells > 0.0 ? static_cast<Index>(std::min(cells, most)) : Index{0};
    };
    const Index left = extra(has[0] - extent[0]), low = extra(has[1] - extent[1]);
    GridGeometry wide = grid;
    wide.nx += left + extra(extent[2] - has[2]);
    wide.ny += low + extra(extent[3] - has[3]);
    wide.x0 -= static_cast<double>(left) * grid.cell;
    wide.y0 -= static_cast<double>(low) * grid.cell;
    return wide;
}

bool opens_as(const fs::path& file, unsigned kind) {
    gdal::register_drivers();
    const gdal::Messages quiet;
    const gdal::Dataset dataset(GDALDataset::Open(file.c_str(), kind | GDAL_OF_READONLY));
    return dataset && (kind == GDAL_OF_RASTER || dataset->GetLayerCount() > 0);
}

[[noreturn]] void refuse_crs(const fs::path& file, const std::string& found, const OGRSpatialReference& terrain,
                             const std::string& program) {
    const char* authority = terrain.GetAuthorityName(nullptr);
    const char* code = terrain.GetAuthorityCode(nullptr);
    const std::string name = authority && code ? fmt::format("{}:{}", authority, code) : "THE_SURVEY'S_CRS";
    const std::string target = (file.parent_path() / (file.stem().string() + "_crs")).string();
    const std::string line = program == "ogr2ogr" ? fmt::format("ogr2ogr -a_srs {} {} {}", name,
                                                                shell_word(target + ".gpkg"), shell_word(file.string()))
                                                  : fmt::format("gdal_translate -a_srs {} {} {}", name,
                                                                shell_word(file.string()), shell_word(target + ".tif"));
    throw UserError(
        fmt::format("{}: {}; expected a survey that says where on the earth it lies, as the terrain does ({}); if "
                    "it has the terrain's coordinates, run: {}",
                    file.string(), found, gdal::crs_name(terrain), line));
}

bool no_crs(const OGRSpatialReference* crs) { return !crs || crs->IsEmpty() || crs->IsLocal(); }

void require_vector_crs(const LayerName& name, const OGRSpatialReference& terrain) {
    const fs::path file = name.file;
    const gdal::Dataset dataset = gdal::open(file, GDAL_OF_VECTOR);
    for (OGRLayer* layer : dataset->GetLayers()) {
        if (layer->GetFeatureCount() == 0 || layer->GetGeomType() == wkbNone) continue;
        if (!name.layer.empty() && layer->GetName() != name.layer) continue;
        const OGRSpatialReference* declared = layer->GetSpatialRef();
        if (no_crs(declared)) refuse_crs(file, "has no CRS", terrain, "ogr2ogr");
        OGREnvelope box;
        if (declared->IsGeographic() && layer->GetExtent(&box, 1) == OGRERR_NONE && !gdal::degrees_possible(box))
            refuse_crs(file,
                       fmt::format("has no CRS of its own, and its coordinates ({:.10g} {:.10g}) are not the degrees "
                                   "that its format then asks for",
                                   box.MinX, box.MinY),
                       terrain, "ogr2ogr");
    }
}

/// A mask has one number or two, and a footprint leaves something out, a mask too. Elevations are many numbers, and large
/// or everywhere. What has nodata leaves something out.
void refuse_elevations(const std::vector<double>& values, const fs::path& file, std::vector<std::string>& log) {
    constexpr double kLarge = 100.0;  // [m]; no flow is as deep over half of its extent
    constexpr std::size_t kOfMask = 2;
    std::set<double> numbers;
    Index known = 0, above = 0, large = 0;
    for (const double value : values) {
        if (std::isnan(value)) continue;
        ++known, above += value > 0.0, large += value > kLarge;
        if (numbers.size() <= kOfMask) numbers.insert(value);
    }
    if (known < static_cast<Index>(values.size())) return;
    const double highest = *std::max_element(values.begin(), values.end(), [](double a, double b) {
        return std::isnan(b) ? false : std::isnan(a) || a < b;
    });
    if (numbers.size() > kOfMask && 2 * large > known)
        throw UserError(
            fmt::format("{}: found values of up to {:.4g}, on {:.3g} % of the pixels more than {:g}; "
                        "expected a surveyed extent, above 0 where the flow was, not elevations; name the "
                        "extent's file",
                        file.string(), highest, 100.0 * double(large) / double(known), kLarge));
    if (above == known)
        log.push_back(
            fmt::format("{}: found values above 0, up to {:.4g}, in all of its pixels; expected a surveyed "
                        "extent, above 0 where the flow was, neither elevations nor classes; check the raster",
                        file.string(), highest));
}

/// The footprint of the run that a raster is from; empty where it is none's.
fs::path footprint_of_run(const fs::path& raster) {
    std::error_code ignored;
    const fs::path of_run = raster.parent_path().parent_path() / "footprint.geojson";
    const bool of_rasters = raster.parent_path().filename() == "rasters";
    return of_rasters && fs::exists(of_run, ignored) ? of_run : fs::path();
}

/// Depths end in films that no one sees, and each counts. A mask has whole numbers, or one above 0.
void tell_films(const std::vector<double>& values, const fs::path& file, std::vector<std::string>& log) {
    constexpr double kThin = 0.1;  // [m]; what runs do not count either, unless output.footprint_depth is another
    std::set<double> fractions;
    Index above = 0, thin = 0;
    double least = INFINITY, most = 0.0;
    for (const double value : values) {
        if (!(value > 0.0)) continue;
        ++above, thin += value < kThin;
        least = std::min(least, value), most = std::max(most, value);
        if (fractions.size() < 2 && value != std::round(value)) fractions.insert(value);
    }
    if (thin == 0 || fractions.size() < 2) return;
    const fs::path footprint = footprint_of_run(file);
    log.push_back(fmt::format(
        "{}: found values from {:.2g} to {:.4g} above 0, {:.3g} % of them below {:g}, and all of them count as "
        "covered; "
        "expected a surveyed extent, since a run counts only what is deeper than output.footprint_depth; {}",
        file.string(), least, most, 100.0 * double(thin) / double(above), kThin,
        footprint.empty() ? "set thin ones to 0 (gdal_calc.py)" : "give " + footprint.string() + " instead"));
}

/// The pixels above 0 as polygons in the coordinates of the terrain.
Polygons from_mask(const fs::path& file, const std::string& crs_wkt, std::vector<std::string>& log) {
    const gdal::RasterFile raster(file, gdal::Meaning::any, log);
    gdal::Transformation transformation;
    if (!crs_wkt.empty()) {
        const OGRSpatialReference terrain = gdal::crs_from_wkt(crs_wkt);
        if (no_crs(&raster.crs())) refuse_crs(file, "has no CRS", terrain, "gdal_translate");
        if (!gdal::same_crs(raster.crs(), terrain)) {
            const gdal::Messages messages;
            transformation = gdal::transformation(raster.crs(), terrain, raster.extent());
            log.push_back(fmt::format("{}: reprojected from {} to {}", raster.name(), gdal::crs_name(raster.crs()),
                                      gdal::crs_name(terrain)));
        }
    }
    const PixelAxis &x = raster.x_axis(), &y = raster.y_axis();
    const std::vector<double> values = raster.read(0, 0, x.count, y.count);
    refuse_elevations(values, file, log);
    tell_films(values, file, log);
    std::vector<std::uint8_t> mask(values.size());
    for (std::size_t k = 0; k < values.size(); ++k) mask[k] = values[k] > 0.0;
    Polygons polygons;
    for (const auto& outline : gdal::outlines_of(mask, x.count, y.count, {x.start, x.size, 0, y.start, 0, y.size})) {
        const gdal::Messages messages;
        if (transformation && outline->transform(transformation.get()) != OGRERR_NONE)
            throw UserError(
                fmt::format("{}: cannot be brought to the terrain's CRS ({}); check its coordinates and "
                            "its CRS",
                            file.string(), messages.reason("no reason given")));
        gdal::append_polygon(*outline, file.string(), polygons.parts);
    }
    if (polygons.parts.empty())
        throw UserError(fmt::format("{}: has no pixel above 0; expected {}; check the values with gdalinfo -stats",
                                    file.string(), what_it_is));
    return polygons;
}

std::unique_ptr<OGRMultiPolygon> to_ogr(const Polygons& polygons) {
    auto all = std::make_unique<OGRMultiPolygon>();
    for (const Polygon& part : polygons.parts) {
        OGRPolygon polygon;
        for (const auto& ring : part.rings) {
            OGRLinearRing line;
            for (const Vec2& v : ring) line.addPoint(v.x(), v.y());
            line.closeRings();
            polygon.addRing(&line);
        }
        all->addGeometry(&polygon);
    }
    return all;
}

/// Polygons that overlap or share sides become one, since a side within the whole is no outline of it. Where none does all
/// stay as they are, to the last digit.
void unite(Polygons& polygons, const fs::path& file, std::vector<std::string>& log) {
    if (polygons.parts.size() < 2) return;
    const std::unique_ptr<OGRMultiPolygon> all = to_ogr(polygons);
    const gdal::Messages messages;
    const Geometry united(all->UnionCascaded());
    if (!united)
        throw UserError(
            fmt::format("{}: its polygons cannot be united ({}); expected outlines that do not cross "
                        "themselves; draw them again",
                        file.string(), messages.reason("no reason given")));
    double area = 0.0;
    gdal::Census census;
    std::vector<Polygon> parts;
    gdal::collect_polygons(*united, census, [&](const OGRPolygon& polygon) {
        area += polygon.get_Area();
        gdal::append_polygon(polygon, file.string(), parts);
    });
    const double twice = all->get_Area() - area;
    constexpr double round_off = 1e-9;
    const bool overlap = twice > round_off * area;
    if (!overlap && parts.size() >= polygons.parts.size()) return;
    log.push_back(overlap ? fmt::format("{}: its polygons overlap by {:.6g} m2, which count once",
                                        file.filename().string(), twice)
                          : fmt::format("{}: {} polygons, some of which share sides, become {}",
                                        file.filename().string(), polygons.parts.size(), parts.size()));
    polygons.parts = std::move(parts);
}

[[noreturn]] void refuse_elsewhere(const fs::path& file, const std::array<double, 4>& covers,
                                   const std::array<double, 4>& extent) {
    throw UserError(
        fmt::format("{}: covers {} on the terrain's map, which does not touch the terrain's {}; expected "
                    "a survey of this place; check its coordinates and its CRS",
                    file.string(), gdal::extent_text(covers), gdal::extent_text(extent)));
}

void require_overlap(const Polygons& polygons, const std::array<double, 4>& extent, const fs::path& file) {
    const std::unique_ptr<OGRMultiPolygon> all = to_ogr(polygons);
    OGRLinearRing edge;
    for (const auto& [i, j] : {std::pair{0, 1}, {2, 1}, {2, 3}, {0, 3}})
        edge.addPoint(extent[std::size_t(i)], extent[std::size_t(j)]);
    edge.closeRings();
    OGRPolygon terrain;
    terrain.addRing(&edge);
    if (all->Intersects(&terrain)) return;
    OGREnvelope box;
    all->getEnvelope(&box);
    refuse_elsewhere(file, {box.MinX, box.MinY, box.MaxX, box.MaxY}, extent);
}

}  // namespace

Polygons GdalReader::read_survey(const fs::path& file, const std::array<double, 4>& extent, const std::string& crs_wkt,
                                 std::vector<std::string>& log) const {
    const LayerName name = split_layer(file.string());
    const bool vector = opens_as(name.file, GDAL_OF_VECTOR);
    if (!vector && !opens_as(file, GDAL_OF_RASTER)) {
        std::error_code ignored;
        throw UserError(
            fmt::format("{}: {}; expected {}; {}", file.string(),
                        fs::exists(name.file, ignored) ? "cannot be read" : "no such file", what_it_is,
                        fs::exists(name.file, ignored) ? "export it again from your GIS" : "correct the name"));
    }
    if (vector && !crs_wkt.empty()) require_vector_crs(name, gdal::crs_from_wkt(crs_wkt));
    Polygons polygons = vector ? read_polygons(file, crs_wkt, log) : from_mask(file, crs_wkt, log);
    if (vector) unite(polygons, file, log);
    polygons.crs_wkt = crs_wkt;
    polygons.source = file.string();
    require_overlap(polygons, extent, file);
    return polygons;
}

Raster GdalReader::read_deposit(const fs::path& file, const GridGeometry& grid, const std::string& crs_wkt,
                                std::vector<std::string>& log) const {
    std::vector<std::string> said_again_below;
    const gdal::RasterFile raster(file, gdal::Meaning::any, said_again_below);
    gdal::require_metre_values({file, &raster.crs(), {}, raster.unit(), raster.scaled()});
    std::array<double, 4> extent = raster.extent();
    if (!crs_wkt.empty()) {
        const OGRSpatialReference terrain = gdal::crs_from_wkt(crs_wkt);
        if (no_crs(&raster.crs())) refuse_crs(file, "has no CRS", terrain, "gdal_translate");
        if (!gdal::same_crs(raster.crs(), terrain)) {
            const gdal::Messages messages;
            const gdal::Transformation forth = gdal::transformation(raster.crs(), terrain, extent);
            const std::array<double, 4> e = extent;
            constexpr int points = 21;  // along each edge, which need not stay straight
            if (!forth ||
                !forth->TransformBounds(e[0], e[1], e[2], e[3], &extent[0], &extent[1], &extent[2], &extent[3], points))
                throw UserError(
                    fmt::format("{}: cannot be brought to the terrain's CRS ({}); reproject it with "
                                "gdalwarp",
                                file.string(), messages.reason("no transformation known")));
        }
    }
    const auto has = grid.pixel_extent();
    if (!(extent[0] < has[2] && extent[2] > has[0] && extent[1] < has[3] && extent[3] > has[1]))
        refuse_elsewhere(file, extent, has);
    const GridGeometry wide = widened(grid, extent);
    constexpr Index most = 400'000'000;  // nodes, of 8 bytes each
    if (wide.size() > most)
        throw UserError(
            fmt::format("{}: reaches so far that {} x {} pixels of {:g} m would be needed; expected a "
                        "survey near the terrain; cut it with gdalwarp -te",
                        file.string(), wide.nx, wide.ny, wide.cell));
    Raster deposit = read_onto(file, wide, crs_wkt, log);
    deposit.source = file.string();
    return deposit;
}

}  // namespace frana
