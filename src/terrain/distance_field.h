#pragma once
// A solid of any shape as signed distances on a regular grid.
#include <array>
#include <utility>
#include <vector>

#include "terrain/contact.h"
#include "terrain/sharp_edges.h"

namespace frana {

/// Distances from the solid's surface [m], negative inside, trilinear between nodes. Its faces are six: where
/// the normal points most to -x, +x, -y, +y, -z, +z. What is smaller than the grid's spacing is lost; sharp
/// edges are rounded by about half of it.
struct DistanceField {
    Vec3 origin{0, 0, 0};          ///< of node (0, 0, 0) [m]
    double spacing = 1.0;          ///< [m]
    std::array<Index, 3> nodes{};  ///< in x, y and z, two or more
    std::vector<double> distance;  ///< at (k nodes_y + j) nodes_x + i [m]
    SharpEdges sharp;              ///< edges that are known better than that, of a mesh

    double& at(Index i, Index j, Index k) {
        return distance[static_cast<std::size_t>((k * nodes[1] + j) * nodes[0] + i)];
    }
    double at(Index i, Index j, Index k) const {
        return distance[static_cast<std::size_t>((k * nodes[1] + j) * nodes[0] + i)];
    }
    Vec3 place(Index i, Index j, Index k) const {
        return origin + spacing * Vec3(static_cast<double>(i), static_cast<double>(j), static_cast<double>(k));
    }
    Vec3 end() const { return place(nodes[0] - 1, nodes[1] - 1, nodes[2] - 1); }

    /// Number of the face that has that normal.
    static int face_of(const Vec3& normal);
    /// Beyond the grid the value goes on as it left it, and never below the distance from the grid.
    Contact contact(const Vec3& x) const;
    bool inside(const Vec3& x) const { return contact(x).distance < 0.0; }
    /// Whether the way between two places, the first outside, goes into the solid, sampled at every half spacing.
    bool enters(const Vec3& from, const Vec3& to, Entry& entry) const;
    /// Length of the solid from a place on its surface into the unit direction `way` [m]; a spacing at least.
    double thickness(const Vec3& from, const Vec3& way) const;
    /// The highest place of the solid above or below a place of the map; minus infinity where there is none [m].
    double top_at(const Vec2& p) const;
    std::pair<Vec3, Vec3> box() const { return {origin, end()}; }
};

}  // namespace frana
