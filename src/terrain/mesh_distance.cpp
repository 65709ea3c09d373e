#include "terrain/mesh_distance.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "base/error.h"

namespace frana {
namespace {

/// What of a triangle lies nearest: corners 0 to 2, edges 3 to 5 (0-1, 1-2, 2-0), or its inside.
constexpr std::size_t kEdge = 3, kInside = 6;

struct Nearest {
    double square = std::numeric_limits<double>::infinity();  ///< of the distance [m2]
    Vec3 place{0, 0, 0};
    std::size_t triangle = 0, part = kInside;
};

/// Nearest place of the edge from `a` by `way`, which is corner `first` to corner `second`.
Nearest on_edge(const Vec3& x, const Vec3& a, const Vec3& way, std::size_t first, std::size_t second,
                std::size_t edge) {
    const double length2 = way.squaredNorm(), t = length2 > 0.0 ? way.dot(x - a) / length2 : 0.0;
    Nearest near;
    near.part = t <= 0.0 ? first : t >= 1.0 ? second : edge;
    near.place = a + std::clamp(t, 0.0, 1.0) * way;
    near.square = (x - near.place).squaredNorm();
    return near;
}

/// Above its inside a place is as near to the triangle as to its plane. Elsewhere it is as near as to one of its edges.
Nearest on_triangle(const Vec3& x, const std::array<Vec3, 3>& corner) {
    const Vec3 ab = corner[1] - corner[0], ac = corner[2] - corner[0], ax = x - corner[0];
    const double bb = ab.squaredNorm(), bc = ab.dot(ac), cc = ac.squaredNorm(), xb = ax.dot(ab), xc = ax.dot(ac);
    const double area = bb * cc - bc * bc, v = cc * xb - bc * xc, w = bb * xc - bc * xb;
    if (area > 0.0 && v > 0.0 && w > 0.0 && v + w < area) {
        Nearest near;
        near.place = corner[0] + (v / area) * ab + (w / area) * ac;
        near.square = (x - near.place).squaredNorm();
        return near;
    }
    Nearest near = on_edge(x, corner[0], ab, 0, 1, kEdge);
    for (const Nearest& other : {on_edge(x, corner[1], corner[2] - corner[1], 1, 2, kEdge + 1),
                                 on_edge(x, corner[2], corner[0] - corner[2], 2, 0, kEdge + 2)})
        if (other.square < near.square) near = other;
    return near;
}

/// A tree of boxes around triangles. Every part of a triangle has a normal that tells inside from outside for the
/// places nearest to it. Of an edge it is the sum of its two triangles'. Of a corner it is that of all around it,
/// weighted by their angles there (Baerentzen and Aanaes 2005).
class MeshTree {
public:
    explicit MeshTree(const TriangleMesh& mesh) : order_(mesh.triangles.size()) {
        for (const auto& t : mesh.triangles) {
            auto& corner = corners_.emplace_back();
            for (std::size_t c = 0; c < 3; ++c) corner[c] = mesh.points[static_cast<std::size_t>(t[c])];
        }
        std::iota(order_.begin(), order_.end(), std::size_t{0});
        take_normals(mesh);
        boxes_.reserve(2 * order_.size());
        build(0, order_.size());
    }

    /// `bound`: the distance is known to be no larger [m].
    double signed_distance(const Vec3& x, double bound) const {
        Nearest best;
        best.square = bound * bound;
        search(0, x, best);
        const double side = normals_[best.triangle][best.part].dot(x - best.place);
        return side < 0.0 ? -std::sqrt(best.square) : std::sqrt(best.square);
    }

private:
    struct Box {
        Vec3 low, high;
        std::size_t first, last;  ///< of a leaf: its triangles in order_; of others last is 0
        std::size_t second;       ///< of others: the other child; one is the next box
        double square_to(const Vec3& x) const { return (low - x).cwiseMax(x - high).cwiseMax(0.0).squaredNorm(); }
    };

