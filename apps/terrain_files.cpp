#include "terrain_files.h"

#include <cpl_error.h>
#include <fmt/core.h>
#include <gdal_priv.h>

#include <memory>

#include "base/atomic_file.h"
#include "base/error.h"

namespace frana {
namespace {

struct CloseDataset {
    void operator()(GDALDataset* dataset) const { GDALClose(dataset); }
};

[[noreturn]] void fail(const std::filesystem::path& file) {
    throw UserError(fmt::format("{}: cannot be written ({}); check the folder and the space on the disk", file.string(),
                                CPLGetLastErrorMsg()));
}

std::string feature(const std::vector<Vec2>& ring) {
    std::string corners;
    for (std::size_t k = 0; k <= ring.size(); ++k) {
        const Vec2& corner = ring[k % ring.size()];
        corners += fmt::format("{}[{:.10g}, {:.10g}]", k ? ", " : "", corner.x(), corner.y());
    }
    return fmt::format(
        "{{\"type\": \"Feature\", \"properties\": {{}}, \"geometry\":\n"
        "{{\"type\": \"Polygon\", \"coordinates\": [[{}]]}}}}",
        corners);
}

}  // namespace

void write_made_raster(const std::filesystem::path& file, const Raster& raster) {
    GDALAllRegister();
    const GridGeometry& grid = raster.geometry;
    const int nx = static_cast<int>(grid.nx), ny = static_cast<int>(grid.ny);
    AtomicFile target(file);
    const char* options[] = {"COMPRESS=DEFLATE", "PREDICTOR=3", nullptr};
    std::unique_ptr<GDALDataset, CloseDataset> dataset(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
        target.path().c_str(), nx, ny, 1, GDT_Float64, const_cast<char**>(options)));
    if (!dataset) fail(file);
    double transform[6] = {grid.x0 - 0.5 * grid.cell, grid.cell, 0.0, grid.y_max() + 0.5 * grid.cell, 0.0, -grid.cell};
    if (dataset->SetGeoTransform(transform) != CE_None) fail(file);
    GDALRasterBand* band = dataset->GetRasterBand(1);
    band->SetNoDataValue(Raster::nodata);
    for (int row = 0; row < ny; ++row) {  // a file's first row is the northernmost
        auto* values = const_cast<double*>(&raster.values[static_cast<std::size_t>(ny - 1 - row) * grid.nx]);
        if (band->RasterIO(GF_Write, 0, row, nx, 1, values, nx, 1, GDT_Float64, 0, 0) != CE_None) fail(file);
    }
    CPLErrorReset();
    dataset.reset();  // the disk may be full only now
    if (CPLGetLastErrorType() >= CE_Failure) fail(file);
    target.commit();
}

void write_made_outline(const std::filesystem::path& file, const MadeOutline& outline) {
    std::string features = feature(outline.ring);
    for (const std::vector<Vec2>& ring : outline.others) features += ",\n" + feature(ring);
    write_text(file, fmt::format("{{\"type\": \"FeatureCollection\", \"features\": [\n{}]}}\n", features));
}

void write_scene(const MadeScene& scene, const std::filesystem::path& folder) {
    std::error_code problem;
    std::filesystem::create_directories(folder, problem);
    if (problem)
        throw UserError(fmt::format("{}: the folder cannot be made ({}); choose another with --out", folder.string(),
                                    problem.message()));
    for (const MadeRaster& made : scene.rasters) write_made_raster(folder / made.file, made.raster);
    for (const MadeOutline& made : scene.outlines) write_made_outline(folder / made.file, made);
}

}  // namespace frana
