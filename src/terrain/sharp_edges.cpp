#include "terrain/sharp_edges.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "terrain/contact.h"

namespace frana {
namespace {

constexpr double kFlat = 0.9998;        // of a degree: triangles that turn less lie in one plane
constexpr double kBlocksOfReach = 0.5;  // a block's edge over the reach

/// A side of a triangle: its corners from the lower number to the higher one.
using Side = std::pair<Index, Index>;

/// Triangles as they touch.
struct Touching {
    const TriangleMesh& mesh;
    std::vector<Vec3> normal;
    std::map<Side, std::vector<std::size_t>> triangles;
    std::vector<std::size_t> parent;

    explicit Touching(const TriangleMesh& m) : mesh(m), parent(m.triangles.size()) {
        std::iota(parent.begin(), parent.end(), std::size_t{0});
        for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
            const auto& t = mesh.triangles[n];
            normal.push_back((at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])).stableNormalized());
            for (std::size_t c = 0; c < 3; ++c)
                triangles[{std::min(t[c], t[(c + 1) % 3]), std::max(t[c], t[(c + 1) % 3])}].push_back(n);
        }
        for (const auto& [side, two] : triangles)
            if (two.size() == 2 && normal[two[0]].dot(normal[two[1]]) > kFlat) parent[root(two[0])] = root(two[1]);
    }
    const Vec3& at(Index corner) const { return mesh.points[static_cast<std::size_t>(corner)]; }
    std::size_t root(std::size_t n) const {
        while (parent[n] != n) n = parent[n];
        return n;
    }
    /// The middle of what a triangle has besides a side.
    Vec3 third(std::size_t n, const Side& side) const {
        for (const Index corner : mesh.triangles[n])
            if (corner != side.first && corner != side.second) return at(corner);
        return at(side.first);
    }
    bool sharp(const std::vector<std::size_t>& two) const {
        return two.size() == 2 && normal[two[0]].dot(normal[two[1]]) < kSameFace;
    }
    /// Above zero where the edge stands in: the other triangle rises over the plane of the first.
    double rise(const Side& side, const std::vector<std::size_t>& two) const {
        return normal[two[0]].dot(third(two[1], side) - at(side.first));
    }
};

SharpEdge edge_of(const Touching& touching, const Side& side, const std::vector<std::size_t>& two, const Vec3& origin) {
    SharpEdge edge;
    const Vec3 way = touching.at(side.second) - touching.at(side.first);
    edge.from = touching.at(side.first) - origin;
    edge.length = way.norm();
    edge.along = way / edge.length;
    for (std::size_t k = 0; k < 2; ++k) {
        const Vec3 in = touching.third(two[k], side) - touching.at(side.first);
        edge.face[k] = static_cast<int>(touching.root(two[k]));
        edge.normal[k] = touching.normal[two[k]];
        edge.into[k] = (in - edge.along.dot(in) * edge.along).normalized();
    }
    return edge;
}

}  // namespace

SharpEdges::SharpEdges(const TriangleMesh& mesh, const Vec3& origin, const Vec3& end, double reach) {
    const Touching touching(mesh);
    std::vector<bool> bent(mesh.points.size(), false);
    std::vector<Side> sides;
    for (const auto& [side, two] : touching.triangles) {
        if (!touching.sharp(two) || !((touching.at(side.second) - touching.at(side.first)).norm() > 0.0)) continue;
        if (touching.rise(side, two) > 0.0)
            bent[static_cast<std::size_t>(side.first)] = bent[static_cast<std::size_t>(side.second)] = true;
        else
            edges_.push_back(edge_of(touching, side, two, origin)), sides.push_back(side);
    }
    for (std::size_t n = 0; n < edges_.size(); ++n)
        edges_[n].bent = {bent[static_cast<std::size_t>(sides[n].first)],
                          bent[static_cast<std::size_t>(sides[n].second)]};
    if (edges_.empty()) return;
    block_ = kBlocksOfReach * reach;
    for (int k = 0; k < 3; ++k)
        blocks_[static_cast<std::size_t>(k)] = 1 + static_cast<Index>((end[k] - origin[k]) / block_);
    std::vector<std::vector<std::size_t>> of_block(static_cast<std::size_t>(blocks_[0] * blocks_[1] * blocks_[2]));
    for (std::size_t e = 0; e < edges_.size(); ++e) {
        std::array<Index, 3> low{}, high{};
        for (int k = 0; k < 3; ++k) {
            const auto axis = static_cast<std::size_t>(k);
            const double from = edges_[e].from[k], to = from + edges_[e].length * edges_[e].along[k];
            const auto block = [&](double x) {
                return static_cast<Index>(std::clamp(x / block_, 0.0, static_cast<double>(blocks_[axis] - 1)));
            };
            low[axis] = block(std::min(from, to) - reach), high[axis] = block(std::max(from, to) + reach);
        }
        for (Index k = low[2]; k <= high[2]; ++k)
            for (Index j = low[1]; j <= high[1]; ++j)
                for (Index i = low[0]; i <= high[0]; ++i)
                    of_block[static_cast<std::size_t>((k * blocks_[1] + j) * blocks_[0] + i)].push_back(e);
    }
    first_.push_back(0);
    for (const auto& list : of_block) {
        listed_.insert(listed_.end(), list.begin(), list.end());
        first_.push_back(listed_.size());
    }
}

int SharpEdges::faces_near(const Vec3& x, double radius, double over, EdgeFace* list) const {
    if (edges_.empty()) return 0;
    std::size_t block = 0;
    for (std::size_t k = 3; k-- > 0;) {
        const double at = x[static_cast<Eigen::Index>(k)] / block_;
        if (!(at >= 0.0 && at < static_cast<double>(blocks_[k]))) return 0;
        block = block * static_cast<std::size_t>(blocks_[k]) + static_cast<std::size_t>(at);
    }
    int count = 0;
    for (std::size_t n = first_[block]; n < first_[block + 1]; ++n) {
        const SharpEdge& edge = edges_[listed_[n]];
        const Vec3 way = x - edge.from;
        const double t = edge.along.dot(way), seam = 1e-9 * edge.length, more = over * edge.along.lpNorm<1>();
        if (t < -(edge.bent[0] ? 0.0 : more) - seam || t > edge.length + (edge.bent[1] ? 0.0 : more) + seam) continue;
        if ((way - std::clamp(t, 0.0, edge.length) * edge.along).squaredNorm() > radius * radius) continue;
        for (std::size_t k = 0; k < 2; ++k) {
            const double beyond = -edge.into[k].dot(way) / edge.into[k].lpNorm<1>();
            EdgeFace* const same =
                std::find_if(list, list + count, [&](const EdgeFace& f) { return f.face == edge.face[k]; });
            if (same < list + count)
                same->beyond = std::max(same->beyond, beyond);
            else if (count < kMostFaces)
                list[count++] = {edge.face[k], edge.normal[k].dot(way), edge.normal[k], beyond};
        }
    }
    return count;
}

}  // namespace frana
