#include "solver/kick.h"

#include <algorithm>
#include <limits>

#include "law/bed_law.h"
#include "solver/shock.h"
#include "solver/surface.h"

namespace frana {
namespace {

/// Slope of the free surface at a node with material, along one axis. Uniform depth gives the bed's own slope, a lake gives
/// zero, whatever the bed. A dry neighbour that stands higher is a shore and takes no part; a dry neighbour that
/// lies lower enters with its bed, and drives the front. One-sided, a film that follows a curved bed takes the bed's own
/// slope at the node (the difference to a side has the slope of half a cell away); `slope`: that of the bed.
double raw_gradient(const Flow& flow, Index k, Index step, bool wide, double slope) {
    const Nodes& nodes = flow.nodes;
    const double *e = nodes.surface.data() + k, *z = flow.bed.z.data() + k, cell = flow.cell;
    if (wide) return (8.0 * (e[step] - e[-step]) - (e[2 * step] - e[-2 * step])) / (12.0 * cell);
    const auto shore = [&](Index n) { return !(nodes.flags[k + n] & kWet) && e[n] > e[0]; };
    const bool ahead = shore(step), behind = shore(-step);
    const auto to_side = [&](Index n) {
        const double rise = (e[n] - e[0]) / cell, ground = (z[n] - z[0]) / cell;
        return rise + film_share(rise, ground) * ((n > 0 ? slope : -slope) - ground);
    };
    if (ahead && !behind) return -to_side(-step);
    if (behind && !ahead) return to_side(step);
    return ((ahead ? 0.0 : e[step] - e[0]) - (behind ? 0.0 : e[-step] - e[0])) / (2.0 * cell);
}

/// The same without the round-off of the surface's own height: a difference of some units in the last place over a
/// cell is none, so that a lake rests to the last bit.
double surface_gradient(const Flow& flow, Index k, Index step, bool wide, double bed_slope) {
    constexpr double round_off = 64.0 * std::numeric_limits<double>::epsilon();
    const double slope = raw_gradient(flow, k, step, wide, bed_slope);
    return std::abs(slope) * flow.cell <= round_off * std::abs(flow.nodes.surface[k]) ? 0.0 : slope;
}

/// P1's terrain: gentle slopes, no curvature. Driving a = -g grad(eta), normal force g.
struct Gentle {
    explicit Gentle(const Flow&, Index) {}
    static constexpr bool kSteep = false;
};

/// Driving slope of the surface, times its gravity: a = -gravity * (x, y).
struct Drive { double x, y; };

/// Steep terrain. kLinear: to first order in the depth gradient. kCurvature: none, inertia (v.H.v in the acceleration only), full (in the friction too).
template <Curvature kCurvature, bool kLinear>
struct Steep {
    static constexpr bool kSteep = true;
    double bx, by, hxx = 0.0, hxy = 0.0, hyy = 0.0;
    Steep(const Flow& flow, Index k) : bx(flow.bed.slope_x[k]), by(flow.bed.slope_y[k]) {
        if constexpr (kCurvature != Curvature::none) {
            hxx = flow.bed.hxx[k];
            hxy = flow.bed.hxy[k];
            hyy = flow.bed.hyy[k];
        }
    }
    /// Gravity plus the bed's own vertical acceleration along the path, (g + v.H.v)+
    double gravity(double g, double vx, double vy) const {
        if constexpr (kCurvature == Curvature::none) return g;
        return std::max(0.0, g + vx * vx * hxx + 2.0 * vx * vy * hxy + vy * vy * hyy);
    }
    /// grad(eta) / (1 + gradZ . grad(eta)): a column that accelerates vertically with its bed. The continuation
    /// 1/(1 - q) for q < 0 keeps the factor positive where the surface slopes against a steep bed. Linear:
    /// c^2 (gradZ + grad h - c^2 gradZ (gradZ . grad h)), the first terms of its series in grad h.
    Drive drive(double ex, double ey, double cosine) const {
        if constexpr (kLinear) {
            const double c2 = cosine * cosine, hx = ex - bx, hy = ey - by, along = c2 * (bx * hx + by * hy);
            return {c2 * (ex - bx * along), c2 * (ey - by * along)};
        } else {
            const double q = bx * ex + by * ey, reduce = q >= 0.0 ? 1.0 / (1.0 + q) : 1.0 - q;
            return {reduce * ex, reduce * ey};
        }
    }
};

struct Node {
    double vx, vy;      ///< before the kick [m/s]
    double ex, ey;      ///< gradient of the free surface [1]
    double depth, mass;
    double push_x, push_y;  ///< artificial viscosity and stress [m/s^2]
    double loss_x = 0.0, loss_y = 0.0;  ///< the viscosity's part, whose work is lost [m/s^2]
};

struct Kicked {
    double vx, vy, kinetic, dissipated, wave_gravity;
};

template <class Law, class Terrain>
class Kernel final : public KickKernel {
public:
    Kernel(const Law& law, bool on_points) : law_(law), pressure_on_points_(on_points) {}

