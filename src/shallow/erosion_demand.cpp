// What each point demands of its bed in an exchange (THEORY.md, section 18).
//
// Between exchanges a point moves as if it took nothing. Its position and velocity are those of a flight from the time up
// to which it has taken its share, with the acceleration that the nodes have. An exchange moves that time on. It
// integrates the growth along the flight, and the flight that begins at its end takes the place of the old one.
#include <algorithm>
#include <cmath>

#include "mpm/domain.h"
#include "mpm/tile_points.h"
#include "shallow/drag_of_four.h"
#include "shallow/erosion.h"
#include "shallow/ground_of_four.h"
#include "shallow/sub_points_of_four.h"
#include "shallow/tiles_around.h"

namespace frana {
namespace {

/// What a point demands at once, of its mass. Few beds give so much. Where one gives less, what is left over is a difference
/// of demands, and round-off of more would count.
constexpr double kMostGain = 1e2;
/// Growth in half of a stretch above which no acceleration is followed: it is no small correction any more.
constexpr double kMostFollowed = 0.05;

/// exp(x) - 1 of four x >= 0. A step's growth is small: Taylor series that are right to round-off, the next term is 1e-18
/// of the first. The short one in pairs of terms, which do not wait for one another.
[[gnu::always_inline]] inline Double4 growth_of_four(Double4 x) {
    constexpr double kShortSeries = 1e-3, kSeries = 1.0 / 16;
    const Double4 one = all(1.0), x2 = x * x;
    if (!any(x > kShortSeries)) return (x + x2 * (0.5 + x * (1.0 / 6))) + (x2 * x2) * (1.0 / 24 + x * (1.0 / 120));
    constexpr int kTerms = 9;
    Double4 sum = x * (1.0 / kTerms);
    for (int n = kTerms - 1; n > 1; --n) sum = x * (1.0 / n) * (one + sum);
    sum = x * (one + sum);
    if (any(x > kSeries))
        for (int lane = 0; lane < 4; ++lane)
            if (x[lane] > kSeries) sum[lane] = std::expm1(x[lane]);
    return sum;
}

/// Rate at which four points grow [1/s]: of what they have, where the law is proportional to that. Otherwise of what they
/// had at the beginning. `per_thickness`: of one over their thickness then [1/m].
template <class Law>
[[gnu::always_inline]] inline Double4 growth_rates(const Law& law, const erosion::StateOf<Double4>& s,
                                                   Double4 per_thickness) {
    if constexpr (Law::kProportional) return law.share_rate(s);
    // No faster than the flow slides over the bed.
    return min(law.rate(s), s.speed) * (s.bed_density / s.density) * per_thickness;
}

/// What they have gained over what they had, from the integral of that rate.
template <class Law>
[[gnu::always_inline]] inline Double4 gains(Double4 integral) {
    if constexpr (Law::kProportional) return min(growth_of_four(integral), all(kMostGain));
    return min(integral, all(kMostGain));
}

/// A vector of four points, in shares of their velocities [1] and of the acceleration of their nodes [s].
struct InFlight {
    Double4 own, driven;
    InFlight operator+(const InFlight& b) const { return {own + b.own, driven + b.driven}; }
    InFlight operator*(Double4 b) const { return {b * own, b * driven}; }
};

/// Four points since their last exchange, as if they took nothing.
struct Flight {
    Double4 vx, vy, ax, ay;  ///< velocities in the middle of the step [m/s], accelerations [m/s^2]
    double middle;           ///< of the step, from the stretch's beginning [s]