    void take_normals(const TriangleMesh& mesh) {
        std::vector<Vec3> at_corner(mesh.points.size(), Vec3::Zero());
        std::map<std::pair<Index, Index>, Vec3> at_edge;
        const auto edge = [&](const auto& t, std::size_t c) {
            const auto p = static_cast<Index>(t[c]), q = static_cast<Index>(t[(c + 1) % 3]);
            return std::pair{std::min(p, q), std::max(p, q)};
        };
        for (std::size_t n = 0; n < corners_.size(); ++n) {
            const auto& x = corners_[n];
            const Vec3 normal = (x[1] - x[0]).cross(x[2] - x[0]).stableNormalized();
            normals_.emplace_back()[kInside] = normal;
            for (std::size_t c = 0; c < 3; ++c) {
                const Vec3 a = x[(c + 1) % 3] - x[c], b = x[(c + 2) % 3] - x[c];
                at_corner[static_cast<std::size_t>(mesh.triangles[n][c])] +=
                    std::atan2(a.cross(b).norm(), a.dot(b)) * normal;
                at_edge.try_emplace(edge(mesh.triangles[n], c), Vec3::Zero()).first->second += normal;
            }
        }
        for (std::size_t n = 0; n < corners_.size(); ++n)
            for (std::size_t c = 0; c < 3; ++c) {
                normals_[n][c] = at_corner[static_cast<std::size_t>(mesh.triangles[n][c])];
                normals_[n][kEdge + c] = at_edge.at(edge(mesh.triangles[n], c));
            }
    }

    void build(std::size_t first, std::size_t last) {
        Eigen::AlignedBox3d all, middles;
        const auto middle = [&](std::size_t n) {
            return Vec3((corners_[n][0] + corners_[n][1] + corners_[n][2]) / 3.0);
        };
        for (std::size_t n = first; n < last; ++n) {
            for (const Vec3& x : corners_[order_[n]]) all.extend(x);
            middles.extend(middle(order_[n]));
        }
        const std::size_t here = boxes_.size();
        boxes_.push_back({all.min(), all.max(), first, last, 0});
        constexpr std::size_t kLeaf = 4;
        if (last - first <= kLeaf) return;
        Index axis = 0;
        middles.sizes().maxCoeff(&axis);
        const std::size_t half = first + (last - first) / 2;
        const auto at = [&](std::size_t n) { return order_.begin() + static_cast<std::ptrdiff_t>(n); };
        std::nth_element(at(first), at(half), at(last), [&](std::size_t a, std::size_t b) {
            const double xa = middle(a)[axis], xb = middle(b)[axis];
            return xa < xb || (xa == xb && a < b);
        });
        build(first, half);
        boxes_[here].last = 0;
        boxes_[here].second = boxes_.size();
        build(half, last);
    }

    void search(std::size_t at, const Vec3& x, Nearest& best) const {
        const Box& box = boxes_[at];
        for (std::size_t n = box.first; n < box.last; ++n) {
            Nearest near = on_triangle(x, corners_[order_[n]]);
            near.triangle = order_[n];
            if (near.square < best.square) best = near;
        }
        if (box.last > 0) return;
        std::size_t near = at + 1, far = box.second;
        double to_near = boxes_[near].square_to(x), to_far = boxes_[far].square_to(x);
        if (to_far < to_near) std::swap(near, far), std::swap(to_near, to_far);
        if (to_near < best.square) search(near, x, best);
        if (to_far < best.square) search(far, x, best);
    }

    std::vector<std::array<Vec3, 3>> corners_;
    std::vector<std::array<Vec3, 7>> normals_;
    std::vector<std::size_t> order_;
    std::vector<Box> boxes_;
};

}  // namespace

void measure_distances(const TriangleMesh& mesh, DistanceField& field) {
    expect(!mesh.triangles.empty(), "distances from no triangles");
    constexpr double kReach =
        18.0;  // spacings: of mirror particles in cells of two of them, 1.5 times kLongestReach and 1
    field.sharp = SharpEdges(mesh, field.origin, field.end(), kReach * field.spacing);
    const MeshTree tree(mesh);
    const Index rows = field.nodes[1] * field.nodes[2];
#pragma omp parallel for schedule(dynamic, 16)
    for (Index row = 0; row < rows; ++row) {
        const Index j = row % field.nodes[1], k = row / field.nodes[1];
        double bound = std::numeric_limits<double>::infinity();
        for (Index i = 0; i < field.nodes[0]; ++i) {
            const double distance = tree.signed_distance(field.place(i, j, k), bound);
            field.at(i, j, k) = distance;
            bound = (std::abs(distance) + field.spacing) * (1.0 + 1e-6);  // no distance grows faster than the way
        }
    }
}

}  // namespace frana
