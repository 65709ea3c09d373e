#pragma once
// A lake that stands around barriers, as particles.
#include "scene/scene.h"

namespace frana {

/// Particles of a lake up to `scene.still_surface` give room to what rose since `bed`: they keep the share of their depth
/// that lies above the ground now, and those below it go. Without a still surface nothing changes. Returns the volume that
/// went [m3].
double make_room_in_lake(Scene& scene, const Raster& bed);

}  // namespace frana
