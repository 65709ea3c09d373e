#include "checks/bench/traffic.h"

namespace frana::bench {
namespace {

constexpr double kRead = 8.0, kWrite = 16.0;   ///< a double; an update costs the same as a write
constexpr double kNode4 = 32.0;                ///< Deposit or Motion, read
constexpr double kPlaced = 3.0, kHeld = 11.0;  ///< numbers of a point: place and mass; what it carries (Carried)

/// Share of a double that a number takes which points carry.
double held(const Flow& flow) { return flow.particles.single ? 0.5 : 1.0; }

double hessian(const Flow& flow) { return flow.bed.hxx ? 3.0 * kRead : 0.0; }
double slopes(const Flow& flow) { return flow.steep ? 2.0 * kRead : 0.0; }

Traffic deposit(const Flow& flow) {
    // Clearing, scattering, and the sums that are held against the points'.
    return {(kPlaced + kHeld * held(flow)) * kRead, 2.0 * (2.0 * kNode4 + 2.0 * kWrite) + kNode4 + kRead};
}

Traffic gather(const Flow& flow) {
    const double moved = (2.0 + 4.0 * held(flow)) * kWrite, gone = 3.0;  // place and domain
    const double replaced = 7.0 * held(flow) * kWrite;                   // v, grad v, depth
    return {moved + replaced + kRead + gone, kNode4 + 1.0};
}

/// In one sweep points deposit from the cache.
Traffic carry(const Flow& flow) { return {gather(flow).particle, gather(flow).node + deposit(flow).node}; }

Traffic grid_update(const Flow& flow) {
    const double force = flow.nodes.forced ? kNode4 : 0.0;
    const double state = 4.0 * kRead + 2.0 * kRead + 2.0 * kRead + 1.0;  // mass, h, eta, z; v; flux; flags
    return {0.0, kNode4 + kNode4 + state + force + slopes(flow) + hessian(flow)};
}

Traffic depth(const Flow&) { return {0.0, kNode4 + kRead + 2.0 * kWrite + 2.0 * kWrite + 2.0}; }

Traffic filter(const Flow&) {
    const double shock = 4.0 * kWrite + 3.0 * kRead + 1.0;
    const double along_x = 2.0 + kWrite + kRead + 1.0, along_y = kWrite + 4.0 * kRead + 2.0;
    return {0.0, shock + along_x + along_y};
}

Traffic peaks(const Flow& flow) { return {0.0, 3.0 * kRead + 5.0 * kRead + slopes(flow) + hessian(flow)}; }

/// Keys and order are numbers of four bytes.
Traffic order(const Flow&) { return {2.0 * kRead + 0.5 * (kWrite + 2.0 * kRead + kWrite), 0.0}; }

Traffic sort(const Flow& flow) {
    const double permuted = (kPlaced + kHeld * held(flow) + 1.0) * (1.5 * kRead + kWrite);  // and the id, by the order
    return {permuted, 0.0};
}

}  // namespace

Traffic traffic_of(const std::string& phase, const Flow& flow) {
    if (phase == "deposit") return deposit(flow);
    if (phase == "gather") return gather(flow);
    if (phase == "gather and deposit") return carry(flow);
    if (phase == "grid update") return grid_update(flow);
    if (phase == "depth") return depth(flow);
    if (phase == "filter") return filter(flow);
    if (phase == "shoreline") return {0.0, 6.0};  // flags, three sweeps; margins are few
    if (phase == "peaks") return peaks(flow);
    if (phase == "order") return order(flow);
    if (phase == "sort") return sort(flow);
    if (phase == "split") return {(2.0 + 8.0 * held(flow)) * kRead, 0.0};
    if (phase == "merge") return {4.0 * kRead + 2.0 * kWrite + 2.0, 0.0};
    return {};
}

Traffic traffic_of(const std::string& phase, const SolidBody& body) {
    const double mean = body.mass_j ? 1.0 : 0.0, state = static_cast<double>(body.points.states);
    const double deposited = 3.0 + 3.0 + 9.0 + 3.0 + state;  // x, v, its gradient, m, V0, J
    const double gathered = 3.0 + 3.0 + 9.0 + 1.0 + state;
    const double kept = body.flip_sums ? kNode4 : 0.0;  // what nodes had, in the place of the mean
    if (phase == "clear") return {0.0, kNode4 + kept + mean * kRead};
    if (phase == "scatter") return {deposited * kRead, 2.0 * (kNode4 + kept) + mean * kWrite};
    if (phase == "mirror particles") return {2.0, 2.0};  // most points are far from surfaces: they are not read again
    if (phase == "nodes") return {0.0, 2.0 * (kNode4 + kept) + mean * kWrite};
    if (phase == "gather") return {gathered * kWrite, kNode4 + kept + mean * kRead};
    if (phase == "sort") return {(18.0 + state) * (1.5 * kRead + kWrite), 0.0};
    return {};
}

Traffic traffic_of(const std::string& phase, const StructuredBody& body) {
    // Of nodes: mass and momentum; the pressure of grains and their sub-points' mass; what is bound with water.
    const double grains = body.grains ? 1.0 : 0.0, water = body.water ? 1.0 : 0.0;
    const double node = kNode4 + grains * (kNode4 + kRead) + water * kNode4;
    if (phase == "clear") return {0.0, node};
    if (phase == "scatter")  // place, v, its gradient, m, V, damage, stress; layer, force and domain of grains; made of
        return {(8.0 + 3.0 + 3.0 + grains * 6.0 + water * 2.0) * kRead, 2.0 * node};
    if (phase == "surface") {
        const Traffic level = depth(body.flow), smooth = filter(body.flow);
        return {0.0, level.node + smooth.node + 6.0};
    }
    if (phase == "nodes") return {0.0, node + 2.0 * kNode4 + 8.0 * kRead + grains * (4.0 * kRead + 2.0 * kRead)};
    if (phase ==
        "gather")  // replaced: v, its gradient, force, layer; changed: place, depth, stress, damage, strain, domain
        return {(8.0 + 2.0 + 1.0 + 4.0 + 2.0 + grains * 4.0 + water * 5.0) * kWrite + 3.0 * kRead, kNode4};
    return {};
}

}  // namespace frana::bench
