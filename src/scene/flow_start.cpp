#include "scene/flow_start.h"

#include <algorithm>
#include <limits>

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

/// The particle nearest to the middle of all.
Vec2 middle_of(const Seeds& all) {
    const auto place = [&](std::size_t k) { return Vec2(all.x[k], all.y[k]); };
    Vec2 middle(0, 0);
    for (std::size_t k = 0; k < all.x.size(); ++k) middle += place(k) / static_cast<double>(all.count());
    std::size_t nearest = 0;
    for (std::size_t k = 1; k < all.x.size(); ++k)
        if ((place(k) - middle).squaredNorm() < (place(nearest) - middle).squaredNorm()) nearest = k;
    return place(nearest);
}

/// When the first of it comes in [s].
double begin_of(const Inflow& inflow) {
    for (std::size_t k = 0; k + 1 < inflow.time.size(); ++k)
        if (inflow.discharge[k] > 0.0 || inflow.discharge[k + 1] > 0.0) return inflow.time[k];
    return std::numeric_limits<double>::infinity();
}

/// Of inflows and late releases the one that comes first. What enters when the flow reaches it begins no flow.
std::optional<Vec2> middle_of_first(const Scene& scene) {
    double first = std::numeric_limits<double>::infinity();
    std::optional<Vec2> middle;
    for (const Inflow& inflow : scene.inflows)
        if (const double begin = begin_of(inflow); begin < first) first = begin, middle = middle_of(inflow);
    for (const LateRelease& late : scene.late)
        if (late.at && *late.at < first && late.seeds.count() > 0) first = *late.at, middle = middle_of(late.seeds);
    return middle;
}

}  // namespace

std::optional<Vec2> flow_start(const Scene& scene) {
    if (scene.particles.count() > 0) return middle_of(scene.particles);
    if (std::optional<Vec2> lake = middle_of_lake(scene)) return lake;
    return middle_of_first(scene);
}

std::optional<Vec2> start_of_what_comes_in(const Scene& scene) {
    return scene.particles.count() > 0 ? std::nullopt : flow_start(scene);
}

std::string front_origin(const Scene& scene) {
    if (middle_of_lake(scene)) return "the centre of the water at the start";
    if (scene.particles.count() > 0) return "the release's centre";
    if (!scene.inflows.empty()) return "the middle of inflow " + scene.inflows.front().name;
    return scene.late.empty() ? "the terrain's middle" : "the centre of what is released later";
}

}  // namespace frana
