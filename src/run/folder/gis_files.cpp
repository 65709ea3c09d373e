#include "run/folder/gis_files.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "run/folder/map_project.h"
#include "run/folder/map_style.h"
#include "run/folder/results_file.h"
#include "vtk_io/figures/map_range.h"

namespace frana {
namespace {

/// The flow with a margin, or all where there is none.
std::array<double, 4> extent_of_flow(const Raster& peak_depth, double limit) {
    const auto covered = covered_extent(peak_depth.geometry, peak_depth.values, limit);
    if (!covered) return peak_depth.geometry.pixel_extent();
    const auto& e = *covered;
    const double margin = 0.05 * std::max(e[2] - e[0], e[3] - e[1]);
    return {e[0] - margin, e[1] - margin, e[2] + margin, e[3] + margin};
}

}  // namespace

void leave_gis_files(const Scene& scene, const std::filesystem::path& run_dir,
                     const std::vector<ProductRaster>& rasters, RunRecord& record) {
    const ProductRaster* peak = find_product(rasters, "peak_depth");
    if (!scene.output.geotiff || peak == nullptr) return;
    const double limit = scene.output.footprint_depth;
    try {
        write_styles(run_dir, rasters, limit);
        const std::vector<ShapeLayer> layers = result_layers(scene, rasters, record);
        write_layers(run_dir / "results.gpkg", peak->raster.crs_wkt, layers);
        write_project(run_dir, {record.title, peak->raster.crs_wkt, extent_of_flow(peak->raster, limit), limit},
                      rasters, layers);
    } catch (const UserError& error) {
        record.warnings.push_back(fmt::format("styles and shapes for a GIS were not written: {}", error.what()));
    }
}

}  // namespace frana
