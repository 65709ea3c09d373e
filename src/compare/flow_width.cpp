#include "compare/flow_width.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

#include "base/round_number.h"

namespace frana {
namespace {

/// Footprint in the smallest rectangle around it, with a border of nodes that are not covered. Lengths in cells.
class Footprint {
public:
    Footprint(const Raster& depth, double limit) {
        const GridGeometry& g = depth.geometry;
        Index i0 = g.nx, i1 = -1, j0 = g.ny, j1 = -1;
        for (Index j = 0; j < g.ny; ++j)
            for (Index i = 0; i < g.nx; ++i)
                if (depth.at(i, j) > limit) {
                    i0 = std::min(i0, i), i1 = std::max(i1, i);
                    j0 = std::min(j0, j), j1 = std::max(j1, j);
                }
        if (i1 < 0) return;
        nx_ = i1 - i0 + 3, ny_ = j1 - j0 + 3;
        covered_.assign(static_cast<std::size_t>(nx_ * ny_), 0);
        for (Index j = j0; j <= j1; ++j)
            for (Index i = i0; i <= i1; ++i) covered_[at(i - i0 + 1, j - j0 + 1)] = depth.at(i, j) > limit;
        fill_small_holes();
        find_banks();
    }

    bool empty() const { return covered_.empty(); }

    /// Widths at all places of the middle.
    std::vector<double> widths() const {
        std::vector<double> found;
        for (Index j = 1; j + 1 < ny_; ++j)
            for (Index i = 1; i + 1 < nx_; ++i) {
                add_width_between({i, j}, {i + 1, j}, found);
                add_width_between({i, j}, {i, j + 1}, found);
            }
        add_rest(found);
        return found;
    }

private:
    using Node = std::pair<Index, Index>;

    std::size_t at(Index i, Index j) const { return static_cast<std::size_t>(j * nx_ + i); }
    bool covered(Index i, Index j) const { return covered_[at(i, j)] != 0; }
    /// Also of places beyond the border.
    bool covers(const Vec2& place) const {
        const Index i = std::lround(place.x()), j = std::lround(place.y());
        return i >= 0 && j >= 0 && i < nx_ && j < ny_ && covered(i, j);
    }

    void fill_small_holes() {
        constexpr std::size_t small = 9;  // nodes: three by three
        std::vector<char> seen = covered_;
        std::vector<std::size_t> hole;
        const std::array<Index, 4> adjacent{1, -1, nx_, -nx_};
        for (std::size_t start = 0; start < seen.size(); ++start) {
            if (seen[start]) continue;
            hole.assign(1, start);
            seen[start] = 1;
            for (std::size_t k = 0; k < hole.size(); ++k)
                for (const Index step : adjacent) {
                    const Index node = static_cast<Index>(hole[k]) + step;
                    if (node < 0 || node >= nx_ * ny_ || seen[static_cast<std::size_t>(node)]) continue;
                    seen[static_cast<std::size_t>(node)] = 1;
                    hole.push_back(static_cast<std::size_t>(node));
                }
            if (start != 0 && hole.size() <= small)  // the first is what is outside
                for (const std::size_t node : hole) covered_[node] = 1;
        }
    }

    /// The nearest node that is not covered, of each node. It is exact, by lower envelopes of parabolas (Felzenszwalb
    /// and Huttenlocher 2012), with the node that each parabola stands for.
    void find_banks() {
        bank_i_.assign(covered_.size(), 0);
        bank_j_.assign(covered_.size(), 0);
        for (Index i = 0; i < nx_; ++i) nearest_in_column(i);
        for (Index j = 0; j < ny_; ++j) nearest_of_columns(j);
    }

    void nearest_in_column(Index i) {
        const auto row = [&](Index j) -> std::int32_t& { return bank_j_[at(i, j)]; };
        for (Index j = 0; j < ny_; ++j) row(j) = covered(i, j) ? row(j - 1) : static_cast<std::int32_t>(j);
        for (Index j = ny_ - 2; j >= 0; --j)  // the border is not covered: there always is a next one
            if (std::abs(row(j + 1) - j) < std::abs(row(j) - j)) row(j) = row(j + 1);
    }

    void nearest_of_columns(Index j) {
        const std::vector<std::int32_t> row(bank_j_.begin() + j * nx_, bank_j_.begin() + (j + 1) * nx_);
        std::vector<Index> column;  // whose parabola is the lowest one, from the west
        std::vector<double> from;   // there
        const auto height = [&](Index i) {
            const auto way = static_cast<double>(row[static_cast<std::size_t>(i)] - j);
            return way * way + static_cast<double>(i * i);
        };
        for (Index i = 0; i < nx_; ++i) {
            double meet = -INFINITY;
            while (!column.empty()) {
                meet = (height(i) - height(column.back())) / static_cast<double>(2 * (i - column.back()));
                if (meet > from.back()) break;
                column.pop_back(), from.pop_back();
                meet = -INFINITY;
            }
            column.push_back(i), from.push_back(meet);
        }
        std::size_t k = 0;
        for (Index i = 0; i < nx_; ++i) {
            while (k + 1 < column.size() && from[k + 1] < static_cast<double>(i)) ++k;
            bank_i_[at(i, j)] = static_cast<std::int32_t>(column[k]);
            bank_j_[at(i, j)] = row[static_cast<std::size_t>(column[k])];
        }
    }

