#pragma once
// A solid with vertical walls on a footprint, which reaches down without end: walls, houses, dams.
#include <utility>
#include <vector>

#include "solid3d/edge_faces.h"
#include "terrain/raster.h"

namespace frana {

/// The area of polygons that do not overlap one another, from their top downwards. Faces are numbered. First come the
/// sides in the order of the polygons' edges, parts and rings in turn, and then the top.
class Prism {
public:
    /// A level top [m]. Throws UserError when the outline has no area or a side without length.
    Prism(const Polygons& outline, double top);
    /// A top that follows a height field [m].
    Prism(const Polygons& outline, Raster top);

    /// Faces that a point can meet, the nearest first, at most kMostContacts of them. They are no farther than a point
    /// and its mirror particle reach. Before an edge that stands out it is the one direction to it. In a corner that
    /// stands in it is both of its planes, which a point inside sees as well. The solid may be so thin that material of
    /// both sides shares nodes (3 (|n_x| + |n_y|) cells). Then a place inside meets both sides and the top.
    int contacts(const Vec3& x, double cell, Contact* list) const;
    /// At an edge that stands out a node carries pressure of both faces. Appends those that are not among the `count`
    /// of `list`, in place of the one direction to the edge.
    MetFaces faces_at_edge(const Vec3& x, double cell, Contact* list, int count) const;
    bool inside(const Vec3& x) const { return x.z() < top_at(x.head<2>()) && within(x.head<2>()); }
    /// Whether the way between two places, the first outside, goes into the solid.
    bool enters(const Vec3& from, const Vec3& to, Entry& entry) const;
    /// This face's share of the mirror particle that a point before `contact` shows at `place`, in the solid.
    /// At an edge that stands out the faces' mirror particles would fill the solid twice and three times. They would
    /// drive material away from the edge. Each face has what is nearest to it, and halfway between two of them both
    /// blend over `blend` [m]. An edge itself shows none.
    double mirror_share(const Contact& contact, const Vec3& place, double blend) const;
    /// Length of the solid from a place on its surface into the unit direction `way` [m].
    double thickness(const Vec3& from, const Vec3& way) const;

    int faces() const { return static_cast<int>(edges_.size()) + 1; }
    int top_face() const { return static_cast<int>(edges_.size()); }
    /// Corners of the box around it; the lower one has no height of its own.
    std::pair<Vec3, Vec3> box() const { return {low_, high_}; }
    /// A side: its start and its end in plan, and its outward normal.
    struct Edge {
        Vec2 from, along, normal;  ///< along, normal: unit vectors
        double length;             ///< [m]
        int before, after;         ///< neighbours in the ring
        bool starts_in, ends_in;   ///< whether the corner there stands in
        Vec2 to() const { return from + length * along; }
    };
    const std::vector<Edge>& edges() const { return edges_; }
    /// Its outline: outer rings counter-clockwise, holes clockwise, not closed.
    std::vector<std::vector<Vec2>> rings() const;
    double top_at(const Vec2& p) const;
    /// Whether a place is on the footprint.
    bool within(const Vec2& p) const;

private:
    void add_ring(std::vector<Vec2> ring, bool hole);
    void find_box();
    double highest_top() const;
    Contact top_contact(const Vec3& x) const;
    Contact lifted(const Vec3& x, double distance, const Vec2& normal, int face) const;
    int before_it(const Vec3& x, double reach, Contact* list) const;
    int within_it(const Vec3& x, double cell, Contact* list) const;
    bool is_face(const Contact& contact) const;
    int reached(const Vec3& x, double cell, Contact* list) const;
    bool sees(const Vec3& x, const Contact& contact, int nearest) const;

    std::vector<Edge> edges_;
    double level_ = 0.0;
    Raster top_;
    Vec3 low_, high_;
};

/// Outline of a wall along a line whose one face stands on the line. The material that counts lies to the left of it,
/// along the line (or to the right). To the other side lies its thickness [m]. Corners are mitred. Throws UserError
/// when the line has less than two different points or turns by more than 120 degrees.
enum class WetSide { left, right };
Polygons wall_outline(const Polyline& line, WetSide wet, double thickness);

/// The least thickness of a wall along the line at which material on its sides shares no node [m]. The nodes are those
/// of cells of that size. Thinner walls are thickened to it, away from the wet side.
double least_wall_thickness(const Polyline& line, double cell);

}  // namespace frana
