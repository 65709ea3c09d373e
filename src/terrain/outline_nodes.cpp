#include "terrain/outline_nodes.h"

#include <algorithm>
#include <cmath>

#include "terrain/bed_points.h"
#include "terrain/part_of.h"

namespace frana {
namespace {

constexpr double kRoundOff = 1.0 + 1e-9;  ///< it does not decide where a side lies on an edge of pixels

/// Whether a node is in an outline or within half a cell of it, where a strip thinner than a cell counts as one of a cell
/// about its middle. Two cells on across it, places beyond the middle are nearer to its other side.
bool is_in_reach(const Polygons& outline, const Vec2& node, double cell) {
    const Vec2 away = away_from(outline, node);
    const double far = away.norm();
    if (far <= 0.5 * kRoundOff * cell) return true;
    if (far > cell) return false;
    const Vec2 across = node - 2.0 * cell / far * away;
    return far * kRoundOff < away_from(outline, across).norm();
}

}  // namespace

namespace {

/// Calls body(a, b, away) for every side of an outline from a to b, `away` being the way from its nearest place to a point.
template <class Body>
void for_each_side(const Polygons& outline, const Vec2& point, Body&& body) {
    for (const Polygon& polygon : outline.parts)
        for (const auto& ring : polygon.rings)
            for (std::size_t k = 0; k < ring.size(); ++k) {
                const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
                const Vec2 side = b - a;
                const double length2 = side.squaredNorm();
                const double share = length2 > 0.0 ? std::clamp((point - a).dot(side) / length2, 0.0, 1.0) : 0.0;
                body(a, b, Vec2(point - a - share * side));
            }
}

}  // namespace

Vec2 away_from(const Polygons& outline, const Vec2& point) {
    Vec2 least(INFINITY, INFINITY);
    bool inside = false;
    for_each_side(outline, point, [&](const Vec2& a, const Vec2& b, const Vec2& away) {
        if (!(least.squaredNorm() <= away.squaredNorm())) least = away;
        if ((a.y() > point.y()) != (b.y() > point.y()) &&
            point.x() < a.x() + (point.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
            inside = !inside;
    });
    return inside || !std::isfinite(least.x()) ? Vec2(0, 0) : least;
}

namespace {

/// Whether a point beside an outline, `far` from it, lies in front of one of its sides. What is nearest to a corner does not. A
/// side shorter than a cell counts as one cell long, since no pixel may lie in front of it. Where two sides turn by less
/// than half a right angle they are one round face, without a corner.
bool is_in_front(const Polygons& outline, const Vec2& point, double far, double cell) {
    const double round_off = 1e-9 * cell, round_face = std::sqrt(0.5);
    std::vector<Vec2> along;  // of the nearest sides
    bool in_front = false;
    for_each_side(outline, point, [&](const Vec2& a, const Vec2& b, const Vec2& way) {
        if (a == b || way.norm() > far + round_off) return;
        const double length = (b - a).norm();
        along.push_back((b - a) / length);
        const double from_middle = std::abs((point - a).dot(along.back()) - 0.5 * length);
        in_front = in_front || from_middle <= 0.5 * std::max(length, cell) + round_off;
    });
    return in_front || (along.size() == 2 && along[0].dot(along[1]) > round_face);
}

}  // namespace

std::vector<Vec2> out_of(const Polygons& outline, const Vec2& point, double cell) {
    const Vec2 away = away_from(outline, point);
    const double round_off = 1e-9 * cell, far = away.norm();
    if (far > round_off) return is_in_front(outline, point, far, cell) ? std::vector<Vec2>{away} : std::vector<Vec2>{};
    double least = INFINITY;
    for_each_side(outline, point,
                  [&](const Vec2&, const Vec2&, const Vec2& way) { least = std::min(least, way.norm()); });
    std::vector<Vec2> out;
    for_each_side(outline, point, [&](const Vec2& a, const Vec2& b, const Vec2& way) {
        if (a == b || !(way.norm() <= least + round_off)) return;
        const Vec2 across = Vec2(b.y() - a.y(), a.x() - b.x()).normalized(), near = point - way;
        const double little = 1e-6 * cell;
        out.push_back(away_from(outline, near + little * across).norm() > 0.5 * little ? across : Vec2(-across));
    });
    return out;
}

std::vector<char> nodes_of_outline(const Polygons& outline, const GridGeometry& grid) {
    std::vector<char> marks;
    for (Index j = 0; j < grid.ny; ++j)
        for (Index i = 0; i < grid.nx; ++i)
            marks.push_back(is_in_reach(outline, {grid.x(i), grid.y(j)}, grid.cell) ? 1 : 0);
    return marks;
}

double lowest_ground(const Polygon& polygon, const Raster& bed) {
    const GridGeometry& g = bed.geometry;
    double lowest = INFINITY;
    if (polygon.rings.empty()) return lowest;
    const NodeBox near = common(widened(cells_of(polygon.rings.front(), g), 1), NodeBox::all(g));
    if (near.nx < 1 || near.ny < 1) return lowest;
    Polygons alone;
    alone.parts = {polygon};
    const std::vector<char> stands = nodes_of_outline(alone, near.of(g));
    for (Index j = 0; j < near.ny; ++j)
        for (Index i = 0; i < near.nx; ++i)
            if (stands[static_cast<std::size_t>(j * near.nx + i)])
                lowest = std::fmin(lowest, bed.at(near.i0 + i, near.j0 + j));
    if (std::isinf(lowest))  // between nodes
        for (const Vec2& corner : polygon.rings.front())
            lowest = std::fmin(lowest, bed_elevation(bed, corner.x(), corner.y()));
    return lowest;
}

}  // namespace frana
