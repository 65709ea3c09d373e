#include "checks/fuzz/invariants.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/compensated_sum.h"
#include "observe/budget.h"
#include "observe/status_numbers.h"

namespace frana::fuzz {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kInfinite = std::numeric_limits<double>::infinity();

double sum_of(const std::vector<double>& values) {
    CompensatedSum sum;
    for (const double value : values) sum.add(value);
    return sum.value();
}

/// Mass of points whose sub-points an open side may hold back [kg]: those within 3/4 of a cell (shallow/sub_points.h).
double near_open_sides(const Facts& facts, const PointStates& points) {
    if (facts.walls) return 0.0;
    constexpr double kReach = 0.75;
    const double x_max = static_cast<double>(facts.nodes_x - 1), y_max = static_cast<double>(facts.nodes_y - 1);
    CompensatedSum sum;
    for (std::size_t p = 0; p < points.mass.size(); ++p) {
        const double x = points.x[p], y = points.y[p];
        if (std::min({x, y, x_max - x, y_max - y}) < kReach) sum.add(points.mass[p]);
    }
    return sum.value();
}

/// What the depths of nodes could set free [J].
double depth_energy(const Facts& facts, const std::vector<NodeState>& nodes) {
    CompensatedSum sum;
    for (const NodeState& node : nodes)
        sum.add(0.5 * facts.density * facts.cell * facts.cell * facts.gravity * node.depth * node.depth);
    return sum.value();
}

/// Work of gravity on all that climbs, by half a step more than it has lost [J].
double half_a_step_up(const Facts& facts, const Snapshot& state) {
    const PointStates& points = state.points;
    CompensatedSum sum;
    for (std::size_t p = 0; p < points.mass.size(); ++p) {
        const double along = points.speed[p], map2 = points.vx[p] * points.vx[p] + points.vy[p] * points.vy[p];
        sum.add(points.mass[p] * std::sqrt(std::max(0.0, along * along - map2)));
    }
    return 0.5 * state.now.dt * facts.gravity * sum.value();
}

}  // namespace

const std::vector<std::string>& invariant_names() {
    static const std::vector<std::string> names = {"finite", "positive", "mass",     "momentum", "energy",
                                                   "speed",  "head",     "rest",     "symmetry", "threads",
                                                   "resume", "clock",    "numerics", "program"};
    return names;
}

Watch::Watch(const Facts& facts, const Snapshot& start) : facts_(facts), start_(start) {
    mass_ = facts.all_in_points ? sum_of(start.points.mass) : start.now.mass;
    most_mass_ = mass_;
    highest_ = std::max(facts.highest_rain, facts.highest_inflow), lowest_ = foot_ = kInfinite;
    at_hand_ = start.now.kinetic + facts.release_energy;
    if (facts.structured) facts_.hidden_energy = std::max(0.0, facts.release_energy - depth_energy(facts, start.nodes));
    deepest_ = facts.release_depth;
    for (std::size_t p = 0; p < start.points.mass.size(); ++p)
        if (start.points.in_3d[p]) highest_ = std::max(highest_, start.points.z[p]);
    for (const NodeState& node : start.nodes)
        if (node.wet) highest_ = std::max({highest_, node.surface, node.bed + facts.release_depth});
    note_extremes(start);
}

void Watch::note_extremes(const Snapshot& state) {
    for (const NodeState& node : state.nodes) {
        if (node.wet) {
            lowest_ = std::min(lowest_, node.bed), foot_ = std::min(foot_, node.foot);
            deepest_ = std::max(deepest_, node.depth);
        }
        fastest_ = std::max(fastest_, node.speed);
    }
    if (facts_.carried_depth)
        for (const double depth : state.points.depth) deepest_ = std::max(deepest_, depth);
    for (const double change : state.points.change)
        if (facts_.affine) change_ = std::max(change_, change);
    for (const double own : state.points.own) change_ = std::max(change_, own);
    for (const double speed : state.points.speed) fastest_ = std::max(fastest_, speed);
    most_mass_ = std::max(most_mass_, state.now.mass);
    // What trees took within its first step has been fast on the map alone.
    fastest_ = std::max({fastest_, state.max_speed, state.between.max_speed, state.between.max_speed_on_map});
    turned_over_ = std::max({turned_over_, state.now.kinetic, state.now.dissipated - start_.now.dissipated,
                             std::abs(state.now.potential - start_.now.potential)});
    points_ = std::max(points_, state.points.count());
    if (!facts_.all_in_points) most_nodes_ = std::max(most_nodes_, static_cast<Index>(state.nodes.size()));
}

