#pragma once
// Where flat faces of a mesh meet in an edge that stands out.
#include <array>
#include <vector>

#include "terrain/triangle_mesh.h"

namespace frana {

/// An edge of a mesh that turns outwards by more than 30 degrees.
struct SharpEdge {
    Vec3 from, along;            ///< start, from the field's origin; unit vector
    double length;               ///< [m]
    std::array<int, 2> face;     ///< numbers of its two faces: triangles that lie in one plane and touch
    std::array<Vec3, 2> normal;  ///< of each face, outwards
    std::array<Vec3, 2> into;    ///< of each face, from the edge along the face: unit vectors
    std::array<bool, 2> bent;    ///< at its start and its end: whether an edge that stands in begins there
};

/// A face adjacent to sharp edges, as it is for a place.
struct EdgeFace {
    int face;
    double distance;  ///< of the place from the face's plane, negative behind it [m]
    Vec3 normal;
    /// How far beyond the face's edges the place's foot lies along the axes, negative on the face [m]. It is taken over
    /// the sum of the entries of the way there, as shape functions reach.
    double beyond;
};

/// The sharp edges of a mesh, found by blocks of space. A field of distances has them rounded by half its spacing. Of
/// two faces that are as near it tells neither.
class SharpEdges {
public:
    static constexpr int kMostFaces = 8;
    SharpEdges() = default;
    /// Of a mesh whose triangles all run the same way round. `origin`, `end` [m]: of the field. Places that are queried
    /// lie up to `reach` [m] from its edges.
    SharpEdges(const TriangleMesh& mesh, const Vec3& origin, const Vec3& end, double reach);

    bool empty() const { return edges_.empty(); }
    /// Faces of edges that lie no farther from a place than `radius` [m]: at most kMostFaces of them. An edge counts to
    /// `over` [m] along each axis beyond its ends. It does not beyond an end where another edge adjoins. x is counted
    /// from the field's origin.
    int faces_near(const Vec3& x, double radius, double over, EdgeFace* list) const;

private:
    std::vector<SharpEdge> edges_;
    std::array<Index, 3> blocks_{0, 0, 0};
    double block_ = 1.0;
    std::vector<std::size_t> first_;  ///< of each block in listed_, and one more
    std::vector<std::size_t> listed_;
};

}  // namespace frana
