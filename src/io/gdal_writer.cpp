#include "io/gdal_writer.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/atomic_file.h"
#include "base/error.h"
#include "io/gdal_crs.h"
#include "io/gdal_shapes.h"

namespace frana {
namespace {

constexpr float nodata = -9999.0F;

[[noreturn]] void refuse_write(const std::filesystem::path& target, const gdal::Messages& messages) {
    throw UserError(
        fmt::format("{}: cannot be written ({}); check that the folder exists, its permissions and free "
                    "space",
                    target.string(), messages.reason("no reason given")));
}

GDALDriver& driver(const char* name) {
    gdal::register_drivers();
    GDALDriver* found = GetGDALDriverManager()->GetDriverByName(name);
    expect(found != nullptr, "a driver that every GDAL has");
    return *found;
}

/// North row first, NaN as nodata.
std::vector<float> file_values(const std::filesystem::path& target, const Raster& raster) {
    const GridGeometry& g = raster.geometry;
    expect(g.nx > 0 && g.ny > 0 && Index(raster.values.size()) == g.size(), "a raster has a value for each node");
    std::vector<float> values(raster.values.size());
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i) {
            const double value = raster.at(i, g.ny - 1 - j);
            const float stored = std::isnan(value) ? nodata : float(value);
            if (!std::isfinite(stored))
                throw NumericsError(
                    fmt::format("{}: the value {} at ({:.12g}, {:.12g}) is no number that a raster "
                                "can hold",
                                target.string(), value, g.x(i), g.y(g.ny - 1 - j)));
            values[std::size_t(j * g.nx + i)] = stored;
        }
    return values;
}

/// Georeference of a dataset with the north row first.
void place(GDALDataset& dataset, const Raster& raster) {
    const GridGeometry& g = raster.geometry;
    const auto extent = g.pixel_extent();
    double transform[6] = {extent[0], g.cell, 0.0, extent[3], 0.0, -g.cell};
    dataset.SetGeoTransform(transform);
    if (raster.crs_wkt.empty()) return;
    const OGRSpatialReference crs = gdal::crs_from_wkt(raster.crs_wkt);
    dataset.SetSpatialRef(&crs);
}

/// Georeference, words and values of a raster of one band.
bool fill(GDALDataset& dataset, const Raster& raster, std::vector<float> values, const std::string& unit,
          const std::string& description, const FileTags& tags) {
    place(dataset, raster);
    for (const auto& [name, text] : tags) dataset.SetMetadataItem(name.c_str(), text.c_str());
    GDALRasterBand* band = dataset.GetRasterBand(1);
    band->SetNoDataValue(nodata);
    band->SetUnitType(unit.c_str());
    band->SetDescription(description.c_str());
    const int nx = dataset.GetRasterXSize(), ny = dataset.GetRasterYSize();
    return band->RasterIO(GF_Write, 0, 0, nx, ny, values.data(), nx, ny, GDT_Float32, 0, 0, nullptr) == CE_None;
}

/// The bytes of a cloud-optimised copy. It is made in memory: GDAL's passing files would stay in the folder when the
/// process dies.
std::string optimised(GDALDataset& dataset, const std::filesystem::path& target, const gdal::Messages& messages) {
    const std::string held = gdal::name_in_memory(target.filename().string());
    CPLStringList options;
    for (const char* option : {"COMPRESS=DEFLATE", "PREDICTOR=YES", "OVERVIEW_COMPRESS=DEFLATE",
                               "OVERVIEW_PREDICTOR=YES", "OVERVIEW_RESAMPLING=AVERAGE", "BIGTIFF=IF_SAFER"})
        options.AddString(option);
    gdal::Dataset copy(driver("COG").CreateCopy(held.c_str(), &dataset, FALSE, options.List(), nullptr, nullptr));
    copy.reset();  // whole from here on
    std::string bytes = gdal::taken_from_memory(held);
    if (bytes.empty() || messages.failed()) refuse_write(target, messages);
    return bytes;
}

/// The raster's CRS with the code of an authority, which is the only way GeoJSON can name it. Empty without one.
OGRSpatialReference coded_crs(const std::string& wkt) {
    if (wkt.empty()) return OGRSpatialReference();
    OGRSpatialReference crs = gdal::crs_from_wkt(wkt);
    if (crs.GetAuthorityCode(nullptr)) return crs;
    const gdal::Messages quiet;
    const std::unique_ptr<OGRSpatialReference, void (*)(OGRSpatialReference*)> match(
        crs.FindBestMatch(90, "EPSG", nullptr), [](OGRSpatialReference* found) {
            if (found) found->Release();
        });
    if (!match) return OGRSpatialReference();
    OGRSpatialReference named(*match);
    named.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    return named;
}

OGRSpatialReference wgs84() {
    OGRSpatialReference degrees;
    degrees.SetWellKnownGeogCS("WGS84");
    degrees.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    return degrees;
}

/// From a CRS that GeoJSON cannot name to longitude and latitude; null for one that it can, and where there is no way.
gdal::Transformation to_degrees(const std::string& wkt) {
    if (wkt.empty() || !coded_crs(wkt).IsEmpty()) return {};
    const OGRSpatialReference map = gdal::crs_from_wkt(wkt), degrees = wgs84();
    const gdal::Messages quiet;
    return gdal::Transformation(OGRCreateCoordinateTransformation(&map, &degrees));
}

/// One polygon per 4-connected patch of pixels deeper than the threshold, in map coordinates, largest first.
std::vector<std::unique_ptr<OGRPolygon>> patches(const Raster& depth, double threshold) {
    gdal::register_drivers();
    std::vector<std::uint8_t> mask(depth.values.size());
    std::transform(depth.values.begin(), depth.values.end(), mask.begin(),
                   [&](double h) { return static_cast<std::uint8_t>(h > threshold); });
    const GridGeometry& g = depth.geometry;
    const auto extent = g.pixel_extent();
    return gdal::outlines_of(mask, g.nx, g.ny, {extent[0], g.cell, 0.0, extent[1], 0.0, g.cell});
}

using Attributes = std::map<std::string, double>;

/// Outlines of a raster's pixels deeper than `threshold`, and what each of them has besides its area.
struct OutlinesOf {
    double threshold;
    Attributes attributes;  ///< the same names at each threshold
};

OGRLayer* outline_layer(GDALDataset& dataset, const std::string& name, OGRSpatialReference crs, bool degrees,
                        const Attributes& attributes) {
    // 1e-9 m, of the order of a map coordinate's round-off: shared edges stay shared, numbers stay short. 1e-12 degrees
    // are 1e-7 m.
    const char* const options[] = {"RFC7946=NO", degrees ? "COORDINATE_PRECISION=12" : "COORDINATE_PRECISION=9",
                                   "SIGNIFICANT_FIGURES=15", nullptr};
    OGRLayer* layer =
        dataset.CreateLayer(name.c_str(), crs.IsEmpty() ? nullptr : &crs, wkbPolygon, const_cast<char**>(options));
    if (!layer) return nullptr;
    OGRFieldDefn area("area_m2", OFTReal);
    layer->CreateField(&area);
    for (const auto& [key, value] : attributes) {
        OGRFieldDefn field(key.c_str(), OFTReal);
        layer->CreateField(&field);
    }
    return layer;
}

/// Where GDAL complains it stops: the caller sees that.
void write_features(GDALDataset& dataset, const std::string& name, const Raster& depth,
                    const std::vector<OutlinesOf>& levels) {
    const gdal::Transformation transformation = to_degrees(depth.crs_wkt);
    const OGRSpatialReference crs = transformation ? wgs84() : coded_crs(depth.crs_wkt);
    const double pixel_area = depth.geometry.cell * depth.geometry.cell;
    OGRLayer* layer = outline_layer(dataset, name, crs, transformation != nullptr, levels.front().attributes);
    if (!layer) return;
    for (const OutlinesOf& level : levels)
        for (const auto& outline : patches(depth, level.threshold)) {
            const OGRFeatureUniquePtr feature(OGRFeature::CreateFeature(layer->GetLayerDefn()));
            // Whole pixels: free of the cancellation of large map coordinates.
            feature->SetField("area_m2", std::round(outline->get_Area() / pixel_area) * pixel_area);
            for (const auto& [key, value] : level.attributes) feature->SetField(key.c_str(), value);
            if (transformation && outline->transform(transformation.get()) != OGRERR_NONE) return;
            feature->SetGeometry(outline.get());
            if (layer->CreateFeature(feature.get()) != OGRERR_NONE) return;
        }
}

void write_outlines(const std::filesystem::path& target, const Raster& depth, const std::vector<OutlinesOf>& levels) {
    for (const OutlinesOf& level : levels)
        for (const auto& [key, value] : level.attributes)
            if (!std::isfinite(value))
                throw NumericsError(
                    fmt::format("{}: the attribute {} is {}, no finite number", target.string(), key, value));
    AtomicFile file(target);
    const gdal::Messages messages;
    gdal::Dataset dataset(driver("GeoJSON").Create(file.path().c_str(), 0, 0, 0, GDT_Unknown, nullptr));
    if (!dataset) refuse_write(target, messages);
    write_features(*dataset, target.stem().string(), depth, levels);
    dataset.reset();
    if (messages.failed()) refuse_write(target, messages);
    file.commit();
}

/// The file next to a raster that cannot hold the names of its classes itself, in GDAL's form.
std::string class_names_xml(const std::vector<RasterClass>& classes) {
    std::string xml =
        "<PAMDataset>\n  <PAMRasterBand band=\"1\">\n    <CategoryNames>\n      <Category>none</Category>\n";
    for (const RasterClass& one : classes) {
        char* escaped = CPLEscapeString(one.name.c_str(), -1, CPLES_XML);
        xml += fmt::format("      <Category>{}</Category>\n", escaped);
        CPLFree(escaped);
    }
    return xml + "    </CategoryNames>\n  </PAMRasterBand>\n</PAMDataset>\n";
}

}  // namespace

