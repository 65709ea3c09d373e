#include "io/gdal_series.h"

#include <fmt/core.h>

#include <cmath>

#include "base/atomic_file.h"
#include "base/error.h"
#include "io/gdal_crs.h"
#include "io/gdal_shapes.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void refuse(const fs::path& file, const gdal::Messages& messages) {
    throw UserError(fmt::format("{}: cannot be written ({}); check the folder, its permissions and free space",
                                file.string(), messages.reason("no reason given")));
}

gdal::Dataset made(const fs::path& file) {
    gdal::register_drivers();
    GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GPKG");
    if (!driver)
        throw UserError("GeoPackage: this GDAL cannot write it; install one with SQLite, or remove gis = true");
    return gdal::Dataset(driver->Create(file.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
}

/// The layer with its attributes; null when GDAL refuses.
OGRLayer* make_layer(GDALDataset& dataset, const std::string& name, const std::string& crs_wkt, bool lines) {
    OGRSpatialReference crs;
    if (crs_wkt.empty())
        crs.SetLocalCS("local metres");  // without any the file would claim degrees
    else
        crs = gdal::crs_from_wkt(crs_wkt);
    OGRLayer* layer = dataset.CreateLayer(name.c_str(), &crs, lines ? wkbLineString : wkbPolygon, nullptr);
    if (!layer) return nullptr;
    OGRFieldDefn time("t_s", OFTReal), level("level", OFTReal), unit("unit", OFTString), area("area_m2", OFTReal);
    bool good = layer->CreateField(&time) == OGRERR_NONE;
    if (lines) good = good && layer->CreateField(&level) == OGRERR_NONE && layer->CreateField(&unit) == OGRERR_NONE;
    if (!lines) good = good && layer->CreateField(&area) == OGRERR_NONE;
    return good ? layer : nullptr;
}

/// Takes away what is later than `time` and, unless `itself` stays, what is of that time.
bool forget_from(OGRLayer& layer, double time, bool itself) {
    std::vector<GIntBig> late;
    for (const OGRFeatureUniquePtr& feature : layer) {
        const double t = feature->GetFieldAsDouble("t_s");
        if (!(itself ? t <= time : t < time)) late.push_back(feature->GetFID());
    }
    for (const GIntBig id : late)
        if (layer.DeleteFeature(id) != OGRERR_NONE) return false;
    return true;
}

}  // namespace

void ShapeSeries::serialize(Archive& archive) {
    archive.number("last", last_);
    if (!archive.loading()) return;
    begun_ = true;
    has_later_ = !forget_later();
}

/// False when the file cannot be changed.
bool ShapeSeries::forget_later() {
    std::error_code failure;
    if (!fs::exists(gpkg_, failure)) return true;
    gdal::register_drivers();
    const gdal::Messages messages;
    gdal::Dataset dataset(GDALDataset::Open(gpkg_.c_str(), GDAL_OF_VECTOR | GDAL_OF_UPDATE));
    OGRLayer* layer = dataset ? dataset->GetLayer(0) : nullptr;
    if (!layer || dataset->StartTransaction() != OGRERR_NONE) return false;
    if (!forget_from(*layer, last_, true) || dataset->CommitTransaction() != OGRERR_NONE) {
        dataset->RollbackTransaction();
        return false;
    }
    dataset.reset();
    return !messages.failed();
}

template <class Fill>
void ShapeSeries::add(double time, bool lines, const Fill& fill) {
    std::error_code failure;
    fs::create_directories(gpkg_.parent_path(), failure);  // what goes wrong shows below
    const gdal::Messages messages;
    if (!fs::exists(gpkg_, failure)) {
        AtomicFile file(gpkg_);
        gdal::Dataset dataset = made(file.path());
        if (!dataset || !make_layer(*dataset, gpkg_.stem().string(), crs_wkt_, lines)) refuse(gpkg_, messages);
        dataset.reset();
        if (messages.failed()) refuse(gpkg_, messages);
        file.commit();
    }
    gdal::Dataset dataset(GDALDataset::Open(gpkg_.c_str(), GDAL_OF_VECTOR | GDAL_OF_UPDATE));
    OGRLayer* layer = dataset ? dataset->GetLayer(0) : nullptr;
    if (!layer || dataset->StartTransaction() != OGRERR_NONE) refuse(gpkg_, messages);
    const bool clean = has_later_ ? forget_from(*layer, last_, true) : begun_ || forget_from(*layer, time, false);
    const bool good = clean && fill(*layer) && !messages.failed();
    if (!good || dataset->CommitTransaction() != OGRERR_NONE) {
        dataset->RollbackTransaction();
        refuse(gpkg_, messages);
    }
    dataset.reset();
    if (messages.failed()) refuse(gpkg_, messages);
    begun_ = true, has_later_ = false, last_ = time;
}

void ShapeSeries::add_lines(double time, const std::vector<std::pair<double, Polyline>>& level_and_line,
                            const std::string& unit) {
    for (const auto& [level, line] : level_and_line)
        for (const Vec2& p : line)
            if (!p.allFinite() || !std::isfinite(level))
                throw NumericsError(fmt::format("{}: a line at {} is no line on a map", gpkg_.string(), level));
    add(time, true, [&](OGRLayer& layer) {
        for (const auto& [level, line] : level_and_line) {
            OGRLineString shape;
            for (const Vec2& p : line) shape.addPoint(p.x(), p.y());
            shape.flattenTo2D();
            const OGRFeatureUniquePtr feature(OGRFeature::CreateFeature(layer.GetLayerDefn()));
            feature->SetField("t_s", time);
            feature->SetField("level", level);
            feature->SetField("unit", unit.c_str());
            feature->SetGeometry(&shape);
            if (layer.CreateFeature(feature.get()) != OGRERR_NONE) return false;
        }
        return true;
    });
}

void ShapeSeries::add_cells(double time, const GridGeometry& grid, std::vector<std::uint8_t>& cells) {
    expect(static_cast<Index>(cells.size()) == (grid.nx - 1) * (grid.ny - 1), "a mark for each cell of the grid");
    const auto outlines =
        gdal::outlines_of(cells, grid.nx - 1, grid.ny - 1, {grid.x0, grid.cell, 0.0, grid.y0, 0.0, grid.cell});
    add(time, false, [&](OGRLayer& layer) {
        for (const auto& outline : outlines) {
            const OGRFeatureUniquePtr feature(OGRFeature::CreateFeature(layer.GetLayerDefn()));
            const double cell = grid.cell * grid.cell;
            feature->SetField("t_s", time);
            feature->SetField("area_m2", std::round(outline->get_Area() / cell) * cell);  // whole cells
            feature->SetGeometry(outline.get());
            if (layer.CreateFeature(feature.get()) != OGRERR_NONE) return false;
        }
        return true;
    });
}

}  // namespace frana
