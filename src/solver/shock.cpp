#include "solver/shock.h"

#include <algorithm>

namespace frana {
namespace {

struct Face { double flux = 0.0, sensor = 0.0; };

/// Face between k and k + step; u is the velocity component along it, two numbers a node.
Face face(const Flow& flow, const double* u, Index k, Index step) {
    const Nodes& nodes = flow.nodes;
    const Scheme& scheme = flow.scheme;
    const auto known = [&](Index n) { return (nodes.flags[n] & (kWet | kMoving)) == (kWet | kMoving); };
    const Index s = 2 * step;
    const double d = u[2 * k + s] - u[2 * k];
    if (!(d < 0.0) || !known(k + step)) return {};
    const double left = known(k - step) ? (u[2 * k] - u[2 * k - s]) / d : 1.0;
    const double right = known(k + 2 * step) ? (u[2 * k + 2 * s] - u[2 * k + s]) / d : 1.0;
    const double smooth = std::max(0.0, std::min({0.5 * (left + right), 2.0 * left, 2.0 * right, 1.0}));
    const double a = nodes.depth[k], b = nodes.depth[k + step], h = 2.0 * a * b / (a + b);
    const double c = std::sqrt(flow.gravity * h);
    const double gate =
        scheme.shock_gate > 0.0 ? std::clamp(2.0 + d / (scheme.shock_gate * c), 0.0, 1.0) : 1.0;
    // A velocity that is linear over three faces is no bore, however thin and fast the flow.
    const double linear = std::clamp((smooth - 0.8) / 0.15, 0.0, 1.0);
    const double e = -d * (1.0 - smooth * (gate + (1.0 - gate) * linear)), kap = scheme.shock_sensor;
    return {h * e * (scheme.viscosity_linear * c + scheme.viscosity_quadratic * e),
            kap > 0.0 ? std::clamp((e - kap * c) / (kap * c), 0.0, 1.0) : 0.0};
}

}  // namespace

void shock_pass(Flow& flow) {
    if (!has_viscosity(flow.scheme)) return;
    Nodes& nodes = flow.nodes;
    const double* u = &nodes.before[0].x;
    const double* v = &nodes.before[0].y;
    const Index up = flow.grid.stride();
    for_each_work_tile(flow.active, [&](Index, Index tile) {
        for_each_node_of(flow.grid, tile, [&](Index k, Index, Index) {
            nodes.viscous_flux[k] = {0.0, 0.0};
            nodes.shock[k] = {0.0, 0.0};
            if ((nodes.flags[k] & (kWet | kMoving)) != (kWet | kMoving)) return;
            const Face x = face(flow, u, k, 1), y = face(flow, v, k, up);
            nodes.viscous_flux[k] = {x.flux, y.flux};
            nodes.shock[k] = {x.sensor, y.sensor};
        });
    });
}

}  // namespace frana
