#include "coupling/displaced.h"

#include <algorithm>

namespace frana {
namespace {

/// At most so much is moved to a cell, over what it holds. It is the height of the wave that is left, and chosen.
/// The ramp of a wall takes the room of one cell or a little more: it spreads over some thirty.
constexpr double kRise = 0.04;
constexpr int kMostSteps = 2000;  // reach grows with the root of them, to some sixty cells

}  // namespace

void Displaced::Load::add(const Load& from, double share) {
    mass += share * from.mass, energy += share * from.energy, level += share * from.level;
    momentum += share * from.momentum;
}

void Displaced::stay(const DepartedPoint& point, Index node, double ground) {
    Index& number = number_[static_cast<std::size_t>(node)];
    if (number < 0) {
        number = static_cast<Index>(cells_.size());
        cells_.emplace_back().node = node;
    }
    Cell& cell = cells_[static_cast<std::size_t>(number)];
    cell.own += point.mass;
    const double depth = 2.0 * (point.position.z() - ground);  // points stand half as high, on average
    cell.depth += point.mass * depth, cell.surface += point.mass * (ground + depth);
}

void Displaced::move(const DepartedPoint& point, double share, Index node) {
    Load& load = cells_[static_cast<std::size_t>(number_[static_cast<std::size_t>(node)])].load;
    load.mass += share * point.mass, load.energy += share * point.energy;
    load.momentum += share * point.mass * point.velocity.head<2>();
}

/// Pairs of cells side by side.
std::vector<std::pair<Index, Index>> Displaced::borders() const {
    std::vector<std::pair<Index, Index>> all;
    for (std::size_t n = 0; n < cells_.size(); ++n) {
        const Index node = cells_[n].node, i = node % grid_.nx, j = node / grid_.nx;
        const auto take = [&](bool there, Index other) {
            if (there && holds(other))
                all.emplace_back(static_cast<Index>(n), number_[static_cast<std::size_t>(other)]);
        };
        take(i + 1 < grid_.nx, node + 1);
        take(j + 1 < grid_.ny, node + grid_.nx);
    }
    return all;
}

/// The share of what was moved to a cell that goes on to another in a step [1]. A quarter over each of four borders is
/// all of it. Nothing goes up, to where the surface is higher than where it came from.
double Displaced::share_passing(const Cell& from, const Cell& to) const {
    constexpr double kQuarter = 0.25;
    const double more = from.load.mass / from.own - to.load.mass / to.own;
    if (!(more > 0.0) || to.surface * from.load.mass > from.load.level + kRise * to.depth * from.load.mass) return 0.0;
    return kQuarter * more * std::min(from.own, to.own) / from.load.mass;
}

void Displaced::spread() {
    for (Cell& cell : cells_) {
        cell.surface /= cell.own, cell.depth /= cell.own;
        cell.load.level = cell.load.mass * cell.surface;
    }
    const std::vector<std::pair<Index, Index>> pairs = borders();
    const auto is_high = [](const Cell& cell) { return cell.load.mass > kRise * cell.own; };
    std::vector<Load> next(cells_.size());
    for (int step = 0; step < kMostSteps && std::any_of(cells_.begin(), cells_.end(), is_high); ++step) {
        for (std::size_t n = 0; n < cells_.size(); ++n) next[n] = cells_[n].load;
        for (const auto& [one, other] : pairs) {
            const auto a = static_cast<std::size_t>(one), b = static_cast<std::size_t>(other);
            const auto pass = [&](std::size_t from, std::size_t to) {
                const double share = share_passing(cells_[from], cells_[to]);
                if (share == 0.0) return;
                next[from].add(cells_[from].load, -share), next[to].add(cells_[from].load, share);
            };
            pass(a, b), pass(b, a);
        }
        for (std::size_t n = 0; n < cells_.size(); ++n) cells_[n].load = next[n];
    }
}

/// Each point of a cell takes its part by mass.
DepartedPoint Displaced::joined(DepartedPoint point, Index node) const {
    const Cell& cell = cells_[static_cast<std::size_t>(number_[static_cast<std::size_t>(node)])];
    if (cell.load.mass == 0.0) return point;
    const double share = point.mass / cell.own, mass = point.mass + share * cell.load.mass;
    point.velocity.head<2>() = (point.mass * point.velocity.head<2>() + share * cell.load.momentum) / mass;
    point.energy += share * cell.load.energy;
    point.mass = mass;
    return point;
}

}  // namespace frana