    KickSums kick(Flow& flow, double dt, double drift) override {
        drift_ = drift;
        parts_.assign(flow.active.work.size(), {});
        for_each_work_tile(flow.active, [&](Index n, Index tile) {
            KickSums sums;
            for_each_node_of(flow.grid, tile, [&](Index k, Index i, Index j) { kick_node(flow, k, i, j, dt, sums); });
            parts_[n] = sums;
        });
        KickSums total;
        for (const KickSums& part : parts_) {
            total.kinetic += part.kinetic;
            total.dissipated += part.dissipated;
            total.impulse_x += part.impulse_x;
            total.impulse_y += part.impulse_y;
            total.max_signal = std::max(total.max_signal, part.max_signal);
        }
        return total;
    }

private:
    void kick_node(Flow& flow, Index k, Index i, Index j, double dt, KickSums& sums) {
        const Nodes& nodes = flow.nodes;
        Motion& motion = flow.nodes.motions()[k];
        motion = {0.0, 0.0, nodes.depth[k], 0.0};
        if (!(nodes.flags[k] & kMoving)) return;
        const double mass = nodes.deposits()[k].mass;
        const double share = flow.share(i, j);
        if (share == 0.0) return;
        Node node = prepared(flow, k, mass);
        if (flow.walls) {  // what a mirror cancels, it cancels exactly
            if (i == 0 || i == flow.grid.nx() - 1) node.ex = node.push_x = node.loss_x = node.vx = 0.0;
            if (j == 0 || j == flow.grid.ny() - 1) node.ey = node.push_y = node.loss_y = node.vy = 0.0;
        }
        const Kicked after = dt > 0.0 ? kicked(flow, Terrain(flow, k), node, dt) : resting_clock(Terrain(flow, k), node);
        motion.vx = after.vx;
        motion.vy = after.vy;
        sums.kinetic += share * mass * after.kinetic;
        sums.dissipated += share * mass * after.dissipated;
        sums.impulse_x += share * mass * (after.vx - node.vx);
        sums.impulse_y += share * mass * (after.vy - node.vy);
        sums.max_signal = std::max(sums.max_signal, std::sqrt(after.vx * after.vx + after.vy * after.vy) +
                                                        std::sqrt(after.wave_gravity * node.depth));
    }

    /// A kick of no length: the start of a run.
    static Kicked resting_clock(const Terrain& bed, const Node& n) {
        double vz = 0.0;
        if constexpr (Terrain::kSteep) vz = n.vx * bed.bx + n.vy * bed.by;
        return {n.vx, n.vy, 0.5 * (n.vx * n.vx + n.vy * n.vy + vz * vz), 0.0, 0.0};
    }