void write_geotiff(const std::filesystem::path& target, const Raster& raster, const std::string& unit,
                   const std::string& description, const FileTags& tags) {
    std::vector<float> values = file_values(target, raster);
    const int nx = int(raster.geometry.nx), ny = int(raster.geometry.ny);
    const gdal::Messages messages;
    if (std::max(raster.geometry.nx, raster.geometry.ny) > kPlainPixels) {  // the driver only copies
        const gdal::Dataset dataset(driver("MEM").Create("", nx, ny, 1, GDT_Float32, nullptr));
        if (!dataset || !fill(*dataset, raster, std::move(values), unit, description, tags))
            refuse_write(target, messages);
        return write_text(target, optimised(*dataset, target, messages));
    }
    const char* const options[] = {"TILED=YES", "COMPRESS=DEFLATE", "PREDICTOR=3", nullptr};
    AtomicFile file(target);
    gdal::Dataset dataset(
        driver("GTiff").Create(file.path().c_str(), nx, ny, 1, GDT_Float32, const_cast<char**>(options)));
    if (!dataset) refuse_write(target, messages);
    const bool written = fill(*dataset, raster, std::move(values), unit, description, tags);
    dataset.reset();  // flushes; a full disk shows here
    if (!written || messages.failed()) refuse_write(target, messages);
    file.commit();
}

