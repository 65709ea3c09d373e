#include "shallow/grid_update.h"

#include <algorithm>

#include "law/bed/node_friction.h"
#include "shallow/grid_update_bed.h"
#include "shallow/lateral.h"
#include "shallow/shock.h"
#include "shallow/surface_gradient.h"
#include "shallow/two_cell_wave.h"

namespace frana {
namespace {

constexpr double kSlowest = 1e-30;  ///< below any speed, above the root of the smallest number [m/s]

/// A node, or four in a row.
template <class Real>
struct Node {
    Real vx, vy;  ///< before the grid update [m/s]
    Real ex, ey;  ///< gradient of the free surface [1]
    Real depth, mass;
    Real law_depth;                       ///< without the 2-cell wave [m]
    Real acceleration_x, acceleration_y;  ///< artificial viscosity and stress [m/s^2]
    Real loss_x, loss_y;                  ///< the viscosity's part, whose work is lost [m/s^2]
    Real at_front;                        ///< 1 at margins, whose surface may be that of what lies behind; otherwise 0

    /// One of four.
    Node<double> at(int n) const {
        return {vx[n],
                vy[n],
                ex[n],
                ey[n],
                depth[n],
                mass[n],
                law_depth[n],
                acceleration_x[n],
                acceleration_y[n],
                loss_x[n],
                loss_y[n],
                at_front[n]};
    }
    void set(int n, const Node<double>& one) {
        vx[n] = one.vx, vy[n] = one.vy, ex[n] = one.ex, ey[n] = one.ey;
        depth[n] = one.depth, mass[n] = one.mass, law_depth[n] = one.law_depth;
        acceleration_x[n] = one.acceleration_x, acceleration_y[n] = one.acceleration_y;
        loss_x[n] = one.loss_x, loss_y[n] = one.loss_y, at_front[n] = one.at_front;
    }
};

template <class Real>
struct Updated {
    Real vx, vy, kinetic, dissipated, wave_gravity;
    Real velocity_share;  ///< share of the velocity that friction left [1]

    /// One of four.
    Updated<double> at(int n) const {
        return {vx[n], vy[n], kinetic[n], dissipated[n], wave_gravity[n], velocity_share[n]};
    }
};

/// At the edge of a stencil mass vanishes faster than force. A node counts `depth` at least, of resisting_depth().
/// Otherwise a point's stress would drive it (and the time step) without bound.
template <class Real>
Real inertia_of(const Flow& flow, Real mass, Real depth) {
    return max(mass, flow.density * flow.area * depth);
}

/// Depth that a node's inertia is reckoned with at least. Linear shapes give a node as much force however little of a
/// point's mass it gets. Depth goes with mass there. What lies on the nodes around counts too, and all of it: see
/// most_viscosity().
template <class Real>
Real resisting_depth(const Flow& flow, Index k) {
    Real depth = read<Real>(&flow.nodes.depth[k]);
    if (flow.scheme.shape != Shape::linear) return 0.5 * depth;
    const Index up = flow.grid.stride();
    for (const Index row : {k - up, k, k + up})
        for (Index m = row - 1; m <= row + 1; ++m) depth = max(depth, read<Real>(&flow.nodes.depth[m]));
    return depth;
}

/// Each node has a law of that kind of its own: as LawOfEachNode, but the kernel holds the formula.
template <class Law>
struct TableOf {
    using One = Law;
};
template <class Law>
inline constexpr bool kIsTable = false;
template <class Law>
inline constexpr bool kIsTable<TableOf<Law>> = true;

/// law_at() of these too.
template <class Real, class Law>
[[gnu::always_inline]] inline decltype(auto) law_here(const Law& law, const std::optional<NodeLaws>& laws, Index k) {
    if constexpr (kIsTable<Law>) {
        const auto& of = *std::get_if<std::vector<typename Law::One>>(&laws->laws);
        const auto& place = laws->place;
        if constexpr (std::is_same_v<Real, Double4>)
            return frana::laws::side_by_side(of[place[k]], of[place[k + 1]], of[place[k + 2]], of[place[k + 3]]);
        else
            return (of[place[k]]);
    } else {
        return law_at<Real>(law, laws, k);
    }
}

template <class Law, class Terrain>
class Kernel final : public GridUpdateKernel {
public:
    Kernel(const Law& law, bool on_points) : law_(law), pressure_on_points_(on_points) {}

