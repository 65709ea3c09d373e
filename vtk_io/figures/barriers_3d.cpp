#include "vtk_io/figures/barriers_3d.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "vtk_io/figures/faces_3d.h"
#include "vtk_io/figures/mesh_3d.h"

namespace frana {
namespace {

/// Length of a side that ends at `next`, within its last patch, on its line. Nothing when it does not.
std::optional<double> length_to(const LoadedFace& side, const Vec3& next) {
    const Vec3 way = next - side.corner();
    const double along = side.right().dot(way), all = side.longest(), slack = 1e-3 * side.size();
    const double off_plane = (way - along * side.right()).head<2>().norm();
    if (off_plane > slack || along > all + slack || along < all - side.size() - slack) return std::nullopt;
    return along;
}

/// Lengths of the sides and, from their corners, the rings of the outline.
std::vector<double> lengths_of(const std::vector<LoadedFace>& sides, std::vector<Polyline>& rings) {
    std::vector<double> lengths;
    std::size_t first = 0;
    for (std::size_t k = 0; k < sides.size(); ++k) {
        if (k == first) rings.emplace_back();
        rings.back().push_back(sides[k].corner().head<2>());
        const auto on = k + 1 < sides.size() ? length_to(sides[k], sides[k + 1].corner()) : std::nullopt;
        const auto back = length_to(sides[k], sides[first].corner());
        lengths.push_back(on ? *on : back.value_or(sides[k].longest()));
        if (!on) first = k + 1;
    }
    return lengths;
}

class Builder {
public:
    Builder(std::vector<LoadedFace> faces, const BarrierTop& top, const Raster& bed) : top_(top), bed_(bed) {
        for (LoadedFace& face : faces) (face.is_side() ? sides_ : tops_).push_back(std::move(face));
        for (const LoadedFace& side : sides_)
            for (const LoadedPatch& patch : side.patches) highest_ = std::max(highest_, patch.corners[2].z());
        if (!tops_.empty()) highest_ = tops_.front().corner().z();
    }

    BarrierSolid solid() {
        const std::vector<double> lengths = lengths_of(sides_, solid_.rings);
        for (std::size_t k = 0; k < sides_.size(); ++k) add_side(sides_[k], lengths[k]);
        for (const LoadedFace& top : tops_) add_top(top);
        for (const Polyline& ring : solid_.rings) add_edges(ring);
        sum_load();
        return std::move(solid_);
    }

private:
    double end(const Vec2& p) const { return std::min(highest_, top_at(top_, bed_, p, highest_)); }

    void add_side(const LoadedFace& side, double length) {
        const Vec3 normal = side.right().cross(side.up()), corner = side.corner(), right = side.right();
        const std::vector<double> pressure = smoothed(side, [&](const LoadedPatch& patch) {
            return patch.corners[3].z() > elevation_at(bed_, 0.5 * (patch.corners[0] + patch.corners[1]).head<2>());
        });
        for (std::size_t k = 0; k < side.patches.size(); ++k) {
            const LoadedPatch& patch = side.patches[k];
            const double u0 = right.dot(patch.corners[0] - corner), u1 = std::min(u0 + side.size(), length);
            const Vec2 a = (corner + u0 * right).head<2>(), b = (corner + u1 * right).head<2>();
            const double sunk = 0.5 * side.size(), low = patch.corners[0].z(), high = patch.corners[3].z();
            const auto foot = [&](const Vec2& p) {
                const double ground = elevation_at(bed_, p) - sunk;
                return std::isnan(ground) ? low : std::max(low, ground);
            };
            const double foot_a = foot(a), foot_b = foot(b), top_a = std::min(high, end(a)),
                         top_b = std::min(high, end(b));
            if (u1 <= u0 || (top_a <= foot_a && top_b <= foot_b)) continue;
            const auto at = [](const Vec2& p, double z) { return Vec3(p.x(), p.y(), z); };
            solid_.pieces.push_back(
                {{at(a, std::min(foot_a, top_a)), at(b, std::min(foot_b, top_b)), at(b, top_b), at(a, top_a)},
                 normal,
                 pressure[k]});
        }
    }

