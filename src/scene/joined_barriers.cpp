#include "scene/joined_barriers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "terrain/contact.h"

namespace frana {
namespace {

using Ring = std::vector<Vec2>;

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Polygons that a barrier stands on; of a wall along a line one for each of its segments, without mitres.
std::vector<Polygon> plan_of(const Barrier& barrier, double cell) {
    std::vector<Polygon> plan = barrier.outline.parts;
    double thick = barrier.thickness.value_or(0.0);
    for (std::size_t k = 1; k < barrier.line.size(); ++k) {
        const Vec2 way = (barrier.line[k] - barrier.line[k - 1]).normalized();
        thick = std::max(thick, cell * mirror_reach({way.x(), way.y(), 0.0}));
    }
    for (std::size_t k = 1; k < barrier.line.size(); ++k) {
        const Vec2 from = barrier.line[k - 1], to = barrier.line[k], way = (to - from).normalized();
        const Vec2 back = (barrier.wet_left ? thick : -thick) * Vec2(way.y(), -way.x());
        plan.push_back({{{from, to, to + back, from + back}}});
    }
    return plan;
}

bool within(const Polygon& polygon, const Vec2& p) {
    bool odd = false;
    for (const Ring& ring : polygon.rings)
        for (std::size_t k = 0; k < ring.size(); ++k) {
            const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
            if ((a.y() > p.y()) != (b.y() > p.y()) && (cross(b - a, p - a) > 0.0) == (b.y() > a.y())) odd = !odd;
        }
    return odd;
}

bool within(const std::vector<Polygon>& plan, const Vec2& p) {
    return std::any_of(plan.begin(), plan.end(), [&](const Polygon& polygon) { return within(polygon, p); });
}

/// body(start, end of a side), as long as it returns false. Returns whether it returned true.
template <class Body>
bool any_side(const std::vector<Polygon>& plan, Body&& body) {
    for (const Polygon& polygon : plan)
        for (const Ring& ring : polygon.rings)
            for (std::size_t k = 0; k < ring.size(); ++k) {
                const Vec2 &from = ring[k], &to = ring[(k + 1) % ring.size()];
                if ((to - from).norm() > 0.0 && body(from, to)) return true;
            }
    return false;
}

/// Whether a corner of `one` lies along a side of `other`, `seam` from it at most and farther from its ends.
bool has_corner_along(const std::vector<Polygon>& one, const std::vector<Polygon>& other, double seam) {
    return any_side(one, [&](const Vec2& corner, const Vec2&) {
        return any_side(other, [&](const Vec2& from, const Vec2& to) {
            const Vec2 way = (to - from).normalized();
            const double along = way.dot(corner - from);
            return along > seam && along < (to - from).norm() - seam && std::abs(cross(way, corner - from)) <= seam;
        });
    });
}

bool cross_each_other(const std::vector<Polygon>& one, const std::vector<Polygon>& other) {
    return any_side(one, [&](const Vec2& a, const Vec2& b) {
        return any_side(other, [&](const Vec2& c, const Vec2& d) {
            return cross(b - a, c - a) * cross(b - a, d - a) < 0.0 && cross(d - c, a - c) * cross(d - c, b - c) < 0.0;
        });
    });
}

/// Whether a place of `one` just within the middle of its side is in `other`: sides that coincide do not cross.
bool is_in(const std::vector<Polygon>& one, const std::vector<Polygon>& other, double seam) {
    return any_side(one, [&](const Vec2& from, const Vec2& to) {
        const Vec2 way = (to - from).normalized(), across = seam * Vec2(way.y(), -way.x());
        for (const Vec2& place : {Vec2(0.5 * (from + to) + across), Vec2(0.5 * (from + to) - across)})
            if (within(one, place) && within(other, place)) return true;
        return false;
    });
}

}  // namespace

std::vector<JoinedBarriers> joined_barriers(const std::vector<Barrier>& barriers, double cell) {
    const double seam = 1e-3 * cell;
    std::vector<std::vector<Polygon>> plans;
    plans.reserve(barriers.size());
    for (const Barrier& barrier : barriers) plans.push_back(plan_of(barrier, cell));
    std::vector<JoinedBarriers> joined;
    for (std::size_t n = 0; n < plans.size(); ++n)
        for (std::size_t m = n + 1; m < plans.size(); ++m)
            if (has_corner_along(plans[n], plans[m], seam) || has_corner_along(plans[m], plans[n], seam) ||
                cross_each_other(plans[n], plans[m]) || is_in(plans[n], plans[m], seam) ||
                is_in(plans[m], plans[n], seam))
                joined.push_back({n, m});
    return joined;
}

std::vector<std::string> remarks_on_joined(const std::vector<Barrier>& barriers, double cell) {
    std::vector<std::string> remarks;
    for (const JoinedBarriers& pair : joined_barriers(barriers, cell))
        remarks.push_back(fmt::format(
            "{} and {}: found barriers that overlap, or touch along a side; expected them apart in a run with 3D "
            "points, since faces within or against the other push too: use the sum of their forces, not those of each; "
            "draw both as one outline",
            barriers[pair.one].name, barriers[pair.other].name));
    return remarks;
}

}  // namespace frana