    /// Velocities where bed that was taken has slowed the flow by 1/s. `a`: the integral of s until then [s].
    InFlight velocity(Double4 s, Double4 a) const {
        const Double4 own = 1.0 / s;
        return {own, (a - middle) * own};
    }
    /// Their size [m/s], from 1/s. The root waits for `a` alone, not for s.
    Double4 speed(Double4 own, Double4 a) const {
        const Double4 x = vx + (a - middle) * ax, y = vy + (a - middle) * ay;
        return own * sqrt(x * x + y * y);
    }
    Double4 x(const InFlight& v) const { return v.own * vx + v.driven * ax; }
    Double4 y(const InFlight& v) const { return v.own * vy + v.driven * ay; }
};

/// How fast four points grow, and how fast friction takes momentum of what they are by then, both of what they had at the
/// stretch's beginning [1/s].
struct Rates {
    Double4 growth, braking;
};

/// What comes of a stretch.
struct Grown {
    Double4 gain, braked;    ///< over what there was
    InFlight velocity, way;  ///< at its end, and along it
};

/// Kutta's steps of third order along a flight, for a time `dt`. Of rates(speed, gain), and of bed that slows the flow by
/// 1/slowed(gain, braked).
template <class Law, class RatesAt, class Slowed>
[[gnu::always_inline]] inline Grown grown_along(Flight& flight, double dt, const RatesAt& rates, const Slowed& slowed) {
    const Double4 none = {}, one = all(1.0), half = all(0.5 * dt), sixth = all(dt / 6.0);
    const InFlight v1 = flight.velocity(one, none);
    const Rates r1 = rates(flight.speed(one, none), none);
    const Double4 x2 = half * r1.growth, gain2 = gains<Law>(x2), braked2 = half * r1.braking,
                  s2 = slowed(gain2, braked2);
    if (const Mask4 fast = x2 > kMostFollowed; any(fast))
        flight.ax = select(fast, none, flight.ax), flight.ay = select(fast, none, flight.ay);
    const InFlight v2 = flight.velocity(s2, half);
    const Rates r2 = rates(flight.speed(v2.own, half), gain2);
    const Double4 x3 = max(dt * (2.0 * r2.growth - r1.growth), x2), gain3 = gains<Law>(x3),
                  braked3 = max(dt * (2.0 * r2.braking - r1.braking), braked2), s3 = slowed(gain3, braked3),
                  a3 = dt * (2.0 * s2 - 1.0);
    const InFlight v3 = flight.velocity(s3, a3);
    const Rates r3 = rates(flight.speed(v3.own, a3), gain3);
    const Double4 gain = gains<Law>(sixth * (r1.growth + 4.0 * r2.growth + r3.growth)),
                  braked = sixth * (r1.braking + 4.0 * r2.braking + r3.braking);
    const InFlight v = flight.velocity(slowed(gain, braked), sixth * (1.0 + 4.0 * s2 + s3));
    return {gain, braked, v, (v1 + v2 * all(4.0) + v3) * sixth};
}

}  // namespace

/// THEORY (72): the demand of each point, and their sum on the nodes.
void Erosion::find_demand(Flow& flow, const Stretch& stretch) {
    if (stretch.velocity_dt > 0.0) find_gained(flow);
    flow.particles.with_real([&](auto real) {
        using Real = decltype(real);
        for_each_eroding_in_turn(flow, [&](Index n) {
            const auto demand = [&](const auto& law, auto&& drag) {
                using Law = std::decay_t<decltype(law)>;
                using Drag = std::decay_t<decltype(drag)>;
                if constexpr (Law::kSeesEroded || Law::kSeesLeft || Law::kSeesStress)
                    if (deposits_) return demand_of_tile<Law, Drag, Real, true>(flow, n, stretch, law, drag);
                demand_of_tile<Law, Drag, Real, false>(flow, n, stretch, law, drag);
            };
            const auto demand_of = [&](const auto& law) {
                if constexpr (!std::decay_t<decltype(law)>::kSeesStress)
                    if (momentum_ == 0.0) return demand(law, Unfelt{});
                with_drag(flow, friction_, [&](DragOfFour& drag) { demand(law, drag); });
            };
            std::visit(demand_of, law_);
            spread<Real>(flow, n, wanted_, demand_);
        });
    });
    collect_reach(flow);
    fold(flow, demand_);
}

/// A law's input below four points besides their ground: how much was taken, and what is left. kFresh: material may have
/// been left behind, that a law has not taken yet.
template <class Law, bool kFresh>
void Erosion::see_layer(const MeansOfFour& means, Double4 cosine, erosion::StateOf<Double4>& state) const {
    if constexpr (kFresh) state.lies = per_area_of_flow_ * cosine * means.of(fresh_)[0];
    const Double4 scale = per_area_ * cosine;
    if constexpr (Law::kSeesEroded) {
        const auto [initial, still] = means.of(initial_, left_);
        state.eroded = scale * (initial - still);
    }
    if constexpr (Law::kSeesLeft) state.left = scale * means.of(left_)[0] + state.lies;
}

namespace {

/// THEORY.md, section 20: what deposits below four points bear [Pa]: friction at rest has held them. The speed is along
/// the map. A thin layer bears less: what lies below it is felt.
Double4 strengths(const DragOfFour& drag, const BedStateOf<Double4>& bed, Double4 speed,
                  const erosion::StateOf<Double4>& s) {
    constexpr double kCreep = 0.01;     // [m/s]; what of the friction grows with the speed is nothing yet
    constexpr double kRounding = 1e-6;  // where friction does not depend on the speed, nothing is left above it
    constexpr double kThinnest = 0.01;  // of the flow, from which on a deposit bears all
    const Double4 one = all(1.0), held = drag.decelerations(bed, min(speed, all(kCreep)));
    const Double4 covers = min(s.lies / (kThinnest * s.thickness), one);
    return (1.0 + kRounding) * s.density * s.thickness * bed.kappa * covers * held;
}

/// What a node and its right neighbour have gained of velocity in the last grid update. Nodes without mass count as not
/// accelerated: the step has not written theirs.
[[gnu::always_inline]] inline Double4 gained_by_two(const Nodes& nodes, Index k) {
    const Double4 first = load(nodes.motions() + k), second = load(nodes.motions() + k + 1);
    const Double4 gained = Double4{first[0], first[1], second[0], second[1]} - load(&nodes.before[k]);
    const auto moving = [&](Index node) -> std::int64_t { return nodes.flags[node] & kMoving ? -1 : 0; };
    const std::int64_t a = moving(k), b = moving(k + 1);
    return select(Mask4{a, a, b, b}, gained, Double4{});
}

/// The nodes' acceleration by what they have gained, no more than changes the speed by three quarters. Points that have come
/// farther than a cell have none: the nodes around them may not be those that moved them. `speed2`: the square of theirs on
/// the map.
template <class Stretch>
[[gnu::always_inline]] inline void accelerate(Flight& f, const Flow& flow, const Pair* gained, const Stretch& stretch,
                                              Double4 x, Double4 y, Double4 speed2) {
    const double per_second = 1.0 / stretch.velocity_dt;
    const Int4 i = floor_positive(x + kTile), j = floor_positive(y + kTile);
    const Double4 none = {}, one = all(1.0), to_right = x + kTile - to_double(i), to_top = y + kTile - to_double(j);
    const Double4 b = to_right * (one - to_top), d = to_right * to_top;
    Double4 weights[4], sums[4];
    transpose((one - to_top) - b, b, to_top - d, d, weights);
    for (int lane = 0; lane < 4; ++lane) {
        const Pair* const node = gained + j[lane] * flow.grid.stride() + i[lane];
        const Double4 w = weights[lane], lower = {w[0], w[0], w[1], w[1]}, upper = {w[2], w[2], w[3], w[3]};
        sums[lane] = lower * load(node) + upper * load(node + flow.grid.stride());
    }
    Double4 parts[4];
    transpose(sums[0], sums[1], sums[2], sums[3], parts);
    f.ax = per_second * (parts[0] + parts[2]), f.ay = per_second * (parts[1] + parts[3]);
    constexpr double kMostChange = 0.75;
    const double reach = std::max(std::abs(stretch.middle), std::abs(stretch.whole - stretch.middle));
    const Mask4 near = speed2 * (stretch.step * stretch.step) <= flow.cell * flow.cell;
    f.ax = select(near, f.ax, none), f.ay = select(near, f.ay, none);
    const Double4 change2 = (reach * reach) * (f.ax * f.ax + f.ay * f.ay), most2 = (kMostChange * kMostChange) * speed2;
    const Mask4 much = change2 > most2;
    if (!any(much)) return;
    const Double4 share = select(much, sqrt(most2 / select(much, change2, one)), one);
    f.ax *= share, f.ay *= share;
}

/// From the place that a flight has come to when the step ends to that of the flight that takes its place.
template <class Stretch>
[[gnu::always_inline]] inline InFlight shift(const Grown& grown, const Stretch& stretch) {
    const double owed = stretch.owed, left = stretch.whole - owed;
    const InFlight &way = grown.way, &v = grown.velocity;
    return {way.own - left * v.own - owed,
            way.driven - left * v.driven + (0.5 * left * left + stretch.middle * owed - 0.5 * owed * owed)};
}

}  // namespace

/// Moves those of four points that are chosen back by (dx, dy) [m] unless ground ends there; returns how far [cells]. Notes
/// where all four were.
[[gnu::always_inline]] inline Double4 Erosion::set_back(Flow& flow, Index p, int lanes, Mask4 chosen, Double4 dx,
                                                        Double4 dy) {
    Particles& c = flow.particles;
    const Double4 x0 = load(&c.x[p], lanes), y0 = load(&c.y[p], lanes), none = {};
    const double per_cell = 1.0 / flow.cell;
    store(&from_x_[p], x0, lanes), store(&from_y_[p], y0, lanes);
    const Double4 x = x0 - dx * per_cell, y = y0 - dy * per_cell;
    const double x_max = static_cast<double>(flow.grid.nx() - 1), y_max = static_cast<double>(flow.grid.ny() - 1);
    chosen &= (x >= 0.0) & (x <= x_max) & (y >= 0.0) & (y <= y_max);
    if (flow.bed.has_exits)
        for (int lane = 0; lane < lanes; ++lane)
            if (chosen[lane] && flow.bed.exit[flow.grid.nearest(x[lane], y[lane])] != 0) chosen[lane] = 0;
    store(&c.x[p], select(chosen, x, x0), lanes), store(&c.y[p], select(chosen, y, y0), lanes);
    return select(chosen, max(abs(x - x0), abs(y - y0)), none);
}

/// What the grid update gave to the velocities of all nodes around points that may take something.
void Erosion::find_gained(const Flow& flow) {
    for_each_in_parallel(nodes_, [&](Index tile) {
        for_each_four_of(flow.grid, tile, kAllGroups, [&](Index k, Index, Index) {
            store(&gained_[k], gained_by_two(flow.nodes, k)), store(&gained_[k + 2], gained_by_two(flow.nodes, k + 2));
        });
    });
}

/// THEORY.md, section 18: growth along the flight since the last exchange, and the flight that begins where it ends.
template <class Law, class Drag, class Real, bool kFresh>
void Erosion::demand_of_tile(Flow& flow, Index n, const Stretch& stretch, const Law& law, Drag& drag) {
    Particles& c = flow.particles;
    const double dt = stretch.whole;
    const Carried<Real>& held = c.carried<Real>();
    constexpr bool kFeels = !std::is_same_v<std::remove_const_t<Drag>, Unfelt>;
    const double slowest = std::max(kSlowest, slowest_);
    Double4 farthest = {};
    for_each_four(flow.active.begin[n], flow.active.begin[n + 1], [&](Index p, int lanes) {
        const Double4 depth = load(&held.depth[p], lanes), none = {}, one = all(1.0);
        const Double4 vx = load(&held.vx[p], lanes), vy = load(&held.vy[p], lanes), speed2 = vx * vx + vy * vy;
        const Mask4 moves = (speed2 > slowest * slowest) & (depth >= min_depth_) & (depth > flow.dry_depth());
        if (!any(moves)) return store(&wanted_[p], none, lanes);
        const Double4 x = load(&c.x[p], lanes), y = load(&c.y[p], lanes), mass = load(&c.mass[p], lanes);
        const MeansOfFour means(flow.grid, x, y);
        if constexpr (kFeels) drag.move_to(x, y);
        // Those that rest do as if they moved: nothing comes of it.
        const Double4 ux = select(moves, vx, one), uy = select(moves, vy, none), deep = select(moves, depth, one);
        // A curved bed changes the weight alone, which only friction and laws of it use.
        GroundOfFour ground(flow, kFeels && curved_, means, ux, uy, deep);
        erosion::StateOf<Double4> state;
        state.density = flow.density, state.bed_density = density_, state.dt = dt;
        const Double4 thickness = ground.below.thickness, per_thickness = one / thickness;
        state.normal_gravity = ground.below.kappa * ground.below.normal_gravity;
        see_layer<Law, kFresh>(means, ground.below.cosine, state);
        if constexpr (Law::kSeesLeft) state.edge = sqrt(select(moves, mass / (flow.density * deep), one));
        Flight flight{ux, uy, none, none, stretch.middle};
        if (stretch.velocity_dt > 0.0)
            accelerate(flight, flow, gained_.data(), stretch, x, y, select(moves, speed2, one));
        const Double4 along = ground.below.kappa;
        const auto rates = [&](Double4 speed, Double4 gain) {
            state.speed = along * speed;
            const Double4 grown = 1.0 + gain;
            state.thickness = ground.below.thickness = thickness * grown;
            Rates now{none, none};
            if constexpr (kFeels) {
                const Double4 felt = drag.decelerations(ground.below, speed);
                if (momentum_ > 0.0) now.braking = grown * felt / speed;
                state.stress = flow.density * state.thickness * ground.below.kappa * felt;
                if constexpr (Law::kSeesStress && kFresh)
                    if (any(state.lies > none)) state.bears = strengths(drag, ground.below, speed, state);
            }
            now.growth = min(growth_rates(law, state, per_thickness), all(kMostGain / dt));
            return now;
        };
        const auto slowed = [&](Double4 gain, Double4 braked) {
            return kFeels && momentum_ > 0.0 ? one / speeds_left(gain, braked) : one + gain;
        };
        const Grown grown = grown_along<Law>(flight, dt, rates, slowed);
        const Mask4 grows = moves & (grown.gain > none);
        store(&wanted_[p], select(grows, grown.gain * mass, none), lanes);
        store(&speed_[p], ground.speed, lanes);
        if constexpr (kFeels)
            if (momentum_ > 0.0) store(&braked_[p], grown.braked, lanes);
        const InFlight v = grown.velocity, later = shift(grown, stretch);
        const Double4 extra = select(grows, v.driven - (dt - flight.middle), none);
        store(&extra_x_[p], extra * flight.ax, lanes), store(&extra_y_[p], extra * flight.ay, lanes);
        farthest = max(farthest, set_back(flow, p, lanes, grows, -flight.x(later), -flight.y(later)));
    });
    sums_[static_cast<std::size_t>(n)].max_shift = largest(farthest);
}

/// A point that gets the share `got` < 1 of its demand was set back too far by the rest. Where it gets nothing it is
/// where it was, to the last bit: an empty bed changes nothing.
void Erosion::return_part(Flow& flow, Index p, double got) {
    Particles& c = flow.particles;
    extra_x_[p] *= got, extra_y_[p] *= got;
    c.x[p] = from_x_[p] + got * (c.x[p] - from_x_[p]);
    c.y[p] = from_y_[p] + got * (c.y[p] - from_y_[p]);
}

/// THEORY (76): the share of its velocity that a point retains when it grows by `gain` of its mass. What is taken
/// brings at most the momentum that friction takes meanwhile, `braked` of the flow's own.
Double4 Erosion::speeds_left(Double4 gain, Double4 braked) const {
    const Double4 grown = 1.0 + gain;
    if (momentum_ == 0.0) return 1.0 / grown;
    Double4 brought = grown;
    if (momentum_ != 1.0)
        for (int lane = 0; lane < 4; ++lane) brought[lane] = std::pow(grown[lane], momentum_);
    return min(brought, 1.0 + braked) / grown;
}

}  // namespace frana
