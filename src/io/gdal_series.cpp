#include "io/gdal_series.h"

#include <fmt/core.h>

#include <cmath>

#include "base/atomic_file.h"
#include "base/error.h"
#include "io/gdal_crs.h"
#include "io/gdal_date.h"
#include "io/gdal_shapes.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void refuse(const fs::path& file, const gdal::Messages& messages) {
    throw UserError(fmt::format("{}: cannot be written ({}); check the folder, its permissions and free space",
                                file.string(), messages.reason("no reason given")));
}

gdal::Dataset made(const fs::path& file) {
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

/// A file of that name with an empty layer. False when GDAL refuses.
bool make_file(const fs::path& file, const std::string& layer, const std::string& crs_wkt, bool lines) {
    const gdal::Dataset dataset = made(file);
    return dataset && make_layer(*dataset, layer, crs_wkt, lines);
}

/// Has `fill` add to the layer of a file, all or nothing. False when GDAL refuses.
template <class Fill>
bool fill_file(const fs::path& file, const Fill& fill) {
    const gdal::Dataset dataset(GDALDataset::Open(file.c_str(), GDAL_OF_VECTOR | GDAL_OF_UPDATE));
    OGRLayer* layer = dataset ? dataset->GetLayer(0) : nullptr;
    if (!layer || dataset->StartTransaction() != OGRERR_NONE) return false;
    if (fill(*layer) && dataset->CommitTransaction() == OGRERR_NONE) return true;
    dataset->RollbackTransaction();
    return false;
}

/// Shapes of one time, as they stand in an older file.
using Group = std::vector<OGRFeatureUniquePtr>;

bool add_group(const fs::path& file, const Group& group) {
    return fill_file(file, [&](OGRLayer& layer) {
        for (const OGRFeatureUniquePtr& old : group) {
            const OGRFeatureUniquePtr feature(OGRFeature::CreateFeature(layer.GetLayerDefn()));
            if (feature->SetFrom(old.get()) != OGRERR_NONE || layer.CreateFeature(feature.get()) != OGRERR_NONE)
                return false;
        }
        return true;
    });
}

/// Adds to `file` what a layer has until `time`, and of that time where `itself`.
bool copy_until(OGRLayer& from, const fs::path& file, double time, bool itself) {
    Group group;
    const auto time_of = [](const OGRFeatureUniquePtr& feature) { return feature->GetFieldAsDouble("t_s"); };
    from.ResetReading();
    for (;;) {
        OGRFeatureUniquePtr feature(from.GetNextFeature());
        if (feature && !(itself ? time_of(feature) <= time : time_of(feature) < time)) continue;
        if (!group.empty() && (!feature || time_of(feature) != time_of(group.front()))) {
            if (!add_group(file, group)) return false;
            group.clear();
        }
        if (!feature) return true;
        group.push_back(std::move(feature));
    }
}

/// Takes from an older file what is later than `time` and, unless `itself` stays, what is of that time. What stays is
/// added to a new file, a time after another, as a run adds it. So the bytes are those of a run that made only that.
bool forget_from(const fs::path& gpkg, const std::string& crs_wkt, double time, bool itself,
                 const gdal::Messages& messages) {
    // Opened for changes, since what a killed run left half done has to be taken back.
    gdal::Dataset old(GDALDataset::Open(gpkg.c_str(), GDAL_OF_VECTOR | GDAL_OF_UPDATE));
    OGRLayer* layer = old ? old->GetLayer(0) : nullptr;
    if (!layer) return false;
    AtomicFile file(gpkg);
    const bool lines = wkbFlatten(layer->GetGeomType()) == wkbLineString;
    if (!make_file(file.path(), gpkg.stem().string(), crs_wkt, lines)) return false;
    if (!copy_until(*layer, file.path(), time, itself)) return false;
    old.reset();
    if (messages.failed()) return false;
    file.commit();
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
    const gdal::WithoutDate same_bytes;
    try {
        return forget_from(gpkg_, crs_wkt_, last_, true, messages);
    } catch (const UserError&) {
        return false;  // said by the next call, which tries it again
    }
}

template <class Fill>
void ShapeSeries::add(double time, bool lines, const Fill& fill) {
    std::error_code failure;
    fs::create_directories(gpkg_.parent_path(), failure);  // what goes wrong shows below
    gdal::register_drivers();
    const gdal::Messages messages;
    const gdal::WithoutDate same_bytes;
    if (!fs::exists(gpkg_, failure)) {
        AtomicFile file(gpkg_);
        if (!make_file(file.path(), gpkg_.stem().string(), crs_wkt_, lines) || messages.failed())
            refuse(gpkg_, messages);
        file.commit();
    } else if (has_later_ || !begun_) {
        if (!forget_from(gpkg_, crs_wkt_, has_later_ ? last_ : time, has_later_, messages)) refuse(gpkg_, messages);
    }
    if (!fill_file(gpkg_, [&](OGRLayer& layer) { return fill(layer) && !messages.failed(); }) || messages.failed())
        refuse(gpkg_, messages);
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
