#pragma once
// The particles' mass on the nodes, from sub-points that follow the material: what the depth is made of.
#include <algorithm>

#include "mpm/domain.h"
#include "mpm/stencil.h"
#include "shallow/flow.h"

namespace frana {

/// Spreads a particle's mass [kg] over the nodes of its stencil, `into` an array on the grid's storage.
template <class S>
void deposit_particle(const TileGrid& grid, double* into, const S& sx, const S& sy, double mass) {
    for (int j = 0; j < S::kNodes; ++j) {
        double* row = into + grid.at(sx.base, sy.base + j);
        const double weight = mass * sy.w[j];
        for (int i = 0; i < S::kNodes; ++i) row[i] += weight * sx.w[i];
    }
}

/// A particle's mass [kg] at its place [cells].
struct MassAt {
    double x, y, mass;
};

/// THEORY (13): calls body(sx, sy) with the stencils of the four sub-points of a domain, at +- r1/4 +- r2/4
/// (scheme.sub_point_reach). At open sides they are held inside the domain, so that no mass waits beyond the edge.
template <class S, class Body>
void for_each_sub_point(const Flow& flow, double at_x, double at_y, const Edges& r, Body&& body) {
    const double x_max = static_cast<double>(flow.grid.nx() - 1), y_max = static_cast<double>(flow.grid.ny() - 1);
    const double reach = flow.scheme.sub_point_reach;
    for (int k = 0; k < 4; ++k) {
        const double s1 = k & 1 ? reach : -reach, s2 = k & 2 ? reach : -reach;
        // Domains are held below one cell when they are split; between two such times 3/4 is out of their reach.
        double x = at_x + std::clamp(s1 * r.r1x + s2 * r.r2x, -0.75, 0.75);
        double y = at_y + std::clamp(s1 * r.r1y + s2 * r.r2y, -0.75, 0.75);
        if (!flow.walls) {
            x = std::clamp(x, 0.0, x_max);
            y = std::clamp(y, 0.0, y_max);
        }
        body(S(x), S(y));
    }
}

/// A quarter of the particle goes to each sub-point.
template <class S>
void spread_particle(const Flow& flow, double* into, const MassAt& particle, const Edges& r) {
    const double quarter = 0.25 * particle.mass;
    for_each_sub_point<S>(flow, particle.x, particle.y, r,
                          [&](const S& sx, const S& sy) { deposit_particle(flow.grid, into, sx, sy, quarter); });
}

/// Those of a point of the flow.
template <class S, class Real>
void deposit_sub_points(Flow& flow, Index p) {
    const Particles& c = flow.particles;
    spread_particle<S>(flow, flow.nodes.column_mass.data(), {c.x[p], c.y[p], c.mass[p]},
                       edges_of(c.carried<Real>(), p));
}

/// The same with quadratic shape functions, for the few points that the packed kernel does not take.
template <class Real>
void deposit_quadratic_sub_points(Flow& flow, Index p);

}  // namespace frana