void write_class_geotiff(const std::filesystem::path& target, const GridGeometry& grid, const std::string& crs_wkt,
                         const std::vector<std::uint8_t>& numbers, const std::vector<RasterClass>& classes,
                         const std::string& description) {
    expect(Index(numbers.size()) == grid.size(), "a class of each node");
    const int nx = int(grid.nx), ny = int(grid.ny);
    std::vector<std::uint8_t> rows(numbers.size());  // north first
    for (Index j = 0; j < grid.ny; ++j)
        std::copy_n(numbers.begin() + (grid.ny - 1 - j) * grid.nx, grid.nx, rows.begin() + j * grid.nx);
    const char* const options[] = {"TILED=YES", "COMPRESS=DEFLATE", "BIGTIFF=IF_SAFER", nullptr};
    AtomicFile file(target);
    const gdal::Messages messages;
    gdal::Dataset dataset(
        driver("GTiff").Create(file.path().c_str(), nx, ny, 1, GDT_Byte, const_cast<char**>(options)));
    if (!dataset) refuse_write(target, messages);
    place(*dataset, {grid, {}, crs_wkt, ""});
    GDALRasterBand* band = dataset->GetRasterBand(1);
    GDALColorTable colours;
    const GDALColorEntry none{255, 255, 255, 0};
    colours.SetColorEntry(0, &none);
    for (std::size_t k = 0; k < classes.size(); ++k) {
        const auto& c = classes[k].colour;
        const GDALColorEntry entry{short(c[0]), short(c[1]), short(c[2]), 255};
        colours.SetColorEntry(int(k) + 1, &entry);
    }
    band->SetColorTable(&colours);
    band->SetNoDataValue(0.0);
    band->SetDescription(description.c_str());
    const CPLErr written = band->RasterIO(GF_Write, 0, 0, nx, ny, rows.data(), nx, ny, GDT_Byte, 0, 0, nullptr);
    dataset.reset();
    if (written != CE_None || messages.failed()) refuse_write(target, messages);
    const std::filesystem::path names = target.string() + ".aux.xml";
    std::error_code ignored;
    std::filesystem::remove(names, ignored);  // rather none than those of other classes
    file.commit();
    write_text(names, class_names_xml(classes));
}

FootprintPlace footprint_place(const std::string& crs_wkt) {
    if (!coded_crs(crs_wkt).IsEmpty()) return FootprintPlace::named;
    return to_degrees(crs_wkt) ? FootprintPlace::degrees : FootprintPlace::unnamed;
}

void write_footprint(const std::filesystem::path& target, const Raster& covered_depth, double threshold,
                     const std::map<std::string, double>& attributes) {
    Attributes fields = attributes;
    fields["threshold_m"] = threshold;
    write_outlines(target, covered_depth, {{threshold, fields}});
}

void write_levels(const std::filesystem::path& target, const Raster& field, const std::string& name,
                  const std::vector<double>& levels) {
    expect(!levels.empty(), "levels of which outlines are drawn");
    constexpr double kBelow = 1.0 - 1e-9;  // a value that is the level but for round-off belongs to it
    std::vector<OutlinesOf> all;
    for (const double level : levels) all.push_back({level * kBelow, {{name, level}}});
    write_outlines(target, field, all);
}

}  // namespace frana
