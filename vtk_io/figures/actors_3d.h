#pragma once
// What stands on a perspective view's ground, as VTK draws it. Includes VTK, so only for .cpp files of this room.
#include <vtkSmartPointer.h>

#include <vector>

#include "vtk_io/figures/objects_3d.h"

class vtkActor;

namespace frana {

/// Shaded balls, each with its true depth: what lies behind another is hidden by it. Coordinates are relative
/// to `origin`; so below.
vtkSmartPointer<vtkActor> balls_actor(const std::vector<Objects3d::Ball>& balls, const Vec2& origin);
/// Flat areas in just the colours given.
vtkSmartPointer<vtkActor> facets_actor(const std::vector<Objects3d::Facet>& facets, const Vec2& origin);
vtkSmartPointer<vtkActor> edges_actor(const std::vector<std::vector<Vec3>>& edges, const Vec2& origin, double width);

}  // namespace frana
