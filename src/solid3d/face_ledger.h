#pragma once
// What each face of each barrier has given to the material, and where on it.
#include <vector>

#include "observe/archive.h"
#include "solid3d/surfaces.h"

namespace frana {

/// A rectangle of a face, from one corner to the other, along its right and up.
struct FacePart {
    std::array<double, 2> from{0, 0}, to{0, 0};  ///< [squares]
};

/// What a face gives to a node, or to a point that it puts back, in one step.
struct FaceImpulse {
    int face;       ///< in the ledger
    FacePart part;  ///< of the face, over which the impulse is spread evenly
    Vec3 impulse;   ///< [kg m/s]
    Vec3 moment;    ///< of the impulse about the grid's origin [kg m^2/s]
};

/// A face in squares of about a cell, from `origin` along `right` and `up`.
struct Patches {
    Vec3 origin{0, 0, 0}, right{1, 0, 0}, up{0, 1, 0};
    double size = 1.0;                   ///< of a square's edge [m]
    std::array<Index, 2> count{0, 0};    ///< along right and up
    std::array<double, 2> extent{0, 0};  ///< of the face [squares]; the last row and column may stick out
    std::vector<double> area;            ///< of each square that material can reach [m^2]
    std::vector<double> tops;            ///< of a prism's side: where it ends in the middle of each column [squares]
    std::vector<char> off_face;          ///< per square of a prism: 1 if nothing of the face is there; empty for shapes
    std::vector<Vec3> impulse;           ///< on the material since the start, at row * count[0] + column [kg m/s]

    /// What lies within `reach` [m] of a place on the face, and neither beyond the face nor beyond `others`. These are
    /// surfaces that bound the material. It is the part for which a node there stands. Where nothing is left, the
    /// nearest place.
    FacePart around(const Vec3& x, double reach, const std::vector<Surface>& others) const;
    /// Finds `area`: the part of each square that is of the face and not beyond `others`, on the map for a top. It is a
    /// quarter of the square at least, so that single points do not count too much. And `off_face`.
    void measure(const std::vector<Surface>& others);
    void measure_top(const Prism& prism, const std::vector<Surface>& others);
    /// Gives each square the share of an impulse that it has of the part.
    void spread(const FacePart& part, const Vec3& given);

private:
    std::vector<double> shares_among(const std::vector<Surface>& others) const;
    void take_areas(const std::vector<double>& shares);
};

/// A face of a barrier.
struct Face {
    int surface;                             ///< its number in the scene
    int number;                              ///< of the face in its surface
    Vec3 impulse{0, 0, 0}, moment{0, 0, 0};  ///< on the material since the start; about the grid's origin
    Patches patches;
};

/// All faces of all barriers in the order of the surfaces. Planes and the ground, whose impulses are known anyway
/// (SolidBody::impulse), have none here.
class FaceLedger {
public:
    FaceLedger() = default;
    /// Patches cover the part of each face that lies in the box from `low` to `high`.
    FaceLedger(const std::vector<Surface>& surfaces, const Vec3& low, const Vec3& high, double cell);

    const std::vector<Face>& faces() const { return faces_; }
    /// Number of the first face of a surface.
    int first(int surface) const { return first_[static_cast<std::size_t>(surface)]; }
    const Face& face(int surface, int number) const {
        return faces_[static_cast<std::size_t>(first(surface)) + static_cast<std::size_t>(number)];
    }
    /// Moment of a face's impulse about a point, both given from the grid's origin [kg m^2/s].
    static Vec3 moment_about(const Face& face, const Vec3& point);
    void add(const FaceImpulse& part);
    /// Saves what was given so far, or takes it up again.
    void serialize(Archive& archive);

private:
    std::vector<Face> faces_;
    std::vector<int> first_;
};

}  // namespace frana
