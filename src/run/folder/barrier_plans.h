#pragma once
#include <vector>

#include "scene/scene.h"
#include "vtk_io/figures/map_figure.h"

namespace frana {

/// Barriers in plan, as maps show them. Every ring of an outline is closed. A wall along a line is shown by its foot.
/// One that was given as a mesh has neither.
std::vector<NamedLine> barrier_plans(const std::vector<Barrier>& barriers);

}  // namespace frana