    Node prepared(const Flow& flow, Index k, double mass) const {
        const Nodes& nodes = flow.nodes;
        const Index up = flow.grid.stride();
        Node node{nodes.before[k].x, nodes.before[k].y, 0.0, 0.0, nodes.depth[k], mass, 0.0, 0.0};
        if (!pressure_on_points_) {
            node.ex = surface_gradient(flow, k, 1, nodes.flags[k] & kWideX, flow.bed.slope_x[k]);
            node.ey = surface_gradient(flow, k, up, nodes.flags[k] & kWideY, flow.bed.slope_y[k]);
        }
        if (has_viscosity(flow.scheme) && node.depth > 1e-12 * flow.cell) {  // a rotated domain's centre may reach beyond its mass
            const double scale = 1.0 / (flow.cell * node.depth);
            node.push_x = scale * (nodes.viscous_flux[k - 1].x - nodes.viscous_flux[k].x);
            node.push_y = scale * (nodes.viscous_flux[k - up].y - nodes.viscous_flux[k].y);
            node.loss_x = node.push_x;
            node.loss_y = node.push_y;
        }
        if (nodes.force) {
            // At the rim of a stencil mass vanishes faster than force: a node that has depth counts half of it at
            // least, or a point's stress would drive it (and the time step) without bound.
            const double inertia = std::max(mass, 0.5 * flow.density * flow.area * node.depth);
            node.push_x += nodes.force[k].x / inertia;
            node.push_y += nodes.force[k].y / inertia;
        }
        return node;
    }

    /// Gentle terrain: a = -g grad(eta), friction with N = g.
    Kicked kicked(const Flow& flow, const Gentle&, const Node& n, double dt) const {
        const double g = flow.gravity;
        const double dx = n.vx + dt * (n.push_x - g * n.ex), dy = n.vy + dt * (n.push_y - g * n.ey);
        const BedState state{g, std::max(n.depth, 1e-9), 1.0, 1.0, g, flow.density};
        return braked(state, n, dx, dy, 0.0, 0.0, g, dt);
    }

    /// Steep terrain: a = -g_c drive, g_c = (g + v.H.v)+ at the middle of the step.
    template <Curvature kCurvature, bool kLinear>
    Kicked kicked(const Flow& flow, const Steep<kCurvature, kLinear>& bed, const Node& n, double dt) const {
        const double g = flow.gravity;
        const double cosine = 1.0 / std::sqrt(1.0 + bed.bx * bed.bx + bed.by * bed.by);
        const Drive slope = bed.drive(n.ex, n.ey, cosine);
        double gravity = bed.gravity(g, n.vx, n.vy);
        if constexpr (kCurvature != Curvature::none) {
            const auto [mx, my] = midpoint(bed, n, {gravity * slope.x, gravity * slope.y}, g, cosine, dt);
            gravity = bed.gravity(g, mx, my);
        }
        const double dx = n.vx + dt * (n.push_x - gravity * slope.x), dy = n.vy + dt * (n.push_y - gravity * slope.y);
        const double speed = std::sqrt(dx * dx + dy * dy);
        const double rise = speed > 0.0 ? (dx * bed.bx + dy * bed.by) / speed : 0.0;
        const double kappa = std::sqrt(1.0 + rise * rise);
        const double normal = kCurvature == Curvature::full ? gravity : g;
        const BedState state{normal * cosine / kappa, std::max(n.depth * cosine, 1e-9), kappa, cosine, g, flow.density};
        return braked(state, n, dx, dy, bed.bx, bed.by, std::max(g, gravity), dt);
    }

    /// Velocity in the middle of the step, driven and braked by Coulomb friction: makes v.H.v second order.
    template <Curvature kCurvature, bool kLinear>
    std::pair<double, double> midpoint(const Steep<kCurvature, kLinear>& bed, const Node& n, const Drive& pull, double g,
                                       double cosine, double dt) const {
        double mx = n.vx - 0.5 * dt * pull.x, my = n.vy - 0.5 * dt * pull.y;
        const double speed = std::sqrt(mx * mx + my * my);
        if (speed == 0.0) return {0.0, 0.0};
        const double rise = (mx * bed.bx + my * bed.by) / speed;
        const double normal = kCurvature == Curvature::full ? bed.gravity(g, n.vx, n.vy) : g;
        const double left = speed - 0.5 * dt * coulomb(law_) * normal * cosine / std::sqrt(1.0 + rise * rise);
        const double keep = std::max(0.0, left) / speed;
        return {mx * keep, my * keep};
    }