std::optional<Violation> Watch::judged(const char* invariant, double value, double allowed, const Snapshot& state,
                                       const std::string& what) {
    const double ratio = allowed > 0.0 ? value / allowed : value > 0.0 ? kInfinite : 0.0;
    double& worst = worst_[invariant];
    worst = std::max(worst, ratio);
    if (ratio <= 1.0) return std::nullopt;
    return Violation{invariant, ratio, state.now.step, state.now.time,
                     fmt::format("{}: found {:.6g}, at most {:.6g} is allowed", what, value, allowed)};
}

std::optional<Violation> Watch::observe(const Snapshot& state) {
    if (auto broken = finite(state)) return broken;  // the others would compare with what is no number
    note_extremes(state);
    std::optional<Violation> first;
    for (const auto check : {&Watch::positive, &Watch::mass, &Watch::momentum, &Watch::energy, &Watch::speed,
                             &Watch::head, &Watch::rest, &Watch::symmetry}) {
        auto broken = (this->*check)(state);
        if (!first) first = std::move(broken);
    }
    return first;
}

std::optional<Violation> Watch::finite(const Snapshot& state) {
    Index bad = state.not_finite;
    const auto sample = [&](double value) { bad += !std::isfinite(value); };
    const PointStates& points = state.points;
    for (const auto* array : {&points.x, &points.y, &points.z, &points.vx, &points.vy, &points.speed, &points.mass,
                              &points.depth, &points.change, &points.own})
        for (const double value : *array) sample(value);
    for (const NodeState& node : state.nodes)
        for (const double value : {node.depth, node.surface, node.vx, node.vy, node.speed}) sample(value);
    for (Status status : {state.between, state.now})
        for (const double* value : numbers_of(status)) sample(*value);
    sample(state.max_speed);
    return judged("finite", static_cast<double>(bad), 0.0, state, "numbers that are not finite");
}

std::optional<Violation> Watch::positive(const Snapshot& state) {
    Index bad = 0;
    for (const double m : state.points.mass) bad += !(m > 0.0);
    for (const NodeState& node : state.nodes) bad += node.wet ? !(node.depth > 0.0) : !(node.depth >= 0.0);
    const Status::Bed& bed = state.between.bed;  // what gave more than it had lies below its rock
    bad += !(bed.mass >= 0.0 && bed.eroded >= 0.0 && bed.deposited >= 0.0);
    return judged("positive", static_cast<double>(bad), 0.0, state, "masses or depths that are not positive");
}

std::optional<Violation> Watch::mass(const Snapshot& state) {
    const double present = facts_.all_in_points ? sum_of(state.points.mass) : state.between.mass;
    const Status::Bed& bed = state.between.bed;
    const double of_bed = bed.mass - bed.initial, came = state.between.mass_in - start_.between.mass_in;
    const double error = std::abs(present + state.between.mass_left + of_bed - came - mass_);
    double share = 0.5 * kEps * static_cast<double>(points_ + state.between.step);
    if (!facts_.all_in_points) share = std::max(share, kMassShare);
    if (came > 0.0) share = std::max(share, kMassShare);     // rows sum up to the table, to round-off
    if (facts_.erodes) share = std::max(share, kMassShare);  // nodes lose what points gain, to round-off of the sums
    const double allowed = share * (most_mass_ + std::abs(state.between.mass_left) + bed.initial);
    return judged("mass", error, allowed, state, "mass lost or gained [kg]");
}

std::optional<Violation> Watch::momentum(const Snapshot& state) {
    // A step rounds each point's velocity some ten times, half of them on the way to the nodes.
    const double roundings =
        16.0 * static_cast<double>(state.between.step + 10) + static_cast<double>(points_ + most_nodes_);
    double speed = fastest_;
    if (facts_.cancels) speed += facts_.gravity * state.now.time + std::sqrt(facts_.gravity * deepest_);
    const double allowed = kEps * most_mass_ * speed * roundings;  // two sums over points, half a unit each time
    std::optional<Violation> first;
    for (const auto& [from, to] : {std::pair{&start_.between, &state.between}, std::pair{&start_.now, &state.now}}) {
        const Budget left = budget(*from, *to);
        const double residual = std::hypot(left.momentum_residual[0], left.momentum_residual[1]);
        auto broken = judged("momentum", residual, allowed, state, "momentum that no force gave [kg m/s]");
        if (!first) first = std::move(broken);
    }
    return first;
}

