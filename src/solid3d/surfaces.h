#pragma once
// Rigid surfaces that 3D material meets: planes, the ground as a height field, and barriers.
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "solid3d/prism.h"
#include "terrain/contact.h"
#include "terrain/distance_field.h"
#include "terrain/raster.h"

namespace frana {

/// How material moves along a surface. free: nothing holds it but friction; stuck: it does not move along it.
enum class Hold { free, stuck };

/// Friction that is not the same everywhere and always.
class SurfaceFriction {
public:
    virtual ~SurfaceFriction() = default;
    /// Friction over normal force at a place.
    virtual double coefficient(const Vec3& x) const = 0;
};

/// A surface with material on the side that its normal points to. Barriers are solids. Material may be all around them,
/// and no point passes through, however thin they are and however fast it comes.
struct Surface {
    enum class Kind { plane, ground, prism, shape };
    Kind kind = Kind::plane;
    Vec3 normal{0, 0, 1};  ///< of a plane, a unit vector
    double offset = 0.0;   ///< of a plane: normal . x on it [m]
    Raster bed;            ///< of the ground: elevation [m], bilinear between nodes; beyond them the nearest
    std::shared_ptr<const Prism> prism;          ///< of a barrier with a footprint
    std::shared_ptr<const DistanceField> shape;  ///< of a barrier of any shape
    Hold hold = Hold::free;
    double friction = 0.0;                       ///< Coulomb's coefficient of a free surface [1]
    std::shared_ptr<const SurfaceFriction> law;  ///< in place of the coefficient
    bool symmetry = false;  ///< of a plane: all goes on beyond it as its mirror image, and holds to it
    std::string name;

    static Surface plane(const Vec3& through, const Vec3& normal, Hold hold = Hold::free, double friction = 0.0);
    /// A plane of symmetry. Half of a symmetric scene before it moves as the whole does.
    static Surface symmetry_plane(const Vec3& through, const Vec3& normal);
    static Surface ground(Raster bed, Hold hold = Hold::free, double friction = 0.0);
    static Surface barrier(Prism prism, Hold hold = Hold::free, double friction = 0.0);
    /// The field reaches mirror_reach() cells beyond the solid wherever material comes near.
    static Surface barrier(DistanceField shape, Hold hold = Hold::free, double friction = 0.0);