    GridUpdateSums update(Flow& flow, double dt, double drift) override {
        drift_ = drift;
        if (!parts_) parts_ = LazyArray<GridUpdateSums>(flow.grid.tiles());
        for_each_work_run(flow.active, [&](const TileRun& run) {
            std::array<TileWork, kRunTiles> work{};
            for_each_four_of_run(flow.grid, run, flow.active_nodes(), [&](Index n, Index k, Index i, Index j) {
                update_four(flow, k, i, j, dt, work[static_cast<std::size_t>(n)]);
            });
            for (Index n = 0; n < run.count; ++n) finish(flow, run.tile[n], work[static_cast<std::size_t>(n)]);
        });
        GridUpdateSums total;
        for (const Index tile : flow.active.work) {
            const GridUpdateSums& part = parts_[tile];
            total.kinetic += part.kinetic;
            total.dissipated += part.dissipated;
            total.impulse_x += part.impulse_x;
            total.impulse_y += part.impulse_y;
            total.max_signal = std::max(total.max_signal, part.max_signal);
        }
        return total;
    }

    /// Were the drive stronger by a billionth, friction would hold it still. Where only a yield stress holds a node on
    /// a bent bed, its gravity depends on the step (midpoint). The linearised drive does not grow with the slope alone:
    /// no promise.
    bool holds(const Flow& flow, Index tile) const override {
        if constexpr (Terrain::kLinearised) return false;
        constexpr double kFirm = 1.0 + 1e-9;
        bool held = true;
        for_each_node_of(flow.grid, tile, flow.in_reach[tile], [&](Index k, Index, Index) {
            if (!held || !(flow.nodes.flags[k] & kMoving)) return;
            Node<double> node = prepared(flow, k);
            for (double* driving : {&node.ex, &node.ey, &node.acceleration_x, &node.acceleration_y}) *driving *= kFirm;
            const typename Terrain::template Bed<double> bed(flow, k);
            const auto& law = law_here<double>(law_, flow.laws, k);
            const Updated<double> after = updated(flow, bed, node, law, 1.0);
            held = after.vx == 0.0 && after.vy == 0.0 && rests_midway(flow, bed, node, law);
        });
        return held;
    }

private:
    template <class Real>
    struct Sums {
        Real kinetic{}, dissipated{}, impulse_x{}, impulse_y{}, max_signal{};
    };
    struct TileWork {
        Sums<Double4> four;
        Sums<double> single;
        GridUpdateSums total() const {
            return {single.kinetic + sum(four.kinetic), single.dissipated + sum(four.dissipated),
                    single.impulse_x + sum(four.impulse_x), single.impulse_y + sum(four.impulse_y),
                    std::max(single.max_signal, largest(four.max_signal))};
        }
    };

    void finish(Flow& flow, Index tile, const TileWork& work) {
        flow.rest.moving[tile] = 0;
        if (!flow.rest.active[tile]) return;
        flow.rest.moving[tile] = flow.rest.some_asleep ? moving_groups(flow, tile) : kAllGroups;
        parts_[tile] = work.total();
    }

    /// The wave whose slope points shift by.
    template <class Real>
    static Real wave_at(const Flow& flow, Index k, const Node<Real>& node) {
        return common_wave(node.depth, node.law_depth, read<Real>(&flow.nodes.level[k]),
                           read<Real>(&flow.nodes.surface[k]));
    }

    static NodeGroups moving_groups(const Flow& flow, Index tile) {
        NodeGroups moving = 0;
        for_each_four_of(flow.grid, tile, flow.in_reach[tile], [&](Index k, Index i, Index j) {
            const Motion* m = flow.nodes.motions() + k;
            bool any = false;
            for (int n = 0; n < 4; ++n) any = any || m[n].vx != 0.0 || m[n].vy != 0.0;
            if (any) moving |= group_of(i - flow.grid.tile_i(tile), j - flow.grid.tile_j(tile));
        });
        return moving;
    }

