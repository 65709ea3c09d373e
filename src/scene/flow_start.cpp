#include "scene/flow_start.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

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

/// Of inflows and late releases, the one that comes first in front.
std::vector<Vec2> middles_in_time(const Scene& scene) {
    std::vector<std::pair<double, Vec2>> all;
    for (const Inflow& inflow : scene.inflows)
        if (const double begin = begin_of(inflow); std::isfinite(begin)) all.emplace_back(begin, middle_of(inflow));
    for (const LateRelease& late : scene.late)
        if (late.at && late.seeds.count() > 0) all.emplace_back(*late.at, middle_of(late.seeds));
    std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<Vec2> middles;
    middles.reserve(all.size());
    for (const auto& [begin, middle] : all) middles.push_back(middle);
    return middles;
}

}  // namespace

std::vector<Vec2> starts_of_what_comes_in(const Scene& scene) {
    std::vector<Vec2> starts;
    if (scene.particles.count() == 0)
        if (const std::optional<Vec2> lake = middle_of_lake(scene)) starts.push_back(*lake);
    for (const Vec2& middle : middles_in_time(scene)) starts.push_back(middle);
    return starts;
}

std::optional<Vec2> flow_start(const Scene& scene) {
    if (scene.particles.count() > 0) return middle_of(scene.particles);
    const std::vector<Vec2> starts = starts_of_what_comes_in(scene);
    return starts.empty() ? std::nullopt : std::optional<Vec2>(starts.front());
}

std::string front_origin(const Scene& scene) {
    const bool lies = scene.particles.count() > 0 || middle_of_lake(scene);
    const std::size_t places = (lies ? 1 : 0) + middles_in_time(scene).size();
    std::string origin = middle_of_lake(scene)    ? "the centre of the water at the start"
                         : lies                   ? "the release's centre"
                         : !scene.inflows.empty() ? "the middle of inflow " + scene.inflows.front().name
                         : scene.late.empty()     ? "the terrain's middle"
                                                  : "the centre of what is released later";
    return places > 1 ? origin + ", of all that comes in anywhere" : origin;
}

}  // namespace frana
