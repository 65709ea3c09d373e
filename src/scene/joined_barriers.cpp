#define BOOST_ALLOW_DEPRECATED_HEADERS  // the tree of Boost 1.74 includes one
#include "scene/joined_barriers.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/geometry/algorithms/correct.hpp>
#include <boost/geometry/algorithms/distance.hpp>
#include <boost/geometry/geometries/point_xy.hpp>
#include <boost/geometry/geometries/polygon.hpp>
#include <boost/geometry/strategies/strategies.hpp>
#include <cmath>
#include <limits>

#include "terrain/contact.h"
#include "terrain/distance_field.h"

namespace frana {
namespace {

namespace geometry = boost::geometry;

/// A polygon in plan, and the box around it.
struct Part {
    geometry::model::polygon<geometry::model::d2::point_xy<double>> shape;
    Vec2 low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};
};

using Parts = std::vector<Part>;

void add(Parts& parts, const Polygon& polygon) {
    if (polygon.rings.empty() || polygon.rings.front().empty()) return;
    Part part;
    part.shape.inners().resize(polygon.rings.size() - 1);
    for (std::size_t n = 0; n < polygon.rings.size(); ++n)
        for (const Vec2& p : polygon.rings[n]) {
            (n == 0 ? part.shape.outer() : part.shape.inners()[n - 1]).emplace_back(p.x(), p.y());
            part.low = part.low.cwiseMin(p), part.high = part.high.cwiseMax(p);
        }
    geometry::correct(part.shape);
    parts.push_back(std::move(part));
}

/// A wall along a line: a rectangle for each of its segments, without mitres.
void add_wall(Parts& parts, const Barrier& barrier, double cell) {
    double thick = barrier.thickness.value_or(0.0);
    for (std::size_t k = 1; k < barrier.line.size(); ++k) {
        const Vec2 way = (barrier.line[k] - barrier.line[k - 1]).normalized();
        thick = std::max(thick, cell * mirror_reach({way.x(), way.y(), 0.0}));
    }
    for (std::size_t k = 1; k < barrier.line.size(); ++k) {
        const Vec2 from = barrier.line[k - 1], to = barrier.line[k], way = (to - from).normalized();
        const Vec2 back = (barrier.wet_left ? thick : -thick) * Vec2(way.y(), -way.x());
        add(parts, {{{from, to, to + back, from + back}}});
    }
}

bool is_under_top(const DistanceField& mesh, Index i, Index j) {
    for (Index k = 0; k < mesh.nodes[2]; ++k)
        if (mesh.at(i, j, k) < 0.0) return true;
    return false;
}

/// A mesh in plan: a strip for each run of nodes of a row that lie below its top.
void add_mesh(Parts& parts, const DistanceField& mesh) {
    const double half = 0.5 * mesh.spacing;
    for (Index j = 0; j < mesh.nodes[1]; ++j)
        for (Index i = 0; i < mesh.nodes[0]; ++i) {
            if (!is_under_top(mesh, i, j)) continue;
            const Index first = i;
            while (i + 1 < mesh.nodes[0] && is_under_top(mesh, i + 1, j)) ++i;
            const Vec2 low = mesh.place(first, j, 0).head<2>() - Vec2(half, half),
                       high = mesh.place(i, j, 0).head<2>() + Vec2(half, half);
            add(parts, {{{low, {high.x(), low.y()}, high, {low.x(), high.y()}}}});
        }
}

Parts parts_of(const Barrier& barrier, double cell) {
    Parts parts;
    for (const Polygon& polygon : barrier.outline.parts) add(parts, polygon);
    add_wall(parts, barrier, cell);
    if (barrier.shape) add_mesh(parts, *barrier.shape);
    return parts;
}

/// The least distance of two barriers where it is below `most`; otherwise that or more [m].
double apart(const Parts& one, const Parts& other, double most) {
    double least = most;
    for (const Part& a : one)
        for (const Part& b : other) {
            const double gap = std::max((b.low - a.high).maxCoeff(), (a.low - b.high).maxCoeff());
            if (least > 0.0 && gap < least) least = std::min(least, geometry::distance(a.shape, b.shape));
        }
    return least;
}

}  // namespace

std::vector<JoinedBarriers> joined_barriers(const std::vector<Barrier>& barriers, double cell) {
    const double seam = 1e-3 * cell, near = cell * (1.0 - 1e-9);  // contacts reach a cell from a face
    std::vector<Parts> plans;
    plans.reserve(barriers.size());
    for (const Barrier& barrier : barriers) plans.push_back(parts_of(barrier, cell));
    std::vector<JoinedBarriers> joined;
    for (std::size_t n = 0; n < plans.size(); ++n)
        for (std::size_t m = n + 1; m < plans.size(); ++m)
            if (const double gap = apart(plans[n], plans[m], near); gap < near)
                joined.push_back({n, m, gap > seam ? gap : 0.0});
    return joined;
}

std::vector<std::string> remarks_on_joined(const std::vector<Barrier>& barriers, double cell) {
    std::vector<std::string> remarks;
    for (const JoinedBarriers& pair : joined_barriers(barriers, cell))
        remarks.push_back(fmt::format(
            "{} and {}: found barriers that {}; expected {:.3g} m or more between them, a cell of the 3D stage, since "
            "forces on faces within, against or near the other count too: use the sum of their forces, not those of "
            "each, or draw "
            "both as one outline",
            barriers[pair.one].name, barriers[pair.other].name,
            pair.apart > 0.0 ? fmt::format("stand {:.3g} m apart", pair.apart) : "overlap or touch", cell));
    return remarks;
}

}  // namespace frana
