#include "terrain/outline_area.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"

namespace frana {

double ring_area(const std::vector<Vec2>& ring) {
    double twice = 0.0;
    for (std::size_t k = 0; k < ring.size(); ++k) {
        // Relative to the first vertex, so that large map coordinates do not cancel.
        const Vec2 a = ring[k] - ring[0], b = ring[(k + 1) % ring.size()] - ring[0];
        twice += a.x() * b.y() - b.x() * a.y();
    }
    return 0.5 * twice;
}

OutlineArea::OutlineArea(const Rings& rings, std::vector<double> x_lines, std::vector<double> y_lines)
    : x_(std::move(x_lines)), y_(std::move(y_lines)) {
    expect(x_.size() >= 2 && y_.size() >= 2, "an outline needs a grid of at least one cell");
    height_.assign(x_.size() - 1, 0.0);
    const double extent = std::max(std::abs(y_.front()), std::abs(y_.back()));
    tolerance_ = 16.0 * std::numeric_limits<double>::epsilon() * extent;
    for (const auto& ring : rings)
        for (std::size_t k = 0; k < ring.size(); ++k) add_edge(ring[k], ring[(k + 1) % ring.size()]);
    sort_by_row();
}

void OutlineArea::add_edge(const Vec2& a, const Vec2& b) {
    const bool up = b.y() > a.y();
    const Vec2& low = up ? a : b;
    const Vec2& high = up ? b : a;
    const double top = std::min(high.y(), y_.back());
    double y = std::max(low.y(), y_.front());
    if (!(y < top)) return;
    const double slope = (high.x() - low.x()) / (high.y() - low.y());
    const auto x_at = [&](double where) {
        if (where == high.y()) return high.x();
        const double x = low.x() + (where - low.y()) * slope;
        return std::clamp(x, std::min(low.x(), high.x()), std::max(low.x(), high.x()));
    };
    double x = x_at(y);
    Index row = std::upper_bound(y_.begin(), y_.end(), y) - y_.begin() - 1;
    for (; y < top; ++row) {
        const double next_y = std::min(y_[row + 1], top);
        const double next_x = x_at(next_y);
        add_piece(row, x, y, next_x, next_y,
                  up ? -1.0 : 1.0);  // left sides of a counter-clockwise ring go down
        x = next_x;
        y = next_y;
    }
}

void OutlineArea::add_piece(Index row, double xa, double ya, double xb, double yb, double sign) {
    const double height = yb - ya;
    const double left = std::min(xa, xb), right = std::max(xa, xb);
    if (left >= x_.back()) return;
    if (right <= x_.front()) return record(row, 0, sign * height, x_.front());
    Index column = std::upper_bound(x_.begin(), x_.end(), left) - x_.begin() - 1;
    if (column >= 0 && right <= x_[column + 1]) return record(row, column, sign * height, 0.5 * (left + right));

    const double rise = height / (right - left);
    double x = left, y = 0.0;
    if (column < 0) {  // the part left of the grid acts on whole rows, as if it stood on the first line
        x = x_.front();
        y = (x - left) * rise;
        record(row, 0, sign * y, x);
        column = 0;
    }
    for (; x < right && x < x_.back(); ++column) {
        const double next_x = std::min(x_[column + 1], right);
        const double next_y = next_x == right ? height : (next_x - left) * rise;
        record(row, column, sign * (next_y - y), 0.5 * (x + next_x));
        x = next_x;
        y = next_y;
    }
}

void OutlineArea::record(Index row, Index column, double height, double mean_x) {
    pieces_.push_back({row, column, height, height * (x_[column + 1] - mean_x)});
}

void OutlineArea::sort_by_row() {
    row_start_.assign(y_.size(), 0);
    for (const Piece& piece : pieces_) ++row_start_[piece.row + 1];
    for (std::size_t j = 1; j < row_start_.size(); ++j) row_start_[j] += row_start_[j - 1];
    std::vector<Piece> sorted(pieces_.size());
    std::vector<std::size_t> next(row_start_.begin(), row_start_.end() - 1);
    for (const Piece& piece : pieces_) sorted[next[piece.row]++] = piece;
    pieces_ = std::move(sorted);
}

double OutlineArea::checked(double area, double cell, Index i, Index j, double tolerance) {
    if (std::abs(area) <= tolerance) return 0.0;
    if (std::abs(area - cell) <= tolerance) return cell;
    // Round-off of crossings in very thin cells ends here too; the caller judges the sums against the whole
    // area.
    if (area < 0.0) {
        faults_.negative -= area;
        faults_.negative_at = Vec2(0.5 * (x_[i] + x_[i + 1]), 0.5 * (y_[j] + y_[j + 1]));
        return 0.0;
    }
    if (area > cell) {
        faults_.overlap += area - cell;
        return cell;
    }
    return area;
}

std::pair<Index, Index> OutlineArea::row(Index j, std::vector<double>& area) {
    const std::size_t begin = row_start_[j], end = row_start_[j + 1];
    if (begin == end) return {0, 0};
    Index first = pieces_[begin].column, last = first;
    for (std::size_t k = begin; k < end; ++k) {
        first = std::min(first, pieces_[k].column);
        last = std::max(last, pieces_[k].column);
    }
    const Index columns = static_cast<Index>(height_.size());
    std::fill(area.begin() + first, area.begin() + last + 1, 0.0);
    std::fill(height_.begin() + first, height_.begin() + last + 1, 0.0);
    for (std::size_t k = begin; k < end; ++k) {
        area[pieces_[k].column] += pieces_[k].area;
        height_[pieces_[k].column] += pieces_[k].height;
    }
    const double full = y_[j + 1] - y_[j];
    double height = 0.0;  // of what stands to the left of the column
    for (Index i = first; i < columns; ++i) {
        if (std::abs(height) <= tolerance_) height = 0.0;
        if (std::abs(height - full) <= tolerance_) height = full;
        if (i > last && height == 0.0) return {first, i};
        const double width = x_[i + 1] - x_[i];
        const double own = i <= last ? area[i] : 0.0;
        area[i] = checked(own + height * width, full * width, i, j, tolerance_ * width);
        if (i <= last) height += height_[i];
    }
    return {first, columns};
}

Rings rings_of(const Polygons& polygons, const Vec2& origin) {
    Rings rings;
    for (const Polygon& polygon : polygons.parts)
        for (std::size_t n = 0; n < polygon.rings.size(); ++n) {
            std::vector<Vec2> ring;
            for (const Vec2& corner : polygon.rings[n]) ring.push_back(corner - origin);
            if (ring.size() < 3) continue;
            const bool counter_clockwise = n == 0;
            if ((ring_area(ring) > 0.0) != counter_clockwise) std::reverse(ring.begin(), ring.end());
            rings.push_back(std::move(ring));
        }
    return rings;
}

}  // namespace frana