double Watch::slope_uphill() const { return std::min(facts_.steepest, deepest_ / facts_.cell); }

std::optional<Violation> Watch::energy(const Snapshot& state) {
    if (!(facts_.energy_law || facts_.bed_energy) || (facts_.linear && !facts_.claims.resolved)) return std::nullopt;
    if (facts_.turn * facts_.turn > kEnergyShare || facts_.virtual_mass) return std::nullopt;
    const Status &first = start_.now, &now = state.now;
    const double growth = (now.kinetic - first.kinetic) + (now.potential - first.potential) +
                          (now.stored - first.stored) + (now.energy_left - first.energy_left) -
                          (now.bed.energy - first.bed.energy);
    // What leaves is recorded with the bed of the nearest node, half a cell away at most.
    const double held_back = near_open_sides(facts_, start_.points) + near_open_sides(facts_, state.points);
    const double recorded =
        facts_.gravity * ((std::abs(now.mass_left) + now.mass_in - first.mass_in) * (facts_.one_cell_drop + deepest_) +
                          held_back * facts_.one_cell_drop);
    const double round_off = kEps * static_cast<double>(points_ + most_nodes_) * std::abs(first.potential);
    const double bends = mass_ * facts_.gravity * facts_.one_cell_bend;
    const double slope = slope_uphill();
    const double gone = now.energy_left - first.energy_left - now.mass_left * facts_.gravity * lowest_;
    const double uphill = slope * slope / (1.0 + slope * slope) * (now.kinetic + std::max(0.0, gone));
    // Half of water's cells at walls lies beyond them, and particles displace water there too.
    const double beyond_walls = facts_.walls ? deepest_ : 0.0;
    const double lifted =
        facts_.displaces * (facts_.one_cell_drop + (1.0 - facts_.bears) * (highest_ - lowest_) + beyond_walls);
    // Points take from nodes around them, and leave material there. The bed is bent by what is gone or has been left.
    const double moved = now.bed.eroded + now.bed.deposited - first.bed.eroded - first.bed.deposited;
    const double bent = now.bed.deepest + (now.bed.deposited > 0.0 ? deepest_ : 0.0);
    const double exchanged =
        facts_.bed_energy
            ? facts_.gravity * (moved * (facts_.one_cell_drop + now.bed.deepest + deepest_) + most_mass_ * bent)
            : 0.0;
    const double share = kEnergyShare * (at_hand_ + turned_over_);
    const double late = facts_.structured ? half_a_step_up(facts_, state) : 0.0;
    return judged("energy", growth,
                  facts_.hidden_energy + share + uphill + recorded + bends + lifted + exchanged + late + round_off,
                  state, "mechanical energy gained beyond the work of gravity [J]");
}

double Watch::beyond(double bound) const {
    if (facts_.carried_depth) return 1.0;
    return bound > 0.0 ? std::clamp(change_ / bound, kConvergence, 1.0) : kConvergence;
}

std::optional<Violation> Watch::speed(const Snapshot& state) {
    if (facts_.virtual_mass) return std::nullopt;
    const double uphill = facts_.energy_law ? std::hypot(1.0, slope_uphill()) : 1.0;  // otherwise in `stretch`
    const double wave =
        std::max(start_.fastest(), facts_.inflow_speed) + 2.0 * uphill * std::sqrt(facts_.gravity * deepest_);
    const double drop = std::max(0.0, highest_ - foot_) + facts_.drained_drop;
    const double bound = facts_.stretch * facts_.stretch * std::sqrt(wave * wave + 2.0 * facts_.gravity * drop);
    return judged("speed", state.max_speed, (1.0 + beyond(bound)) * bound, state, "speed beyond the energy line [m/s]");
}