    /// Four nodes in a row: loaded together where all lie inside the flow, otherwise one by one (update_some).
    void update_four(Flow& flow, Index k, Index i, Index j, double dt, TileWork& work) {
        const std::uint8_t* f = flow.nodes.flags.data() + k;
        constexpr int kInside = kMoving | kWideX | kWideY;
        Motion* motion = flow.nodes.motions() + k;
        if ((f[0] & f[1] & f[2] & f[3] & kInside) == kInside && !pressure_on_points_ && dt > 0.0 &&
            inside(flow, i, j)) {
            const Node<Double4> node = prepared_four(flow, k);
            const auto after = updated(flow, typename Terrain::template Bed<Double4>(flow, k), node,
                                       law_here<Double4>(law_, flow.laws, k), dt);
            add(flow, node, after, 1.0, work.four);
            Double4 out[4];
            transpose(after.vx, after.vy, node.depth, wave_at(flow, k, node), out);
            for (int n = 0; n < 4; ++n) store(motion + n, out[n]);
            if (flow.keeps_shares()) store(&flow.nodes.velocity_share[k], after.velocity_share);
        } else {
            update_some(flow, k, i, j, dt, work.single);
        }
    }

    /// Those of four nodes in a row that move and are of the grid; the laws take them together.
    void update_some(Flow& flow, Index k, Index i, Index j, double dt, Sums<double>& sums) {
        Node<Double4> four{};
        std::array<double, 4> share{};
        int moving = 0, last = 0;
        for (int n = 0; n < 4; ++n) {
            flow.nodes.motions()[k + n] = {0.0, 0.0, flow.nodes.depth[k + n], 0.0};
            if (flow.keeps_shares()) flow.nodes.velocity_share[k + n] = 1.0;
            if (flow.nodes.flags[k + n] & kMoving) share[static_cast<std::size_t>(n)] = flow.share(i + n, j);
            if (share[static_cast<std::size_t>(n)] == 0.0) continue;
            four.set(n, prepared_at(flow, k + n, i + n, j));
            ++moving, last = n;
        }
        if (moving == 0) return;
        if (moving == 1 || !(dt > 0.0)) {
            for (int n = 0; n <= last; ++n)
                if (share[static_cast<std::size_t>(n)] > 0.0)
                    update_one(flow, k + n, four.at(n), dt, share[static_cast<std::size_t>(n)], sums);
            return;
        }
        const auto after = updated(flow, typename Terrain::template Bed<Double4>(flow, k), four,
                                   law_here<Double4>(law_, flow.laws, k), dt);
        for (int n = 0; n <= last; ++n)
            if (share[static_cast<std::size_t>(n)] > 0.0)
                take(flow, k + n, four.at(n), after.at(n), share[static_cast<std::size_t>(n)], sums);
    }

    static bool inside(const Flow& flow, Index i, Index j) {
        return !flow.walls || (i > 0 && j > 0 && i + 4 < flow.grid.nx() && j + 1 < flow.grid.ny());
    }

    void update_one(Flow& flow, Index k, const Node<double>& node, double dt, double share, Sums<double>& sums) {
        const typename Terrain::template Bed<double> bed(flow, k);
        take(flow, k, node,
             dt > 0.0 ? updated(flow, bed, node, law_here<double>(law_, flow.laws, k), dt) : resting_clock(bed, node),
             share, sums);
    }

    static void take(Flow& flow, Index k, const Node<double>& node, const Updated<double>& after, double share,
                     Sums<double>& sums) {
        flow.nodes.motions()[k] = {after.vx, after.vy, node.depth, wave_at(flow, k, node)};
        if (flow.keeps_shares()) flow.nodes.velocity_share[k] = after.velocity_share;
        add(flow, node, after, share, sums);
    }

    /// What a mirror cancels at a wall, it cancels exactly.
    Node<double> prepared_at(const Flow& flow, Index k, Index i, Index j) const {
        Node<double> node = prepared(flow, k);
        if (flow.walls) {
            if (i == 0 || i == flow.grid.nx() - 1) node.ex = node.acceleration_x = node.loss_x = node.vx = 0.0;
            if (j == 0 || j == flow.grid.ny() - 1) node.ey = node.acceleration_y = node.loss_y = node.vy = 0.0;
        }
        return node;
    }

    template <class Real>
    static void add(const Flow&, const Node<Real>& node, const Updated<Real>& after, double share, Sums<Real>& sums) {
        const Real mass = share * node.mass;
        sums.kinetic += mass * after.kinetic;
        sums.dissipated += mass * after.dissipated;
        sums.impulse_x += mass * (after.vx - node.vx);
        sums.impulse_y += mass * (after.vy - node.vy);
        sums.max_signal = max(sums.max_signal,
                              sqrt(after.vx * after.vx + after.vy * after.vy) + sqrt(after.wave_gravity * node.depth));
    }