    bool is_barrier() const { return kind == Kind::prism || kind == Kind::shape; }
    int faces() const { return kind == Kind::prism ? prism->faces() : kind == Kind::shape ? 6 : 1; }
    /// Whether a place is in the solid, or behind the plane or the ground.
    bool inside(const Vec3& x) const;
};

/// For the ground the tangent plane below the point. It is exact for a plane, and of first order in distance over
/// radius of curvature. For a barrier its nearest face.
Contact contact(const Surface& surface, const Vec3& x);

/// All faces of a barrier that a point in cells of that size can meet, at most kMostContacts.
int contacts(const Surface& barrier, const Vec3& x, double cell, Contact* list);
/// At an edge that stands out a node carries pressure of all its faces. Appends those that are not among the `count` of
/// `list`, in place of the one direction to the edge. Faces of a mesh that lie behind others of `surfaces`, as a
/// house's foot below the ground, are none.
MetFaces faces_at_edge(const std::vector<Surface>& surfaces, const Surface& barrier, const Vec3& x, double cell,
                       Contact* list, int count);
/// Whether the way between two places, the first outside, goes into a barrier.
bool enters(const Surface& barrier, const Vec3& from, const Vec3& to, Entry& entry);
/// How far a barrier reaches on from a place on its surface into the unit direction `way` [m].
double thickness(const Surface& barrier, const Vec3& from, const Vec3& way);

/// Numbers of surfaces, a bit each.
using SurfaceSet = std::uint32_t;
constexpr int kMostSurfaces = 32;

/// Whether material can stand on a surface of that normal.
inline bool is_floor(const Vec3& normal) { return normal.z() > 0.5; }
/// Whether a barrier stands between a place and the floor that it has that contact with. What is above a low wall does
/// not meet the ground below the wall.
bool is_covered(const std::vector<Surface>& surfaces, SurfaceSet near, const Vec3& x, const Contact& contact,
                double cell);

/// Surfaces that a box from `low` to `high` [m] may come closer to than mirror_reach() cells and `more` [m].
SurfaceSet surfaces_near(const std::vector<Surface>& surfaces, const Vec3& low, const Vec3& high, double cell,
                         double more);

/// How far mirror particles in that surface stand at most from their points along x or y [cells]. The points are over a
/// box from `low` to `high`. Without end for barriers.
double sideways_reach(const Surface& surface, const Vec3& low, const Vec3& high);

/// A mirror particle of a point and of what surrounds it: dx' = turn dx, v' = motion v. A free surface mirrors
/// both; a stuck one turns velocities round, so that all of them vanish on it. In a barrier it shows only
/// down to half of the barrier's thickness. The other half is for the other side's material.
struct MirrorParticle {
    Vec3 place;  ///< of the point's mirror particle [m]
    Mat3 turn, motion;
    /// Of the one stuck surface that it is a mirror particle in, and how far the point is above it. What flows there
    /// bends. Zero in barriers, and in corners of which not all surfaces are perpendicular to that one.
    Vec3 held_normal;
    double held_above;  ///< [m]
    bool held;          ///< in a stuck surface, or more
    bool of_barrier;    ///< of a barrier, or of more surfaces with a barrier among them
    double share;       ///< of the point's mass and stress that it has: less than 1 at edges of barriers
    /// In corners of free surfaces: normals of those that it is mirrored in, as its point has them (see without_shear).
    int slides;
    std::array<Vec3, 3> slide;
    /// A free surface turns the shear next to it round. The mirror particle shows the speed along the surface with a
    /// kink there. The surface itself does not use that. But the other one of a corner takes it for motion, and would
    /// drive what shears. So a mirror particle in a corner shows its point's speed along the surface everywhere.
    Mat3 without_shear(Mat3 gradient) const {
        for (const Vec3* n = slide.data(); n < slide.data() + slides; ++n) {
            const Vec3 across = gradient * *n;
            gradient -= (across - n->dot(across) * *n) * n->transpose();
        }
        return gradient;
    }
    /// It has no effect at places x with normal . x < least.
    struct Cut {
        double normal[3];
        double least;  ///< [m]
    };
    int cuts;
    Cut cut[2];
    bool shows_at(const Vec3& x) const {
        for (const Cut* c = cut; c < cut + cuts; ++c)
            if (c->normal[0] * x[0] + c->normal[1] * x[1] + c->normal[2] * x[2] < c->least) return false;
        return true;
    }
};

/// The mirror particles of a point: one in each surface near it. In a corner there are also those of the mirror
/// particles, which together leave no gap there. They count as long as they do not lie behind the other surface
/// already. Surfaces whose normals are more than 120 degrees apart, such as both sides of a slice, have no common
/// corner. The first four surfaces, or faces of barriers, of the list count.
class MirrorParticles {
public:
    MirrorParticles(const std::vector<Surface>& surfaces, SurfaceSet near, const Vec3& x, double cell);
    const MirrorParticle* begin() const { return list_.data(); }
    const MirrorParticle* end() const { return list_.data() + count_; }
    /// Whether a barrier covers a floor that is near (is_covered). The point has no mirror particle there.
    bool stands_on_barrier() const { return covered_; }

private:
    struct Near {
        Contact contact;
        bool stuck;
        double thick;        ///< [m], without end but for barriers
        double share = 1.0;  ///< MirrorParticle::share
        bool of_barrier = false;
        bool symmetry = false;
        bool slides = false;  ///< free, and in a corner: see MirrorParticle::without_shear
        bool bends() const { return stuck && thick == std::numeric_limits<double>::infinity(); }
    };
    static constexpr int kMostNear = 4, kMost = 14;
    static int near_barrier(const std::vector<Surface>& surfaces, const Surface& surface, const Vec3& x, double cell,
                            Near* list, int count);
    void reflect(const Near* near, int count, const Vec3& x);
    static bool corner(const Near* near, int count, int n);
    static void slide_along(MirrorParticle& mirror, const Near& near, const Mat3& turn);
    void reflect(const Near* near, int count, const MirrorParticle& from, int depth);
    void reflect_in_others(const Near* near, int count, int n, const Vec3& from, const MirrorParticle& mirror,
                           int depth);
    static void cut_off(MirrorParticle& mirror, const Near& near, const Vec3& from);
    std::array<MirrorParticle, kMost> list_;
    int count_ = 0;
    bool covered_ = false;
};

}  // namespace frana
