#include "coupling/at_barrier.h"

#include <algorithm>
#include <cmath>

#include "coupling/barriers.h"
#include "terrain/bed_points.h"

namespace frana {

bool stands_out(const Surface& barrier, const Raster& ground, const Vec2& place) {
    if (ground.values.empty()) return true;
    const double top = barrier.prism ? barrier.prism->top_at(place) : barrier.shape->top_at(place);
    return !std::isfinite(top) || !(top <= bed_below(ground, place.x(), place.y()));
}

bool stands_near(const Surface& barrier, const Raster& ground, const std::pair<Vec3, Vec3>& box, const Vec3& x,
                 double distance, double cell) {
    if (!near_box(box, x.head<2>(), distance)) return false;
    const double top = barrier.prism ? barrier.prism->top_at(x.head<2>()) : box.second.z();
    const Vec3 foot(x.x(), x.y(), std::min(x.z(), top - cell));
    const auto reaches = [&](const Contact& met) {
        const Vec3 there = foot - std::max(0.0, met.distance) * met.normal;
        return met.distance <= distance && stands_out(barrier, ground, there.head<2>());
    };
    if (barrier.shape) return reaches(barrier.shape->contact(foot));
    if (barrier.prism->inside(foot)) return stands_out(barrier, ground, foot.head<2>());
    Contact near[kMostContacts];
    return barrier.prism->contacts(foot, cell, near) > 0 && reaches(near[0]);
}

std::optional<Contact> nearest_face(const Surface& barrier, const Vec3& x, double cell) {
    if (barrier.shape) return barrier.shape->contact(x);
    Contact list[kMostContacts];
    if (barrier.prism->contacts(x, cell, list) == 0) return {};
    return list[0];
}

bool crosses(const Surface& barrier, const Raster& ground, const std::pair<Vec3, Vec3>& box, const Vec2& from,
             const Vec2& to) {
    const auto& [low, high] = box;
    const double z = barrier.shape ? 0.5 * (low.z() + high.z()) : high.z() - 1e6;  // footprints reach down without end
    Entry entry;
    return enters(barrier, {from.x(), from.y(), z}, {to.x(), to.y(), z}, entry) &&
           stands_out(barrier, ground, from + entry.share * (to - from));
}

bool at_crest(const Surface& barrier, const Vec2& place, double cell) {
    if (!barrier.shape) return true;
    const double here = top_of(barrier, place);
    return at_crest(
        [&](const Vec2& x) {
            const double z = top_of(barrier, x);
            return std::isfinite(z) ? z : here;
        },
        place, cell);
}

bool at_crest(const std::function<double(const Vec2&)>& top, const Vec2& place, double cell) {
    const Vec2 x(0.25 * cell, 0.0), y(0.0, 0.25 * cell),
        rise(top(place + x) - top(place - x), top(place + y) - top(place - y));
    // Of a cell, over half of one: what sampling makes of a level crest. Along an axis a crest may rise by 1 in 5
    // itself, and at a mesh's ends the steepest way is that of its edge.
    constexpr double kLevel = 0.02, kCrest = 0.1;
    const auto rises = [&](const Vec2& way, double by) {
        if (way.norm() <= kLevel * cell) return false;
        const Vec2 half = 0.5 * cell * way.normalized();
        return top(place + 2.0 * half) > top(place + half) + by * cell;
    };
    return !rises(rise, kLevel) && !rises({rise.x(), 0.0}, kCrest) && !rises({0.0, rise.y()}, kCrest);
}

}  // namespace frana