    /// A grid update of no length: the start of a run.
    template <class Bed>
    static Updated<double> resting_clock(const Bed& bed, const Node<double>& n) {
        double vz = 0.0;
        if constexpr (Terrain::kSteep) vz = n.vx * bed.bx + n.vy * bed.by;
        return {n.vx, n.vy, 0.5 * (n.vx * n.vx + n.vy * n.vy + vz * vz), 0.0, 0.0, 1.0};
    }

    Node<double> prepared(const Flow& flow, Index k) const {
        const Nodes& nodes = flow.nodes;
        const Index up = flow.grid.stride();
        Node<double> node{};
        node.vx = nodes.before[k].x, node.vy = nodes.before[k].y;
        node.depth = nodes.depth[k], node.law_depth = nodes.law_depth[k], node.mass = nodes.mass[k];
        node.at_front = at_front(flow, k);
        if (!pressure_on_points_) {
            node.ex = surface_gradient(flow, k, 1, nodes.flags[k] & kWideX, flow.bed.slope_x[k]);
            node.ey = surface_gradient(flow, k, up, nodes.flags[k] & kWideY, flow.bed.slope_y[k]);
        }
        // A rotated domain's centre may reach beyond its mass.
        if (has_viscosity(flow.scheme) && node.depth > 1e-12 * flow.cell) {
            const double scale = 1.0 / (flow.cell * node.depth);
            node.acceleration_x = node.loss_x = scale * (nodes.viscous_flux[k - 1].x - nodes.viscous_flux[k].x);
            node.acceleration_y = node.loss_y = scale * (nodes.viscous_flux[k - up].y - nodes.viscous_flux[k].y);
        }
        if (has_lateral_drag(flow.scheme)) {
            const Pair& drag = nodes.lateral[k];
            node.acceleration_x += drag.x, node.acceleration_y += drag.y;
            node.loss_x += drag.x, node.loss_y += drag.y;
        }
        if (nodes.forced) {
            const double inertia = inertia_of(flow, node.mass, resisting_depth<double>(flow, k));
            node.acceleration_x += nodes.deposits()[k].fx / inertia;
            node.acceleration_y += nodes.deposits()[k].fy / inertia;
        }
        return node;
    }

    /// Four nodes in a row, with five wet ones in a row around each.
    Node<Double4> prepared_four(const Flow& flow, Index k) const {
        const Nodes& nodes = flow.nodes;
        const Index up = flow.grid.stride();
        Node<Double4> node;  // set one by one: to clear it first would be a loop of its own
        unzip(&nodes.before[k], node.vx, node.vy);
        node.acceleration_x = node.acceleration_y = node.loss_x = node.loss_y = node.at_front = Double4{};
        node.depth = load(&nodes.depth[k]), node.law_depth = load(&nodes.law_depth[k]),
        node.mass = load(&nodes.mass[k]);
        node.ex = wide_gradients(flow, k, 1);
        node.ey = wide_gradients(flow, k, up);
        if (has_viscosity(flow.scheme)) {
            Double4 right, left, above, below, across;
            unzip(&nodes.viscous_flux[k], right, above);
            unzip(&nodes.viscous_flux[k - 1], left, across);
            unzip(&nodes.viscous_flux[k - up], across, below);
            const Double4 none = {},
                          scale = select(node.depth > 1e-12 * flow.cell, 1.0 / (flow.cell * node.depth), none);
            node.acceleration_x = node.loss_x = scale * (left - right);
            node.acceleration_y = node.loss_y = scale * (below - above);
        }
        if (has_lateral_drag(flow.scheme)) {
            Double4 x, y;
            unzip(&nodes.lateral[k], x, y);
            node.acceleration_x += x, node.acceleration_y += y;
            node.loss_x += x, node.loss_y += y;
        }
        if (nodes.forced) {
            const Deposit* d = nodes.deposits() + k;
            const Double4 fx = {d[0].fx, d[1].fx, d[2].fx, d[3].fx}, fy = {d[0].fy, d[1].fy, d[2].fy, d[3].fy};
            const Double4 share = 1.0 / inertia_of(flow, node.mass, resisting_depth<Double4>(flow, k));
            node.acceleration_x += fx * share;
            node.acceleration_y += fy * share;
        }
        return node;
    }

