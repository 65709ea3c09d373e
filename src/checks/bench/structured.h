#pragma once
#include "scene/scene.h"

namespace frana::bench {

/// What structured particles do: deform, yield everywhere and break, are grains from the start, or break together with
/// free water.
enum class ParticlesThat { hold, break_up, are_grains, drain };
const char* name_of(ParticlesThat what);

/// The blob of blob.h of structured particles: without internal rheology and the bed's curvature, which they do not
/// have.
Scene structured_blob(ParticlesThat what, Index particles);

}  // namespace frana::bench
