#include "run/folder/barrier_results.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <unordered_map>

#include "run/folder/barrier_hits.h"
#include "scene/case_file.h"

namespace frana {
namespace {

/// The largest force on a barrier [N], and the time that it is the mean over [s].
struct PeakForce {
    double force = BarrierHit::unknown, mean_over = BarrierHit::unknown;
};

/// Of those that forces are known of, by name.
std::unordered_map<std::string, PeakForce> forces_of(const std::vector<BarrierSummary>& summaries) {
    std::unordered_map<std::string, PeakForce> forces;
    for (const BarrierSummary& summary : summaries)
        if (summary.blur > 0.0) forces.emplace(summary.name, PeakForce{summary.peak_force, summary.blur});
    return forces;
}

using Named = std::pair<std::string, Attribute>;

/// As SQL compares names.
bool same_name(const std::string& a, const std::string& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

std::vector<Named> results_on(const Polygon& polygon, const std::string& barrier, const PeakForce& force,
                              const std::vector<ProductRaster>& rasters) {
    Polygons one;
    one.parts = {polygon};
    const BarrierHit hit = hit_on(one, rasters);
    std::vector<Named> results{{"barrier", barrier},
                               {"peak_force_N", force.force},
                               {"peak_force_mean_over_s", force.mean_over},
                               {"peak_dynamic_pressure_Pa", hit.pressure},
                               {"peak_depth_m", hit.depth},
                               {"hit_s", hit.time},
                               {"area_m2", hit.area}};
    for (std::size_t side = 0; side < kSides.size(); ++side) {
        results.emplace_back(fmt::format("dynamic_pressure_{}_Pa", kSides[side]), hit.side_pressure[side]);
        results.emplace_back(fmt::format("depth_{}_m", kSides[side]), hit.side_depth[side]);
    }
    return results;
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

ShapeLayer barrier_layer(const std::vector<BarrierSource>& sources, const std::vector<BarrierSummary>& summaries,
                         const std::vector<ProductRaster>& rasters) {
    ShapeLayer layer{"barriers", {}};
    if (sources.empty() || rasters.empty()) return layer;
    const std::string& crs = rasters.front().raster.crs_wkt;
    const std::unordered_map<std::string, PeakForce> forces = forces_of(summaries);
    for (const BarrierSource& source : sources) {
        std::vector<std::string> said_by_the_scene;
        std::size_t n = 0;
        for (AttributedPolygon& polygon : read_attributed_polygons(source.outline, crs, said_by_the_scene)) {
            const std::string name = source.each ? fmt::format("{}_{}", source.name, ++n) : source.name;
            const auto known = forces.find(name);
            const PeakForce force = known == forces.end() ? PeakForce{} : known->second;
            add_results(polygon, results_on(polygon.polygon, name, force, rasters));
            layer.shapes.push_back({std::move(polygon.polygon), std::move(polygon.attributes)});
        }
    }
    return layer;
}

}  // namespace frana
