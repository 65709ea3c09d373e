#include "scene/flow_start.h"

#include <algorithm>

namespace frana {
namespace {

Vec2 middle_of(const Inflow& inflow) {
    if (inflow.patches.empty()) return inflow.middle();
    Vec2 middle(0, 0);
    for (const Inflow::Patch& patch : inflow.patches) middle += patch.share * patch.at;
    const auto nearer = [&](const Inflow::Patch& a, const Inflow::Patch& b) {
        return (a.at - middle).squaredNorm() < (b.at - middle).squaredNorm();
    };
    return std::min_element(inflow.patches.begin(), inflow.patches.end(), nearer)->at;
}

/// The node of a lake nearest to its middle, weighted by depth; nothing without one.
std::optional<Vec2> middle_of_lake(const Scene& scene) {
    if (!scene.water || scene.structure || !scene.water->level) return {};
    const GridGeometry& g = scene.bed.geometry;
    const std::vector<char>& within = scene.water->lake;
    const auto depth = [&](Index k) {
        const auto n = static_cast<std::size_t>(k);
        return within.empty() || within[n] ? std::max(0.0, *scene.water->level - scene.bed.values[n]) : 0.0;
    };
    const auto place = [&](Index k) { return Vec2(g.x(k % g.nx), g.y(k / g.nx)); };
    Vec2 middle(0, 0);
    double sum = 0.0;
    for (Index k = 0; k < g.size(); ++k)
        if (const double h = depth(k); h > 0.0) middle += h * place(k), sum += h;
    if (!(sum > 0.0)) return {};
    middle /= sum;
    std::optional<Vec2> nearest;
    for (Index k = 0; k < g.size(); ++k)
        if (depth(k) > 0.0 && (!nearest || (place(k) - middle).squaredNorm() < (*nearest - middle).squaredNorm()))
            nearest = place(k);
    return nearest;
}

}  // namespace

std::optional<Vec2> flow_start(const Scene& scene) {
    Seeds all;
    for (const Seeds* seeds : scene.all_particles()) all.append(*seeds, 0, seeds->count());
    if (all.count() == 0) {
        if (const std::optional<Vec2> lake = middle_of_lake(scene)) return lake;
        return scene.inflows.empty() ? std::nullopt : std::optional<Vec2>(middle_of(scene.inflows.front()));
    }
    const auto place = [&](std::size_t k) { return Vec2(all.x[k], all.y[k]); };
    Vec2 middle(0, 0);
    for (std::size_t k = 0; k < all.x.size(); ++k) middle += place(k) / static_cast<double>(all.count());
    std::size_t nearest = 0;
    for (std::size_t k = 1; k < all.x.size(); ++k)
        if ((place(k) - middle).squaredNorm() < (place(nearest) - middle).squaredNorm()) nearest = k;
    return place(nearest);
}

std::optional<Vec2> start_of_what_comes_in(const Scene& scene) {
    return scene.particles.count() > 0 ? std::nullopt : flow_start(scene);
}

}  // namespace frana
