#pragma once
// Rigid surfaces that 3D material meets: planes, and the ground as a height field.
#include <array>
#include <cstdint>
#include <vector>

#include "base/types.h"
#include "terrain/raster.h"

namespace frana {

/// How material moves along a surface. free: nothing holds it but friction; stuck: it does not move along it.
enum class Hold { free, stuck };

/// A surface with material on the side that its normal points to.
struct Surface {
    enum class Kind { plane, ground };
    Kind kind = Kind::plane;
    Vec3 normal{0, 0, 1};  ///< of a plane, a unit vector
    double offset = 0.0;   ///< of a plane: normal . x on it [m]
    Raster bed;            ///< of the ground: elevation [m], bilinear between nodes; beyond them the nearest
    Hold hold = Hold::free;
    double friction = 0.0;  ///< Coulomb's coefficient of a free surface [1]
    std::string name;

    static Surface plane(const Vec3& through, const Vec3& normal, Hold hold = Hold::free,
                         double friction = 0.0);
    static Surface ground(Raster bed, Hold hold = Hold::free, double friction = 0.0);
};

/// The tangent plane of a surface at the place nearest to a point.
struct Contact {
    double distance;  ///< of the point, negative inside of the surface [m]
    Vec3 normal;      ///< unit vector away from the surface
};

/// For the ground the tangent plane below the point: exact for a plane, and of first order in distance over
/// radius of curvature.
Contact contact(const Surface& surface, const Vec3& x);

/// Numbers of surfaces, a bit each.
using SurfaceSet = std::uint32_t;
constexpr int kMostSurfaces = 32;

/// Cells from a surface within which the mirror image of a point touches nodes that material touches: a point
/// reaches 3/2 cells along each axis, so its image counts up to 3 (|n_x| + |n_y| + |n_z|) cells from it.
inline double image_reach(const Vec3& normal) { return 3.0 * normal.lpNorm<1>(); }

/// Surfaces that a box from `low` to `high` [m] may come closer to than image_reach() cells and `more` [m].
SurfaceSet surfaces_near(const std::vector<Surface>& surfaces, const Vec3& low, const Vec3& high, double cell,
                         double more);

/// A mirror image of a point and of what surrounds it: dx' = turn dx, v' = motion v. A free surface mirrors
/// both; a stuck one turns velocities round, so that all of them vanish on it.
struct Image {
    Vec3 place;  ///< of the point's image [m]
    Mat3 turn, motion;
};

/// The images of a point: one in each surface near it; in a corner also those of the images, which together
/// leave no gap there, as long as they do not lie behind the other surface already. Surfaces whose normals
/// are more than 120 degrees apart, such as both sides of a slice, have no common corner. The first four
/// surfaces of the list count.
class Images {
public:
    Images(const std::vector<Surface>& surfaces, SurfaceSet near, const Vec3& x, double cell);
    const Image* begin() const { return list_.data(); }
    const Image* end() const { return list_.data() + count_; }

private:
    struct Near {
        Contact contact;
        bool stuck;
    };
    static constexpr int kMostNear = 4, kMost = 14;
    void reflect(const Near* near, int count, const Image& from, int depth);
    std::array<Image, kMost> list_;
    int count_ = 0;
};

}  // namespace frana