/// The point that is farthest beyond; in units of what its place allows.
std::optional<Violation> Watch::head(const Snapshot& state) {
    if (!facts_.in_3d) return std::nullopt;
    const double steep = facts_.stretch * facts_.stretch * (1.0 + kConvergence);
    constexpr double kBlow = 3.0;  // of the speed that heavy and light come with
    const double front = 2.0 * std::sqrt(facts_.gravity * deepest_),
                 blow = kBlow * std::max(start_.fastest(), facts_.inflow_speed) + front;
    const double wave = std::max(steep * (std::max(start_.fastest(), facts_.inflow_speed) + front), blow);
    const double share = std::max(kEnergyShare, facts_.stretch > 1.0 ? steep * steep - 1.0 : 0.0);
    double worst = 0.0, found = 0.0, allowed = 1.0;
    for (std::size_t p = 0; p < state.points.mass.size(); ++p) {
        if (!state.points.in_3d[p]) continue;
        const double z = state.points.z[p], fall = std::max(0.0, highest_ - z);
        const double above = z - highest_ + 0.5 * state.points.speed[p] * state.points.speed[p] / facts_.gravity;
        const double most = 0.5 * wave * wave / facts_.gravity + share * fall + facts_.cell_3d + facts_.one_cell_drop;
        if (above <= worst * most) continue;
        worst = above / most, found = above, allowed = most;
    }
    return judged("head", found, allowed, state, "z + v^2 / 2g of a 3D point above the start's surface [m]");
}

std::optional<Violation> Watch::rest(const Snapshot& state) {
    if (!facts_.claims.rests) return std::nullopt;
    const PointStates &a = start_.points, &b = state.points;
    double fastest = 0.0;
    for (const auto* component : {&b.vx, &b.vy})
        for (const double v : *component) fastest = std::max(fastest, std::abs(v));
    if (facts_.lake) {
        const bool level = facts_.level_error <= facts_.level_round_off;
        const double factor = level ? 1.0 : (1.0 + kConvergence) * facts_.stretch * facts_.stretch;
        const double high = level ? facts_.level_round_off : facts_.level_error;
        return judged("rest", fastest, factor * 2.0 * std::sqrt(facts_.gravity * high), state,
                      "speed of a lake, beyond that of a dam break as high as its surface is off the level [m/s]");
    }
    const bool moved = a.id == b.id && (a.x != b.x || a.y != b.y);  // what splits stands elsewhere and has not moved
    return judged("rest", moved ? std::max(fastest, 1e-300) : fastest, 0.0, state, "speed of what should rest [m/s]");
}

double asymmetry(const Facts& facts, const std::vector<NodeState>& nodes, const Scale& scale) {
    const Index width = std::max(facts.nodes_x, facts.nodes_y);
    std::map<Index, const NodeState*> at;
    for (const NodeState& node : nodes) at[node.j * width + node.i] = &node;
    const auto [depth, speed] = scale;
    double worst = 0.0;
    for (const NodeState& node : nodes) {
        Index i = node.i, j = node.j;
        double vx = node.vx, vy = node.vy;
        if (facts.claims.mirror == Mirror::x) i = facts.nodes_x - 1 - i, vx = -vx;
        if (facts.claims.mirror == Mirror::y) j = facts.nodes_y - 1 - j, vy = -vy;
        if (facts.claims.mirror == Mirror::diagonal) std::swap(i, j), std::swap(vx, vy);
        const auto found = at.find(j * width + i);
        const NodeState image = found == at.end() ? NodeState{} : *found->second;
        // Momentum, not velocity: that of a node with next to no mass is the quotient of two round-offs.
        worst = std::max({worst, std::abs(image.depth - node.depth) / depth,
                          std::abs(image.depth * image.vx - node.depth * vx) / (depth * speed),
                          std::abs(image.depth * image.vy - node.depth * vy) / (depth * speed)});
    }
    return worst;
}

Scale Watch::scale(Index step) const {
    const double depth = std::max(deepest_, 1e-300), roundings = 16.0 * static_cast<double>(step + 10);
    const double cancels = kEps * roundings * std::sqrt(facts_.gravity * depth);
    return {depth, std::max(fastest_ + cancels / kMirrorError, 1e-300)};
}

std::optional<Violation> Watch::symmetry(const Snapshot& state) {
    if (facts_.claims.mirror == Mirror::none) return std::nullopt;
    return judged("symmetry", asymmetry(facts_, state.nodes, scale(state.between.step)), kMirrorError, state,
                  "difference of mirrored nodes over the largest [1]");
}

void Watch::part() {
    facts_.claims.mirror = Mirror::none;
    worst_["symmetry"] = 1.0;
}

}  // namespace frana::fuzz
