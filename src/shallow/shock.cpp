#include "shallow/shock.h"

#include <limits>

#include "base/simd.h"

namespace frana {
namespace {

/// A face, or four.
template <class Real>
struct Face {
    Real flux{}, sensor{};
};

template <class Real>
Real from_0_to_1(Real value) {
    return max(Real{}, min(value, Real{} + 1.0));
}

/// A face with velocity jump d < 0 between depths a and b; `left`, `right`: the neighbouring jumps over d. `most`: what
/// the step can take of the speed c1 c + c2 e [m/s].
template <class Real>
Face<Real> compressed(const Flow& flow, double most, Real d, Real left, Real right, Real a, Real b) {
    const Scheme& scheme = flow.scheme;
    const Real smooth = from_0_to_1(min(0.5 * (left + right), min(2.0 * left, 2.0 * right)));
    const Real h = 2.0 * a * b / (a + b), c = sqrt(flow.gravity * h);
    const Real gate = scheme.shock_gate > 0.0 ? from_0_to_1(2.0 + d / (scheme.shock_gate * c)) : Real{} + 1.0;
    // A velocity that is linear over three faces is no bore, however thin and fast the flow.
    const Real linear = from_0_to_1((smooth - 0.8) / 0.15);
    const Real e = -d * (1.0 - smooth * (gate + (1.0 - gate) * linear)), kap_c = scheme.shock_sensor * c;
    return {h * e * min(scheme.viscosity_linear * c + scheme.viscosity_quadratic * e, Real{} + most),
            scheme.shock_sensor > 0.0 ? from_0_to_1((e - kap_c) / kap_c) : Real{}};
}

/// Face between k and k + step; u is the velocity component along it, two numbers a node.
Face<double> face(const Flow& flow, double most, const double* u, Index k, Index step) {
    const Nodes& nodes = flow.nodes;
    const auto known = [&](Index n) { return (nodes.flags[n] & (kWet | kMoving)) == (kWet | kMoving); };
    const Index s = 2 * step;
    const double d = u[2 * k + s] - u[2 * k];
    if (!(d < 0.0) || !known(k + step)) return {};
    const double left = known(k - step) ? (u[2 * k] - u[2 * k - s]) / d : 1.0;
    const double right = known(k + 2 * step) ? (u[2 * k + 2 * s] - u[2 * k + s]) / d : 1.0;
    return compressed(flow, most, d, left, right, nodes.depth[k], nodes.depth[k + step]);
}

/// Four faces whose nodes and neighbours are all known.
Face<Double4> faces(const Flow& flow, double most, const Double4* u, Index k, Index step) {
    const Double4 before = u[0], here = u[1], after = u[2], next = u[3];
    const Double4 d = after - here;
    if (!any(d < 0.0)) return {};
    const Face<Double4> f = compressed(flow, most, d, (here - before) / d, (next - after) / d,
                                       load(&flow.nodes.depth[k]), load(&flow.nodes.depth[k + step]));
    return {select(d < 0.0, f.flux, Double4{}), select(d < 0.0, f.sensor, Double4{})};
}

/// The faces of four nodes in a row inside the flow.
void shock_four(Flow& flow, double most, Index k) {
    Nodes& nodes = flow.nodes;
    const Index up = flow.grid.stride();
    const auto pairs = [&](Index n, Double4& x, Double4& y) { unzip(&nodes.before[n], x, y); };
    Double4 u[4], v[4], other;
    for (Index n = 0; n < 4; ++n) pairs(k + n - 1, u[n], other);
    for (Index n = 0; n < 4; ++n) pairs(k + (n - 1) * up, other, v[n]);
    const Face<Double4> x = faces(flow, most, u, k, 1), y = faces(flow, most, v, k, up);
    zip(x.flux, y.flux, &nodes.viscous_flux[k]);
    zip(x.sensor, y.sensor, &nodes.shock[k]);
    for (int n = 0; n < 4; ++n) nodes.sensed[k + n] = x.sensor[n] > 0.0 || y.sensor[n] > 0.0;
}

void shock_one(Flow& flow, double most, Index k) {
    Nodes& nodes = flow.nodes;
    Face<double> x, y;
    if ((nodes.flags[k] & (kWet | kMoving)) == (kWet | kMoving)) {
        x = face(flow, most, &nodes.before[0].x, k, 1);
        y = face(flow, most, &nodes.before[0].y, k, flow.grid.stride());
    }
    nodes.viscous_flux[k] = {x.flux, y.flux};
    nodes.shock[k] = {x.sensor, y.sensor};
    nodes.sensed[k] = x.sensor > 0.0 || y.sensor > 0.0;
}

}  // namespace

void shock_pass(Flow& flow, double velocity_dt) {
    if (!has_viscosity(flow.scheme)) return;
    const double most = velocity_dt > 0.0 ? 0.5 * flow.cell / velocity_dt : std::numeric_limits<double>::infinity();
    const std::uint8_t* flags = flow.nodes.flags.data();
    const Index up = flow.grid.stride();
    constexpr std::uint8_t kKnown = kWet | kMoving;
    for_each_work_run(flow.active, [&](const TileRun& run) {
        for_each_four_of_run(flow.grid, run, flow.active_nodes(), [&](Index, Index k, Index, Index) {
            const std::uint8_t* f = flags + k;
            if (eight_have(f - 2, kKnown, 0) && four_have(f - up, kKnown, 0) && four_have(f + up, kKnown, 0) &&
                four_have(f + 2 * up, kKnown, 0)) {
                shock_four(flow, most, k);
            } else {
                for (Index n = 0; n < 4; ++n) shock_one(flow, most, k + n);
            }
        });
    });
}

}  // namespace frana
