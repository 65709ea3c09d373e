#pragma once
#include <string>
#include <vector>

#include "scene/scene.h"
#include "vtk_io/figures/map_figure.h"

namespace frana {

/// Adds every ring of an outline, closed.
void add_rings(const std::string& name, const Polygons& outline, std::vector<NamedLine>& plans);

/// Barriers in plan, as maps show them. Every ring of an outline is closed. A wall along a line is shown by its foot.
/// One that was given as a mesh has neither.
std::vector<NamedLine> barrier_plans(const std::vector<Barrier>& barriers);

}  // namespace frana
