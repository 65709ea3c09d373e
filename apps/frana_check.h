#pragma once
#include <string>

#include "scene/build_scene.h"

namespace frana {

/// What `frana check` prints of a scene: grid, releases, memory, time, remarks. UserError when this build cannot serve it.
std::string told_of(const BuiltScene& built);

}  // namespace frana