    /// Gentle terrain: a = -g grad(eta), friction with N = g.
    template <class Real, class Here>
    Updated<Real> updated(const Flow& flow, const GentleBed<Real>&, const Node<Real>& n, const Here& law,
                          double dt) const {
        const double g = flow.gravity;
        const Real dx = n.vx + dt * (n.acceleration_x - g * n.ex), dy = n.vy + dt * (n.acceleration_y - g * n.ey);
        const Real one = Real{} + 1.0, level = Real{} + g;
        const BedStateOf<Real> state{level, max(n.law_depth, Real{} + 1e-9), one, one, g, flow.density};
        return braked(state, n, law, dx, dy, Real{}, Real{}, level, dt);
    }

    /// Steep terrain: a = -g_c drive, g_c = (g + v.H.v)+ at the middle of the step.
    template <class Real, Curvature kCurvature, bool kLinear, class Here>
    Updated<Real> updated(const Flow& flow, const SteepBed<Real, kCurvature, kLinear>& bed, const Node<Real>& n,
                          const Here& law, double dt) const {
        const double g = flow.gravity;
        const Real cosine = 1.0 / sqrt(1.0 + bed.bx * bed.bx + bed.by * bed.by);
        const Drive<Real> slope = bed.drive(n.ex, n.ey, cosine);
        const Real high = bed.height_around(flow, n.depth, n.ex, n.ey);
        Drive<Real> driving = bed.driving(slope, g, high, n.vx, n.vy, cosine);
        Real gravity = bed.gravity(g, n.vx, n.vy);
        if constexpr (kCurvature != Curvature::none) {
            const auto [mx, my] = midpoint(bed, n, law, driving, g, cosine, dt);
            driving = bed.driving(slope, g, high, mx, my, cosine);
            gravity = bed.gravity(g, mx, my);
        }
        Real dx = n.vx + dt * (n.acceleration_x - driving.x), dy = n.vy + dt * (n.acceleration_y - driving.y);
        bed.climb(n.ex, n.ey, n.at_front, g, flow.cell, gravity, dt, dx, dy);
        const Real along = dx * bed.bx + dy * bed.by, speed2 = dx * dx + dy * dy;
        const Real kappa = sqrt(1.0 + select(speed2 > 0.0, along * along / speed2, Real{}));
        const Real normal = kCurvature == Curvature::full ? gravity : Real{} + g;
        const BedStateOf<Real> state{
            normal * cosine / kappa, max(n.law_depth * cosine, Real{} + 1e-9), kappa, cosine, g, flow.density};
        return braked(state, n, law, dx, dy, bed.bx, bed.by, max(Real{} + g, gravity), dt);
    }

    template <class Here>
    bool rests_midway(const Flow&, const GentleBed<double>&, const Node<double>&, const Here&) const {
        return true;
    }
    template <Curvature kCurvature, bool kLinear, class Here>
    bool rests_midway(const Flow& flow, const SteepBed<double, kCurvature, kLinear>& bed, const Node<double>& n,
                      const Here& law) const {
        if constexpr (kCurvature == Curvature::none) return true;
        const double g = flow.gravity, cosine = 1.0 / std::sqrt(1.0 + bed.bx * bed.bx + bed.by * bed.by);
        const Drive<double> slope = bed.drive(n.ex, n.ey, cosine);
        const auto [mx, my] = midpoint(bed, n, law, Drive<double>{g * slope.x, g * slope.y}, g, cosine, 1.0);
        return mx == 0.0 && my == 0.0;
    }

    /// Velocity in the middle of the step, driven and braked by Coulomb friction: makes v.H.v second order.
    template <class Real, Curvature kCurvature, bool kLinear, class Here>
    std::pair<Real, Real> midpoint(const SteepBed<Real, kCurvature, kLinear>& bed, const Node<Real>& n, const Here& law,
                                   const Drive<Real>& driving, double g, Real cosine, double dt) const {
        const Real mx = n.vx - 0.5 * dt * driving.x, my = n.vy - 0.5 * dt * driving.y;
        const Real along = mx * bed.bx + my * bed.by, speed2 = mx * mx + my * my;
        const Real normal = kCurvature == Curvature::full ? bed.gravity(g, n.vx, n.vy) : Real{} + g;
        // Speed lost to friction, over the speed: normal force over kappa is normal * cosine * speed / sqrt(...).
        const Real lost = 0.5 * dt * law.friction_at_rest() * normal * cosine;
        const Real share_left = select(speed2 > 0.0, max(Real{}, 1.0 - lost / sqrt(speed2 + along * along)), Real{});
        return {mx * share_left, my * share_left};
    }

