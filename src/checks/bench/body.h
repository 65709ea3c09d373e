#pragma once
#include "solid3d/mpm3d.h"

namespace frana::bench {

/// What the 3D points are made of.
enum class BodyLaw { fluid, bingham, drucker_prager };
const char* name_of(BodyLaw law);

/// A block that slides over a plane and spreads. It has n x n x n/2 cells of half a metre, eight points a cell, about
/// `particles` in all. It has 4 m/s, sound ten times as fast, and Coulomb friction on the plane.
SolidScene body_scene(BodyLaw law, Index particles);

}  // namespace frana::bench