    Vec2 to_bank(const Node& node) const {
        const std::size_t k = at(node.first, node.second);
        return {static_cast<double>(bank_i_[k] - node.first), static_cast<double>(bank_j_[k] - node.second)};
    }

    void add_width_between(const Node& a, const Node& b, std::vector<double>& found) const {
        if (!covered(a.first, a.second) || !covered(b.first, b.second)) return;
        const Vec2 to_a = to_bank(a).normalized(), to_b = to_bank(b).normalized();
        constexpr double facing = -0.5;  // cosine of 120 degrees: the banks of a corner are 90 apart
        if (to_a.dot(to_b) > facing) return;
        const Vec2 middle(0.5 * static_cast<double>(a.first + b.first), 0.5 * static_cast<double>(a.second + b.second));
        found.push_back(section(middle, (to_a - to_b).normalized()));
    }

    /// What sections at the middle do not stand for, a cell of length each: no banks of a compact shape with corners face
    /// each other. It is as wide as the largest circle in the footprint, and as long as its area makes it.
    void add_rest(std::vector<double>& found) const {
        const auto area = static_cast<double>(std::count(covered_.begin(), covered_.end(), 1));
        const double rest = area - std::accumulate(found.begin(), found.end(), 0.0);
        Node deepest{0, 0};
        for (Index j = 1; j + 1 < ny_; ++j)
            for (Index i = 1; i + 1 < nx_; ++i)
                if (covered(i, j) && to_bank({i, j}).norm() > to_bank(deepest).norm()) deepest = {i, j};
        const Vec2 middle(static_cast<double>(deepest.first), static_cast<double>(deepest.second));
        const Vec2 across = to_bank(deepest).normalized();  // or, at the end of something narrow, along it
        const double width = std::min(section(middle, across), section(middle, {-across.y(), across.x()}));
        if (rest >= width) found.insert(found.end(), static_cast<std::size_t>(rest / width), width);
    }

    /// Mean length of the sections through places around the middle: one alone sees single steps of the edge.
    double section(const Vec2& middle, const Vec2& across) const {
        constexpr int each_side = 6;
        constexpr double apart = 0.25;
        const Vec2 along(-across.y(), across.x());
        double sum = 0.0;
        int count = 0;
        for (int k = -each_side; k <= each_side; ++k) {
            const Vec2 start = middle + apart * k * along;
            if (!covers(start)) continue;
            sum += way_out(start, across) + way_out(start, -across);
            ++count;
        }
        return sum / std::max(count, 1);
    }

    /// Distance to the edge of the covered pixels. Steps are as long as the nearest bank is far, less the two
    /// halves of a pixel's diagonal.
    double way_out(const Vec2& start, const Vec2& along) const {
        constexpr double step = 0.05, diagonal = 1.5;
        for (double way = 0.0;;) {
            const Vec2 here = start + way * along;
            const Node node{std::lround(here.x()), std::lround(here.y())};
            if (!covered(node.first, node.second)) return std::max(0.0, way - 0.5 * step);
            way += std::max(step, to_bank(node).norm() - diagonal);
        }
    }

    Index nx_ = 0, ny_ = 0;
    std::vector<char> covered_;
    std::vector<std::int32_t> bank_i_, bank_j_;
};

}  // namespace

double flow_width(const Raster& depth, double limit) {
    const Footprint footprint(depth, limit);
    if (footprint.empty()) return Raster::nodata;
    std::vector<double> widths = footprint.widths();
    if (widths.empty()) return depth.geometry.cell;
    const auto middle = widths.begin() + static_cast<std::ptrdiff_t>(widths.size() / 2);
    std::nth_element(widths.begin(), middle, widths.end());
    return *middle * depth.geometry.cell;
}

double cell_that_resolves(double width) { return round_number_below(width / least_cells_across); }

std::string width_remark(double width, double cell, bool particles) {
    if (!(width < least_cells_across * cell)) return "";
    // Just below the limit two digits would be the limit's own.
    constexpr double digits = 100.0, two_digits_differ = 0.05;
    const bool near = width / cell > least_cells_across - two_digits_differ;
    const double cells = near ? std::floor(digits * width / cell) / digits : width / cell;
    return fmt::format(
        "the flow is {:.{}g} cells wide ({:.{}g} m, median over its length); expected {:g} or more, or its path and "
        "runout hang on the grid{}; grid.cell = {:g} would do",
        cells, near ? 3 : 2, near ? cells * cell : width, near ? 4 : 3, least_cells_across,
        particles ? ", and by a few cells on particles.per_cell (frana converge --per-cell 4,9,16 measures it)" : "",
        cell_that_resolves(width));
}

}  // namespace frana
