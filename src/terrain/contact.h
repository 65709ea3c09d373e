#pragma once
// Where a point meets a surface.
#include "base/types.h"

namespace frana {

/// The tangent plane of a surface at the place nearest to a point.
struct Contact {
    double distance;  ///< of the point, negative inside of the surface [m]
    Vec3 normal;      ///< unit vector away from the surface
    int face = 0;     ///< of surfaces with several
};

/// Faces of one surface that a point can meet at once.
constexpr int kMostContacts = 4;

/// Where a straight way first goes into a solid.
struct Entry {
    double share;  ///< of the way that lies before it [1]
    Vec3 normal;   ///< of the face that it crosses
    int face;
};

/// Cells from a surface within which the mirror image of a point reaches nodes that material reaches. A point reaches
/// 3/2 cells along each axis. So its image counts up to 3 (|n_x| + |n_y| + |n_z|) cells from it.
inline double mirror_reach(const Vec3& normal) { return 3.0 * normal.lpNorm<1>(); }

/// Of any normal.
constexpr double kLongestReach = 5.2;

/// Normals nearer to each other than this, the cosine of 30 degrees, are one face that bends.
constexpr double kSameFace = 0.866;

/// Surfaces whose normals are more than 120 degrees apart have no common corner: they are two sides.
constexpr double kOpposite = -0.5;

}  // namespace frana
