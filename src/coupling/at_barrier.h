#pragma once
// Where a place lies with respect to a barrier: near it, on its crest, on the other side. Watches of both models ask.
#include <functional>
#include <optional>
#include <utility>

#include "solid3d/surfaces.h"
#include "terrain/contact.h"
#include "terrain/raster.h"

namespace frana {

/// Cells: as far from a barrier run-up counts. Particles stop one before it, where its ramp begins.
constexpr double kClose = 2.0;

/// Whether a barrier's top at a place is above the ground there. What is over a buried part has not met the barrier.
bool stands_out(const Surface& barrier, const Raster& ground, const Vec2& place);

/// Whether a place is within `distance` of a barrier in plan, below its top, where it stands out. The box of a bent
/// wall holds far more.
bool stands_near(const Surface& barrier, const Raster& ground, const std::pair<Vec3, Vec3>& box, const Vec3& x,
                 double distance, double cell);

/// The face that a place is nearest to, if it can meet any in cells of that size.
std::optional<Contact> nearest_face(const Surface& barrier, const Vec3& x, double cell);

/// Whether the way from a place outside of a barrier to another one leads over it, however thin it is.
bool crosses(const Surface& barrier, const Raster& ground, const std::pair<Vec3, Vec3>& box, const Vec2& from,
             const Vec2& to);

/// Whether a place on a barrier is at its crest. What stands on a mesh's sloping face is not yet over it: half a cell
/// up from there the face still rises. What goes over moves less than a cell between two samples.
bool at_crest(const Surface& barrier, const Vec2& place, double cell);
/// The same by elevations `top`, of the ground that barriers raise.
bool at_crest(const std::function<double(const Vec2&)>& top, const Vec2& place, double cell);

}  // namespace frana
