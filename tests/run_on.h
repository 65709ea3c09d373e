#pragma once
// Runs a scene until the rule of rest ends it, and then for as long again: what did the deposit do?
#include <cmath>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "run/rest_rule.h"
#include "shallow/depth_averaged.h"

namespace frana::test {

struct RunOn {
    double rested = 0.0;  ///< when the rule ended the run [s]; 0: it did not
    double moved = 0.0;   ///< share of the mass that then went a cell or more
    double known = 0.0;   ///< share of the mass whose points are the same ones at both times
    double toe = 0.0;     ///< farthest that a node covered later lies from what was covered [cells]
};

struct Place {
    double x, y, mass;
};

inline std::vector<std::pair<std::int64_t, Place>> places(const DepthAveraged& simulation) {
    const Particles& c = simulation.flow().particles;
    std::vector<std::pair<std::int64_t, Place>> all;
    for (Index p = 0; p < c.count(); ++p) all.push_back({c.id[p], {c.x[p], c.y[p], c.mass[p]}});
    std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    return all;
}

/// Nodes ever deeper than `depth`.
inline std::vector<std::pair<Index, Index>> covered(Simulation& simulation, double depth) {
    const Frame frame = simulation.frame();
    const Field& peak = *frame.node("peak_depth");
    std::vector<std::pair<Index, Index>> nodes;
    for (Index k = 0; k < peak.count; ++k)
        if (peak.data[k] > depth) nodes.push_back({k % frame.grid.nx, k / frame.grid.nx});
    return nodes;
}

/// How far the farthest node of `later` lies from the nearest of `before` [cells].
inline double farthest_from(const std::vector<std::pair<Index, Index>>& before,
                            const std::vector<std::pair<Index, Index>>& later) {
    const std::set<std::pair<Index, Index>> there(before.begin(), before.end());
    double farthest = 0.0;
    for (const auto& [i, j] : later) {
        if (there.count({i, j})) continue;
        double nearest = 1e30;
        for (const auto& [m, n] : before)
            nearest = std::min(nearest, std::hypot(static_cast<double>(i - m), static_cast<double>(j - n)));
        farthest = std::max(farthest, nearest);
    }
    return farthest;
}

/// Points that were split or merged in between are not counted: `known` says how much is.
inline void compare_places(const DepthAveraged& simulation, const std::vector<std::pair<std::int64_t, Place>>& before,
                           RunOn& result) {
    const auto now = places(simulation);
    double all = 0.0;
    std::size_t n = 0;
    for (const auto& [id, place] : before) {
        all += place.mass;
        while (n < now.size() && now[n].first < id) ++n;
        if (n == now.size() || now[n].first != id) continue;
        result.known += place.mass;
        if (std::hypot(now[n].second.x - place.x, now[n].second.y - place.y) >= 1.0) result.moved += place.mass;
    }
    result.known /= all, result.moved /= all;
}

inline RunOn run_on(const Scene& scene, double latest) {
    DepthAveraged simulation(scene);
    RestRule rest(scene.bed.geometry.cell, scene.rest_fraction);
    RunOn result;
    do {
        simulation.advance(latest);
        rest.note(simulation);
    } while (simulation.status().time < latest && !rest.at_rest());
    if (!rest.at_rest()) return result;
    result.rested = simulation.status().time;
    const auto before = places(simulation);
    const auto deposit = covered(simulation, scene.output.footprint_depth);
    while (simulation.status().time < 2.0 * result.rested) simulation.advance(2.0 * result.rested);
    compare_places(simulation, before, result);
    result.toe = farthest_from(deposit, covered(simulation, scene.output.footprint_depth));
    return result;
}

}  // namespace frana::test