    template <class Real, class Here>
    Updated<Real> braked(const BedStateOf<Real>& state, const Node<Real>& n, const Here& law, Real dx, Real dy, Real bx,
                         Real by, Real wave_gravity, double dt) const {
        // A node that forces stopped has the share of the slowest. Otherwise round-off would decide what flip's points
        // retain.
        const Real driven = max(sqrt(dx * dx + dy * dy), Real{} + kSlowest), unit = 1.0 / driven;
        const Real s0 = max(Real{}, (n.vx * dx + n.vy * dy) * unit);
        const BrakedOf<Real> braking{s0, driven, speeds_after(law, state, s0, driven, dt), dt, drift_};
        const Real speed = mean_if_stopping(law, state, braking);
        const Real share_left = speed * unit, vx = dx * share_left, vy = dy * share_left, vz = vx * bx + vy * by;
        const Real kinetic = 0.5 * (vx * vx + vy * vy + vz * vz);
        // Work of friction: its impulse times the mean speed of the step; none where nothing moves. And what bores
        // lose through the artificial viscosity, which moves a node along its bed.
        const Real mx = 0.5 * (n.vx + vx), my = 0.5 * (n.vy + vy), mz = mx * bx + my * by;
        const Real bore = -dt * (n.loss_x * (mx + bx * mz) + n.loss_y * (my + by * mz));
        const Real work = state.kappa * state.kappa * (driven - speed) * 0.5 * (s0 + speed) + bore;
        // The mean over a drift may exceed a speed that gravity has all but stopped; friction makes no velocity grow.
        const Real velocity_share = min(share_left, Real{} + 1.0);
        return {vx, vy, kinetic, select(driven > kSlowest, work, Real{}), wave_gravity, velocity_share};
    }

    Law law_;
    bool pressure_on_points_;
    double drift_ = 0.0;               ///< [s]
    LazyArray<GridUpdateSums> parts_;  ///< per tile of the domain
};

template <class Terrain>
std::unique_ptr<GridUpdateKernel> with_law(const Scene& scene) {
    const bool on_points = scene.scheme.paper_pressure;
    if (const auto* laws = scene.bed_laws())
        return std::visit(
            [&](const auto& table) -> std::unique_ptr<GridUpdateKernel> {
                using One = typename std::decay_t<decltype(table)>::value_type;
                using Law = std::conditional_t<laws::kSideBySide<One>, TableOf<One>, LawOfEachNode>;
                return std::make_unique<Kernel<Law, Terrain>>(Law{}, on_points);
            },
            laws->laws);
    return std::visit(
        [&](const auto& law) -> std::unique_ptr<GridUpdateKernel> {
            return std::make_unique<Kernel<std::decay_t<decltype(law)>, Terrain>>(law, on_points);
        },
        scene.bed_law);
}

/// For terrain that few runs have: no kernel for each law.
template <class Terrain>
std::unique_ptr<GridUpdateKernel> with_any_law(const Scene& scene) {
    const bool on_points = scene.scheme.paper_pressure;
    if (scene.bed_laws()) return std::make_unique<Kernel<LawOfEachNode, Terrain>>(LawOfEachNode{}, on_points);
    return std::make_unique<Kernel<AnyLaw, Terrain>>(AnyLaw(scene.bed_law), on_points);
}

template <bool kLinear>
std::unique_ptr<GridUpdateKernel> with_curvature(const Scene& scene) {
    switch (scene.curvature) {
        case Curvature::none:
            return with_any_law<Steep<Curvature::none, kLinear>>(scene);
        case Curvature::inertia:
            return with_any_law<Steep<Curvature::inertia, kLinear>>(scene);
        case Curvature::full:
            if constexpr (kLinear)
                return with_any_law<Steep<Curvature::full, kLinear>>(scene);
            else
                return with_law<Steep<Curvature::full, kLinear>>(scene);
    }
    throw InternalError("unknown curvature");
}

}  // namespace

std::unique_ptr<GridUpdateKernel> make_grid_update(const Scene& scene) {
    switch (scene.terrain) {
        case TerrainModel::shallow:
            return with_law<Gentle>(scene);
        case TerrainModel::steep:
            return with_curvature<false>(scene);
        case TerrainModel::linearised:
            return with_curvature<true>(scene);
    }
    throw InternalError("unknown terrain model");
}

}  // namespace frana