    Kicked braked(const BedState& state, const Node& n, double dx, double dy, double bx, double by,
                  double wave_gravity, double dt) const {
        const double driven = std::sqrt(dx * dx + dy * dy);
        if (driven == 0.0) return {0.0, 0.0, 0.0, 0.0, wave_gravity};
        const double s0 = std::max(0.0, (n.vx * dx + n.vy * dy) / driven);
        const double speed = stopping(state, s0, driven, dt, speed_after(law_, state, s0, driven, dt));
        const double keep = speed / driven, vx = dx * keep, vy = dy * keep, vz = vx * bx + vy * by;
        const double kinetic = 0.5 * (vx * vx + vy * vy + vz * vz);
        // Work of friction: its impulse times the mean speed of the step; none where nothing moves. And what bores
        // lose through the artificial viscosity, which moves a node along its bed.
        const double mx = 0.5 * (n.vx + vx), my = 0.5 * (n.vy + vy), mz = mx * bx + my * by;
        const double bore = -dt * (n.loss_x * (mx + bx * mz) + n.loss_y * (my + by * mz));
        const double work = state.kappa * state.kappa * (driven - speed) * 0.5 * (s0 + speed) + bore;
        return {vx, vy, kinetic, work, wave_gravity};
    }

    /// `speed`, or the mean speed over the coming drift if friction ends the motion in it, and holds: the speed in the
    /// drift's middle, where the leapfrog stands, would leave the stop short by up to brake drift^2 / 8.
    double stopping(const BedState& state, double s0, double driven, double dt, double speed) const {
        const double friction = coulomb(law_) * state.normal_gravity, pull = (driven - s0) / dt;
        const double brake = friction - pull;
        if (s0 == 0.0 || friction <= std::abs(pull) || drift_ <= 0.0) return speed;  // a turning point is no stop
        const double at_start = s0 + brake * (0.5 * drift_ - dt);  // of the drift, half of which the kick has covered
        if (at_start <= 0.0) return 0.0;
        return at_start < brake * drift_ ? 0.5 * at_start * at_start / (brake * drift_) : speed;
    }

    static double coulomb(const bed::None&) { return 0.0; }
    static double coulomb(const bed::Pouliquen& law) { return law.mu_s; }
    template <class Other>
    static double coulomb(const Other& law) { return law.mu; }

    Law law_;
    bool pressure_on_points_;
    double drift_ = 0.0;  ///< [s]
    std::vector<KickSums> parts_;
};

template <class Terrain>
std::unique_ptr<KickKernel> with_law(const Scene& scene) {
    return std::visit(
        [&](const auto& law) -> std::unique_ptr<KickKernel> {
            return std::make_unique<Kernel<std::decay_t<decltype(law)>, Terrain>>(law, scene.scheme.paper_pressure);
        },
        scene.bed_law);
}

template <bool kLinear>
std::unique_ptr<KickKernel> with_curvature(const Scene& scene) {
    switch (scene.curvature) {
        case Curvature::none: return with_law<Steep<Curvature::none, kLinear>>(scene);
        case Curvature::inertia: return with_law<Steep<Curvature::inertia, kLinear>>(scene);
        case Curvature::full: return with_law<Steep<Curvature::full, kLinear>>(scene);
    }
    throw InternalError("unknown curvature");
}

}  // namespace

std::unique_ptr<KickKernel> make_kick(const Scene& scene) {
    switch (scene.terrain) {
        case TerrainModel::shallow: return with_law<Gentle>(scene);
        case TerrainModel::steep: return with_curvature<false>(scene);
        case TerrainModel::linearised: return with_curvature<true>(scene);
    }
    throw InternalError("unknown terrain model");
}

}  // namespace frana
