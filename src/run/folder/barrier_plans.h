#pragma once
#include <vector>

#include "scene/scene.h"
#include "vtk_io/figures/map_figure.h"

namespace frana {

/// Barriers in plan, as maps show them: every ring of an outline closed, the foot of a wall along a line. One that was given
/// as a mesh has neither.
std::vector<NamedLine> barrier_plans(const std::vector<Barrier>& barriers);

}  // namespace frana