    /// With one ring what is within; with several, whole patches by their middles.
    void add_top(const LoadedFace& top) {
        if (solid_.rings.size() == 1 && top_.level) add_bare_top(0.001 * top.size());
        const std::vector<double> pressure = smoothed(top, [](const LoadedPatch&) { return true; });
        for (std::size_t k = 0; k < top.patches.size(); ++k) {
            const LoadedPatch& patch = top.patches[k];
            const Vec2 low = patch.corners[0].head<2>(), high = patch.corners[2].head<2>();
            Polyline part{low, {high.x(), low.y()}, high, {low.x(), high.y()}};
            if (solid_.rings.size() == 1)
                part = cut_to_square(solid_.rings.front(), low, high);
            else if (!solid_.within(0.5 * (low + high)))
                part.clear();
            if (part.size() < 3) continue;
            BarrierSolid::Piece piece{{}, {0, 0, 1}, pressure[k]};
            for (const Vec2& p : part) piece.corners.emplace_back(p.x(), p.y(), end(p));
            solid_.pieces.push_back(piece);
        }
    }

    /// All of it just below the patches, which end where the space with points does.
    void add_bare_top(double below) {
        BarrierSolid::Piece piece{{}, {0, 0, 1}, 0.0};
        for (const Vec2& p : solid_.rings.front()) piece.corners.emplace_back(p.x(), p.y(), highest_ - below);
        solid_.pieces.push_back(piece);
    }

    void add_edges(const Polyline& ring) {
        constexpr double kDense = 40.0;  // places along an edge at most, for a top that follows the bed
        for (std::size_t k = 0; k < ring.size(); ++k) {
            const Vec2& from = ring[k];
            const Vec2 way = ring[(k + 1) % ring.size()] - from;
            const double parts = top_.level ? 1.0 : kDense;
            std::vector<Vec3> edge;
            for (double n = 0.0; n <= parts; n += 1.0) {
                const Vec2 p = from + way * (n / parts);
                edge.emplace_back(p.x(), p.y(), end(p));
            }
            solid_.edges.push_back(edge);
            const double ground = elevation_at(bed_, from);
            if (end(from) > ground) solid_.edges.push_back({edge.front(), {from.x(), from.y(), ground}});
        }
    }

    void sum_load() {
        double weight = 0.0;
        Vec3 place(0, 0, 0), middle(0, 0, 0);
        for (const LoadedFace& side : sides_) {
            const double area = side.size() * side.size();
            for (const LoadedPatch& patch : side.patches) {
                const double force = patch.pressure * area;
                solid_.load -= force * side.right().cross(side.up());
                place += force * 0.5 * (patch.corners[0] + patch.corners[2]);
                weight += force;
            }
            middle += side.corner() / static_cast<double>(sides_.size());
        }
        middle.z() = highest_;
        solid_.middle_of_load = weight > 0.0 ? Vec3(place / weight) : middle;
    }

    BarrierTop top_;
    const Raster& bed_;
    std::vector<LoadedFace> sides_, tops_;
    double highest_ = -1e300;
    BarrierSolid solid_;
};

}  // namespace

bool BarrierSolid::within(const Vec2& p) const {
    bool inside = false;
    for (const Polyline& ring : rings)
        for (std::size_t k = 0; k < ring.size(); ++k) {
            const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
            if ((a.y() > p.y()) != (b.y() > p.y()) &&
                p.x() < a.x() + (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y()))
                inside = !inside;
        }
    return inside;
}

std::vector<BarrierSolid> barrier_solids(const std::vector<LoadedPatch>& patches, const std::vector<BarrierTop>& tops,
                                         const Raster& bed, const BarrierMeshes& meshes) {
    int count = 0;
    for (const LoadedPatch& patch : patches) count = std::max(count, patch.barrier + 1);
    std::vector<BarrierSolid> solids;
    for (int n = 0; n < count; ++n) {
        std::vector<LoadedFace> faces = faces_of(patches, n);
        if (faces.empty()) continue;
        if (static_cast<std::size_t>(n) < meshes.size() && meshes[static_cast<std::size_t>(n)]) {
            solids.push_back(mesh_solid(faces, meshes[static_cast<std::size_t>(n)], bed));
            solids.back().number = n;
            if (solids.back().pieces.empty()) solids.pop_back();  // all of it is buried
            continue;
        }
        BarrierTop top;
        top.level = 1e300;  // as high as its sides
        if (static_cast<std::size_t>(n) < tops.size()) top = tops[static_cast<std::size_t>(n)];
        const bool has_one_top =
            std::count_if(faces.begin(), faces.end(), [](const LoadedFace& f) { return !f.is_side(); }) == 1;
        if (faces.size() < 4 || !has_one_top || faces.back().is_side())
            continue;  // of any shape, and its mesh is not known
        solids.push_back(Builder(std::move(faces), top, bed).solid());
        solids.back().number = n;
    }
    return solids;
}

}  // namespace frana
