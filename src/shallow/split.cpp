#include "shallow/split.h"

#include <algorithm>
#include <cmath>

#include "mpm/stencil.h"

namespace frana {

/// THEORY, section 11. A point that takes up bed gains mass, not width. Alone in its front it would gather all that
/// lies on its way, and one point cannot spread. It becomes as wide as its mass is at the depth around it, and splits.
template <class Real>
void Splitter::widen_grown(Flow& flow) const {
    constexpr double kCrowded = 4.0;  // at margins the depth at a point is a half or a quarter of its own
    const double longest = (flow.scheme.split ? 2.0 : 1.0) * std::max(1.0, flow.scheme.split_length);
    const Particles& c = flow.particles;
    Carried<Real>& held = flow.particles.carried<Real>();
    for_each_tile(flow.active, [&](Index n) {
        std::uint8_t& quiet = flow.active.quiet[flow.active.tile[n]];
        if (quiet >= kAsleep) return;
        for (Index p = flow.active.begin[n]; p < flow.active.begin[n + 1]; ++p) {
            if (!(c.mass[p] > grown_mass_) || !(held.depth[p] > flow.dry_depth())) continue;
            const Edges e = edges_of(held, p);
            const double area = std::abs(e.area()), fills = c.mass[p] / (flow.density * flow.area * held.depth[p]);
            if (!(area > 0.0) || fills <= kCrowded * area) continue;
            const double wider =
                std::min(std::sqrt(fills / area), longest / std::sqrt(std::max(e.length1_2(), e.length2_2())));
            if (!(wider > 1.0)) continue;
            set_edges(held, p, {wider * e.r1x, wider * e.r1y, wider * e.r2x, wider * e.r2y});
            quiet = 0;
        }
    });
}

namespace {

double most_of_itself(Shape shape) {
    return shape == Shape::linear  ? Linear::kMostOfItself
           : shape == Shape::cubic ? Cubic::kMostOfItself
                                   : Quadratic::kMostOfItself;
}

}  // namespace

Index Splitter::split(Flow& flow) {
    constexpr double kOff = 1e-9;  // [cells]
    const Scheme& scheme = flow.scheme;
    const HalvingRules rules{scheme.split_length, least_mass_, scheme.split, scheme.reset_domains,
                             scheme.shape == Shape::linear ? kOff : 0.0};
    return flow.particles.with_real([&](auto real) {
        if (std::isfinite(grown_mass_)) widen_grown<decltype(real)>(flow);
        auto& held = flow.particles.carried<decltype(real)>();
        const double own = most_of_itself(scheme.shape) / (flow.density * flow.area);
        return halve_points(
            flow.grid, flow.active, rules, flow.particles, held, halves_, [](Index) { return true; },
            [&](Index p) { return held.depth[p] <= own * flow.particles.mass[p]; });
    });
}

}  // namespace frana
