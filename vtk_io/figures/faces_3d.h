#pragma once
// Faces of barriers, put together again from their patches.
#include <functional>
#include <vector>

#include "terrain/raster.h"
#include "vtk_io/reader.h"

namespace frana {

/// The patches of one face, first row first.
struct LoadedFace {
    std::vector<LoadedPatch> patches;
    Vec3 corner() const { return patches.front().corners[0]; }
    double size() const { return (patches.front().corners[1] - corner()).norm(); }
    Vec3 right() const { return (patches.front().corners[1] - corner()) / size(); }
    Vec3 up() const { return (patches.front().corners[3] - corner()) / size(); }
    bool is_side() const { return up().z() > 0.999; }
    /// To the end of the last patch, which may be beyond the face's [m].
    double longest() const;
};

/// The faces of one barrier in their order.
std::vector<LoadedFace> faces_of(const std::vector<LoadedPatch>& patches, int barrier);

/// Mean pressures over each patch and its neighbours on the face [Pa]; `counts` says which of them can be loaded.
std::vector<double> smoothed(const LoadedFace& face, const std::function<bool(const LoadedPatch&)>& counts);

/// The part of a ring within a square (Sutherland and Hodgman 1974).
Polyline cut_to_square(Polyline ring, const Vec2& low, const Vec2& high);

}  // namespace frana
