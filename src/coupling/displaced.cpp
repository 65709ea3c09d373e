#include "coupling/displaced.h"

#include <algorithm>

namespace frana {
namespace {

/// At most so much is moved to a cell, over what it holds. It is the height of the wave that is left, and chosen.
/// The ramp of a wall takes the room of one cell or a little more: it spreads over some thirty.
constexpr double kRise = 0.04;
constexpr int kMostSteps = 2000;  // reach grows with the root of them, to some sixty cells
// Of the first rise: what passes when nothing spreads any more, and what is not worth passing.
constexpr double kStill = 1e-5, kNothing = 1e-7;

}  // namespace

void Displaced::Load::add(const Load& from, double share) {
    mass += share * from.mass, energy += share * from.energy;
    level += share * from.level, lift += share * from.lift;
    momentum += share * from.momentum;
}

bool Displaced::Cell::is_high() const { return rise > kRise * std::max(0.0, depth) && load.mass * rise > load.lift; }

/// The number of a node's cell, opened if it is not there. Cells at the sides are halves.
Index Displaced::cell_of(Index node, double ground) {
    Index& number = number_[static_cast<std::size_t>(node)];
    if (number >= 0) return number;
    number = static_cast<Index>(cells_.size());
    const auto width = [&](Index k, Index count) {
        return count > 1 && (k == 0 || k + 1 == count) ? 0.5 * grid_.cell : grid_.cell;
    };
    Cell& cell = cells_.emplace_back();
    cell.node = node, cell.surface = ground, cell.adjacent = adjacent_to(node);
    cell.per_height = density_ * width(node % grid_.nx, grid_.nx) * width(node / grid_.nx, grid_.ny);
    return number;
}

void Displaced::stay(const DepartedPoint& point, Index node, double ground) {
    if (!(point.mass > 0.0)) return;
    Cell& cell = cells_[static_cast<std::size_t>(cell_of(node, ground))];
    cell.own += point.mass;
    const double depth = 2.0 * (point.position.z() - ground);  // points stand half as high, on average
    const double share = point.mass / cell.own;
    cell.depth += share * (depth - cell.depth), cell.surface += share * (ground + depth - cell.surface);
}

bool Displaced::holds(Index node) const {
    const Index number = number_[static_cast<std::size_t>(node)];
    return number >= 0 && cells_[static_cast<std::size_t>(number)].own > 0.0;
}

void Displaced::move(const DepartedPoint& point, double share, Index node) {
    constexpr double kShallow = 0.5;  // of the height where the point was
    Cell& cell = cells_[static_cast<std::size_t>(cell_of(node, ground_(node)))];
    const double mass = share * point.mass, height = point.position.z() - (cell.surface - cell.depth);
    cell.load.mass += mass, cell.rise = cell.load.mass / cell.per_height;
    cell.load.energy += share * point.energy;
    cell.load.momentum += mass * point.velocity.head<2>();
    cell.load.level += mass * cell.surface;
    if (cell.depth < kShallow * height) cell.load.lift += mass * (height - cell.depth);
}

/// The nodes adjacent to a node, or -1.
std::array<Index, 4> Displaced::adjacent_to(Index node) const {
    const Index i = node % grid_.nx, j = node / grid_.nx;
    return {i > 0 ? node - 1 : -1, i + 1 < grid_.nx ? node + 1 : -1, j > 0 ? node - grid_.nx : -1,
            j + 1 < grid_.ny ? node + grid_.nx : -1};
}

/// By how much one cell's load would rise over another's, as far as it may flow there [m]. Nothing goes up. Where what
/// stays is higher than where the load came from, by more than a wave, the surfaces with their loads count too.
double Displaced::rise_passing(const Cell& from, const Cell& to) {
    const double more = from.rise - to.rise;
    if (!(more > 0.0)) return 0.0;
    const bool is_up =
        !(to.own > 0.0) || to.surface * from.load.mass > from.load.level + kRise * to.depth * from.load.mass;
    return is_up ? std::min(more, from.surface - to.surface + more) : more;
}

/// The number of the cell adjacent to a cell, or -1. Dry ground is reached from a cell that has too much.
Index Displaced::open_adjacent(std::size_t cell, Index node) {
    if (node < 0) return -1;
    const Index there = number_[static_cast<std::size_t>(node)];
    if (there >= 0 || !cells_[cell].is_high()) return there;
    const double ground = ground_(node);
    return ground < cells_[cell].surface + cells_[cell].rise ? cell_of(node, ground) : -1;
}

/// What goes on from a cell in a step, where it raises more than `least`. A quarter over each of four borders is all of
/// it. Returns the largest rise if the cell has too much [m].
double Displaced::pass(std::size_t from, double least, std::vector<Index>& loaded) {
    constexpr double kQuarter = 0.25;
    double most = 0.0;
    const std::array<Index, 4> adjacent = cells_[from].adjacent;
    for (const Index node : adjacent) {
        const Index number = open_adjacent(from, node);
        if (number < 0) continue;
        Cell &giver = cells_[from], &taker = cells_[static_cast<std::size_t>(number)];
        const double rise = kQuarter * rise_passing(giver, taker);
        if (!(rise > least)) continue;
        most = std::max(most, rise);
        const double share = rise * std::min(giver.per_height, taker.per_height) / giver.load.mass;
        if (!std::exchange(taker.is_listed, true)) loaded.push_back(number);
        giver.change.add(giver.load, -share), taker.change.add(giver.load, share);
    }
    return cells_[from].is_high() ? most : 0.0;
}

int Displaced::spread() {
    std::vector<Index> loaded;
    double first = 0.0;
    for (std::size_t n = 0; n < cells_.size(); ++n) {
        if (!(cells_[n].load.mass > 0.0)) continue;
        loaded.push_back(static_cast<Index>(n)), cells_[n].is_listed = true;
        first = std::max(first, cells_[n].rise);
    }
    int step = 0;
    for (double most = first; step < kMostSteps && most > kStill * first; ++step) {
        most = 0.0;
        const std::size_t count = loaded.size();
        for (std::size_t k = 0; k < count; ++k)
            most = std::max(most, pass(static_cast<std::size_t>(loaded[k]), kNothing * first, loaded));
        for (const Index n : loaded) {
            Cell& cell = cells_[static_cast<std::size_t>(n)];
            cell.load.add(cell.change, 1.0), cell.change = {};
            cell.rise = cell.load.mass / cell.per_height;
        }
    }
    return step;
}

/// Each point of a cell takes its part by mass.
DepartedPoint Displaced::joined(DepartedPoint point, Index node) const {
    const Index number = number_[static_cast<std::size_t>(node)];
    if (number < 0) return point;
    const Cell& cell = cells_[static_cast<std::size_t>(number)];
    if (cell.load.mass == 0.0 || cell.is_laid()) return point;
    const double share = point.mass / cell.own, mass = point.mass + share * cell.load.mass;
    point.velocity.head<2>() = (point.mass * point.velocity.head<2>() + share * cell.load.momentum) / mass;
    point.energy += share * cell.load.energy;
    point.mass = mass;
    return point;
}

std::vector<DepartedPoint> Displaced::laid(double time) const {
    constexpr double kQuarter = 0.25, kHalf = 0.5;
    std::vector<DepartedPoint> points;
    for (const Cell& cell : cells_) {
        if (!cell.is_laid()) continue;
        const Index i = cell.node % grid_.nx, j = cell.node / grid_.nx;
        DepartedPoint point{};
        point.velocity.setZero(), point.gradient.setZero();
        point.time = time, point.mass = kQuarter * cell.load.mass, point.energy = kQuarter * cell.load.energy;
        point.velocity.head<2>() = cell.load.momentum / cell.load.mass;
        for (const double dx : {-kQuarter, kQuarter})
            for (const double dy : {-kQuarter, kQuarter}) {
                const double x = grid_.x(i) + dx * grid_.cell, y = grid_.y(j) + dy * grid_.cell;
                point.position = {std::clamp(x, grid_.x0, grid_.x_max()), std::clamp(y, grid_.y0, grid_.y_max()),
                                  cell.surface + kHalf * cell.rise};
                points.push_back(point);
            }
    }
    return points;
}

}  // namespace frana
