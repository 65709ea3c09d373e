#pragma once
// The solid of a perspective view: terrain with a painted skin, side walls, lines on its surface.
#include <vtkSmartPointer.h>

#include <vector>

#include "terrain/raster.h"
#include "vtk_io/figures/pixels.h"

class vtkActor;
class vtkPolyData;

namespace frana {

/// Cells in their own colours, whatever the light.
vtkSmartPointer<vtkActor> unlit_actor(vtkPolyData* data);

/// The surface through the raster's nodes (cells with a NaN corner left open). A picture is stretched over it from the
/// first to the last node. Coordinates are relative to `origin`.
vtkSmartPointer<vtkActor> skin_actor(const Raster& surface, const Pixels& picture, const Vec2& origin);

/// Walls from the raster's outer nodes down to the level `foot` [m].
vtkSmartPointer<vtkActor> wall_actor(const Raster& surface, double foot, const Vec2& origin);

/// Lines laid on the surface, `lift` above it [m]; parts off the raster or over NaN are left out.
vtkSmartPointer<vtkActor> draped_actor(const std::vector<Polyline>& lines, const Raster& surface, double lift,
                                       const Vec2& origin, const Colour& colour, double width);

}  // namespace frana
