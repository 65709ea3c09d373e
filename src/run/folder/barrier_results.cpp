#include "run/folder/barrier_results.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "compare/overlap.h"
#include "io/gdal_features.h"
#include "scene/case_file.h"

namespace frana {
namespace {

/// Pixels that the polygon touches, and their eight neighbours: marks in the order of a raster.
std::vector<char> pixels_at(const Polygon& polygon, const GridGeometry& grid) {
    std::vector<char> marks(static_cast<std::size_t>(grid.size()), 0);
    Polygons one;
    one.parts = {polygon};
    for_each_pixel_area(grid, rings_of(one), [&](Index i, Index j, double area) {
        if (!(area > 0.0)) return;
        for (Index b = std::max<Index>(0, j - 1); b <= std::min(grid.ny - 1, j + 1); ++b)
            for (Index a = std::max<Index>(0, i - 1); a <= std::min(grid.nx - 1, i + 1); ++a)
                marks[static_cast<std::size_t>(b * grid.nx + a)] = 1;
    });
    return marks;
}

/// The largest, or the smallest, of the finite values at the marks; NaN without any.
double extreme_of(const ProductRaster* product, const std::vector<char>& marks, bool largest) {
    double found = Raster::nodata;
    if (product == nullptr) return found;
    for (std::size_t k = 0; k < marks.size(); ++k) {
        const double value = product->raster.values[k];
        if (!marks[k] || !std::isfinite(value)) continue;
        if (std::isnan(found) || (largest ? value > found : value < found)) found = value;
    }
    return found;
}

double force_on(const std::string& barrier, const std::vector<BarrierSummary>& summaries) {
    for (const BarrierSummary& summary : summaries)
        if (summary.name == barrier && summary.blur > 0.0) return summary.peak_force;
    return Raster::nodata;
}

using Named = std::pair<std::string, Attribute>;

/// As SQL compares names.
bool same_name(const std::string& a, const std::string& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

std::vector<Named> results_on(const Polygon& polygon, const std::string& barrier,
                              const std::vector<BarrierSummary>& summaries, const std::vector<ProductRaster>& rasters) {
    const std::vector<char> marks = pixels_at(polygon, rasters.front().raster.geometry);
    const auto extreme = [&](const char* name, bool largest) {
        return extreme_of(find_product(rasters, name), marks, largest);
    };
    const double depth = extreme("peak_depth", true);
    const bool reached = depth > 0.0;
    return {{"barrier", barrier},
            {"peak_force_N", force_on(barrier, summaries)},
            {"peak_pressure_Pa", reached ? extreme("peak_dynamic_pressure", true) : Raster::nodata},
            {"peak_depth_m", reached ? depth : Raster::nodata},
            {"hit_s", reached ? extreme("arrival_time", false) : Raster::nodata}};
}

void add_results(AttributedPolygon& polygon, const std::vector<Named>& results) {
    for (std::size_t n = 0; n < polygon.attributes.size(); ++n) {
        std::string& name = polygon.attributes[n].first;
        const auto taken = [&](const Named& other) { return &other.first != &name && same_name(other.first, name); };
        const auto is_taken = [&](const std::vector<Named>& all) { return std::any_of(all.begin(), all.end(), taken); };
        if (is_taken(results)) name += "_input";
        while (is_taken(polygon.attributes)) name += "_input";
    }
    polygon.attributes.insert(polygon.attributes.end(), results.begin(), results.end());
}

}  // namespace

std::vector<BarrierSource> barrier_sources(const CaseFile& file) {
    std::vector<BarrierSource> sources;
    for (Index i = 0; i < file.count("barrier"); ++i) {
        const std::string prefix = fmt::format("barrier.{}.", i);
        if (!file.given(prefix + "outline")) continue;
        const std::string name =
            file.given(prefix + "name") ? file.word(prefix + "name") : fmt::format("barrier_{}", i + 1);
        sources.push_back({name, file.path(prefix + "outline"), file.flag(prefix + "each")});
    }
    return sources;
}

void write_barrier_results(const std::filesystem::path& gpkg, const std::vector<BarrierSource>& sources,
                           const std::vector<BarrierSummary>& summaries, const std::vector<ProductRaster>& rasters) {
    if (sources.empty() || rasters.empty()) return;
    const std::string& crs = rasters.front().raster.crs_wkt;
    std::vector<AttributedPolygon> all;
    for (const BarrierSource& source : sources) {
        std::vector<std::string> said_by_the_scene;
        std::size_t n = 0;
        for (AttributedPolygon& polygon : read_attributed_polygons(source.outline, crs, said_by_the_scene)) {
            const std::string name = source.each ? fmt::format("{}_{}", source.name, ++n) : source.name;
            add_results(polygon, results_on(polygon.polygon, name, summaries, rasters));
            all.push_back(std::move(polygon));
        }
    }
    write_attributed_polygons(gpkg, "barriers", crs, all);
}

}  // namespace frana
