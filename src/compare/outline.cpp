#include "compare/outline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "compare/nearest.h"

namespace frana {
namespace {

/// Edges between a pixel above the limit and one that is not, as directions out of the pixels' corners. On the way
/// along an edge, the pixel is on the left.
class EdgeWalk {
public:
    EdgeWalk(const Raster& field, double limit) : grid_(field.geometry), columns_(grid_.nx + 1) {
        edges_.assign(static_cast<std::size_t>(columns_ * (grid_.ny + 1)), 0);
        const auto above = [&](Index i, Index j) {
            return i >= 0 && j >= 0 && i < grid_.nx && j < grid_.ny && field.at(i, j) > limit;
        };
        for (Index j = 0; j < grid_.ny; ++j)
            for (Index i = 0; i < grid_.nx; ++i) {
                if (!above(i, j)) continue;
                if (!above(i, j - 1)) leave(i, j, east);
                if (!above(i + 1, j)) leave(i + 1, j, north);
                if (!above(i, j + 1)) leave(i + 1, j + 1, west);
                if (!above(i - 1, j)) leave(i, j + 1, south);
            }
    }

    Rings rings() {
        Rings rings;
        for (Index corner = 0; corner < static_cast<Index>(edges_.size()); ++corner)
            while (edges_[static_cast<std::size_t>(corner)] != 0) rings.push_back(ring_from(corner));
        return rings;
    }

private:
    enum Direction : int { east, north, west, south };

    void leave(Index i, Index j, Direction d) { edges_[static_cast<std::size_t>(j * columns_ + i)] |= bit(d); }
    static std::uint8_t bit(int direction) { return static_cast<std::uint8_t>(1U << direction); }
    bool leaves(Index corner, int direction) const {
        return (edges_[static_cast<std::size_t>(corner)] & bit(direction)) != 0;
    }
    Vec2 place(Index corner) const {
        const Index column = corner % columns_, row = corner / columns_;
        return {grid_.x0 + (static_cast<double>(column) - 0.5) * grid_.cell,
                grid_.y0 + (static_cast<double>(row) - 0.5) * grid_.cell};
    }

    /// `start` is the southernmost, then westernmost corner of its ring, so the ring turns there.
    std::vector<Vec2> ring_from(Index start) {
        const std::array<Index, 4> ahead{1, columns_, -1, -columns_};
        std::vector<Vec2> ring;
        int direction = east;
        while (!leaves(start, direction)) ++direction;
        for (Index corner = start;;) {
            ring.push_back(place(corner));
            const int straight = direction;
            do {
                edges_[static_cast<std::size_t>(corner)] &= static_cast<std::uint8_t>(~bit(straight));
                corner += ahead[static_cast<std::size_t>(straight)];
                direction = turn(corner, straight);
            } while (direction == straight && corner != start);
            if (corner == start) return ring;
        }
    }

    /// Left before straight on before right: where two pixels touch at a corner, the way stays at its own.
    int turn(Index corner, int direction) const {
        for (const int by : {1, 0, 3})
            if (leaves(corner, (direction + by) % 4)) return (direction + by) % 4;
        return direction;  // back at the start, whose edge is used up
    }

    GridGeometry grid_;
    Index columns_;
    std::vector<std::uint8_t> edges_;
};

struct Stretch {
    double distance, length;
};

void walk(const Rings& rings, const NearestOnRings& other, double step, std::vector<Stretch>& stretches) {
    for (const auto& ring : rings)
        for (std::size_t k = 0; k < ring.size(); ++k) {
            const Vec2 edge = ring[(k + 1) % ring.size()] - ring[k];
            const double length = edge.norm();
            const int parts = std::max(1, static_cast<int>(std::ceil(length / step)));
            for (int part = 0; part < parts; ++part)
                stretches.push_back({other.distance(ring[k] + (part + 0.5) / parts * edge), length / parts});
        }
}

}  // namespace

Rings rings_of(const Polygons& polygons) {
    Rings rings;
    for (const Polygon& part : polygons.parts)
        for (std::size_t k = 0; k < part.rings.size(); ++k) {
            rings.push_back(part.rings[k]);
            const bool counter_clockwise = ring_area(part.rings[k]) > 0.0;
            if (counter_clockwise != (k == 0)) std::reverse(rings.back().begin(), rings.back().end());
        }
    return rings;
}

double area_of(const Rings& rings) {
    double area = 0.0;
    for (const auto& ring : rings) area += ring_area(ring);
    return area;
}

Rings pixel_outline(const Raster& field, double limit) { return EdgeWalk(field, limit).rings(); }

OutlineDistance distance_between(const Rings& a, const Rings& b, double step) {
    if (a.empty() || b.empty()) return {Raster::nodata, Raster::nodata, Raster::nodata, Raster::nodata};
    std::vector<Stretch> stretches;
    walk(a, NearestOnRings(b), step, stretches);
    walk(b, NearestOnRings(a), step, stretches);
    std::sort(stretches.begin(), stretches.end(),
              [](const Stretch& l, const Stretch& r) { return l.distance < r.distance; });
    double total = 0.0, sum = 0.0, squares = 0.0;
    for (const Stretch& s : stretches) {
        total += s.length;
        sum += s.length * s.distance;
        squares += s.length * s.distance * s.distance;
    }
    OutlineDistance result{sum / total, 0.0, std::sqrt(squares / total), stretches.back().distance};
    double below = 0.0;
    for (const Stretch& s : stretches) {
        result.p95 = s.distance;
        below += s.length;
        if (below >= 0.95 * total) break;
    }
    return result;
}

}  // namespace frana
