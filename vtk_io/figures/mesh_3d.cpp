#include "vtk_io/figures/mesh_3d.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace frana {
namespace {

/// What lies behind a patch: the part of the mesh that is turned to its face.
struct Behind {
    Vec3 area{0, 0, 0};   ///< sum of area times outward normal [m2]
    Vec3 place{0, 0, 0};  ///< sum of area times middle [m3]
    double size = 0.0;    ///< sum of areas [m2]
};

/// A side of the box around a mesh.
struct Side {
    explicit Side(const LoadedFace& loaded)
        : face(loaded),
          corner(loaded.corner()),
          right(loaded.right()),
          up(loaded.up()),
          outward((loaded.patches.front().face % 2 == 1 ? 1.0 : -1.0) * right.cross(up)),
          size(loaded.size()),
          columns(std::max(1L, std::lround(loaded.longest() / size))),
          rows(static_cast<long>(loaded.patches.size()) / columns),
          behind(loaded.patches.size()) {}

    Vec2 project(const Vec3& x) const { return {right.dot(x - corner), up.dot(x - corner)}; }
    long column(double u) const { return std::clamp(static_cast<long>(std::floor(u / size)), 0L, columns - 1); }
    long row(double v) const { return std::clamp(static_cast<long>(std::floor(v / size)), 0L, rows - 1); }
    std::size_t at(long column, long row) const { return static_cast<std::size_t>(row * columns + column); }
    std::size_t at(const Vec3& x) const { return at(column(project(x).x()), row(project(x).y())); }
    const LoadedPatch& patch(std::size_t n) const { return face.patches[n]; }

    const LoadedFace& face;
    Vec3 corner, right, up, outward;
    double size;  ///< of a patch [m]
    long columns, rows;
    std::vector<Behind> behind;    ///< of each patch
    std::vector<double> pressure;  ///< of each patch, smoothed [Pa]
};

Vec3 middle_of(const std::vector<Vec3>& corners) {
    Vec3 sum(0, 0, 0);
    for (const Vec3& p : corners) sum += p;
    return sum / static_cast<double>(corners.size());
}

/// Sum of the area times the normal of a plane polygon [m2].
Vec3 area_of(const std::vector<Vec3>& corners) {
    Vec3 sum(0, 0, 0);
    for (std::size_t k = 2; k < corners.size(); ++k)
        sum += 0.5 * (corners[k - 1] - corners[0]).cross(corners[k] - corners[0]);
    return sum;
}

class MeshBuilder {
public:
    MeshBuilder(const std::vector<LoadedFace>& faces, std::shared_ptr<const TriangleMesh> mesh, const Raster& bed)
        : bed_(bed) {
        for (const LoadedFace& face : faces) sides_.emplace_back(face);
        solid_.mesh = std::move(mesh);
    }

    BarrierSolid solid() {
        for (const auto& t : solid_.mesh->triangles) add({corner(t[0]), corner(t[1]), corner(t[2])});
        for (const auto& edge : sharp_edges(*solid_.mesh, sides_.front().size)) add_edge(edge.front(), edge.back());
        paint();
        sum_load();
        far_first();
        return std::move(solid_);
    }

private:
    const Vec3& corner(Index n) const { return solid_.mesh->points[static_cast<std::size_t>(n)]; }

    /// Height above the ground, where there is any [m].
    double height(const Vec3& p) const {
        const double ground = elevation_at(bed_, p.head<2>());
        return std::isnan(ground) ? 1.0 : p.z() - ground;
    }

    /// Down to the ground, with `a` as its upper end.
    void add_edge(Vec3 a, Vec3 b) {
        if (height(a) < height(b)) std::swap(a, b);
        const double from = height(a), to = height(b);
        if (from <= 0.0) return;
        if (to < 0.0) b = a + (b - a) * (from / (from - to));
        solid_.edges.push_back({a, b});
    }

    /// The part of a polygon that is no deeper in the ground than half a patch.
    std::vector<Vec3> seen(const std::vector<Vec3>& corners) const {
        const double sunk = 0.5 * sides_.front().size;
        std::vector<Vec3> kept;
        for (std::size_t k = 0; k < corners.size(); ++k) {
            const Vec3 &a = corners[k], &b = corners[(k + 1) % corners.size()];
            const double from = height(a) + sunk, to = height(b) + sunk;
            if (from >= 0.0) kept.push_back(a);
            if ((from > 0.0 && to < 0.0) || (from < 0.0 && to > 0.0))
                kept.emplace_back(a + (b - a) * (from / (from - to)));
        }
        return kept;
    }

    /// The side that a normal is turned to most. Then come those nearly as much, which may have got the force as well.
    std::vector<std::size_t> sides_of(const Vec3& normal) const {
        constexpr double kAsMuch = 0.02;  // 0.8 degrees off the middle: more would count twice on round meshes
        std::size_t most = 0;
        for (std::size_t n = 1; n < sides_.size(); ++n)
            if (normal.dot(sides_[n].outward) > normal.dot(sides_[most].outward)) most = n;
        std::vector<std::size_t> list{most};
        for (std::size_t n = 0; n < sides_.size(); ++n)
            if (n != most && normal.dot(sides_[n].outward) > normal.dot(sides_[most].outward) - kAsMuch)
                list.push_back(n);
        return list;
    }

    void add(const std::vector<Vec3>& triangle) {
        const Vec3 area = area_of(triangle);
        if (!(area.norm() > 0.0)) return;
        const Vec3 normal = area.normalized();
        const std::vector<std::size_t> turned_to = sides_of(normal);
        for (const std::size_t n : turned_to) cut_up(triangle, normal, sides_[n], n == turned_to.front());
    }

    /// Along the lines between the patches of a side.
    void cut_up(const std::vector<Vec3>& triangle, const Vec3& normal, Side& side, bool keeps) {
        Polyline flat;
        for (const Vec3& x : triangle) flat.push_back(side.project(x));
        Vec2 low = flat[0], high = flat[0];
        for (const Vec2& p : flat) low = low.cwiseMin(p), high = high.cwiseMax(p);
        for (long j = side.row(low.y()); j <= side.row(high.y()); ++j)
            for (long i = side.column(low.x()); i <= side.column(high.x()); ++i) {
                const Vec2 from = side.size * Vec2(static_cast<double>(i), static_cast<double>(j));
                std::vector<Vec3> corners;
                for (const Vec2& p : cut_to_square(flat, from, from + Vec2(side.size, side.size))) {
                    const Vec3 x = side.corner + p.x() * side.right + p.y() * side.up;
                    const double off = normal.dot(triangle[0] - x) / normal.dot(side.outward);
                    corners.emplace_back(x + off * side.outward);
                }
                add_piece(seen(corners), normal, side.behind[side.at(i, j)], keeps);
            }
    }

    void add_piece(std::vector<Vec3> corners, const Vec3& normal, Behind& behind, bool keeps) {
        const double size = corners.size() < 3 ? 0.0 : area_of(corners).norm();
        const double least = 1e-9 * sides_.front().size * sides_.front().size;  // else the square only meets its edge
        if (size <= least) return;
        behind.area += size * normal;
        behind.place += size * middle_of(corners);
        behind.size += size;
        if (!keeps) return;
        const auto highest = std::max_element(corners.begin(), corners.end(),
                                              [](const Vec3& a, const Vec3& b) { return a.z() < b.z(); });
        std::rotate(corners.begin(), highest + 1, corners.end());  // best_view() checks whether the last is seen
        solid_.pieces.push_back({std::move(corners), normal, 0.0});
    }

    void paint() {
        for (Side& side : sides_)
            side.pressure = smoothed(side.face, [&](const LoadedPatch& patch) {
                return side.behind[static_cast<std::size_t>(&patch - side.face.patches.data())].size > 0.0;
            });
        for (BarrierSolid::Piece& piece : solid_.pieces) {
            const Vec3 middle = middle_of(piece.corners);
            for (const std::size_t n : sides_of(piece.normal))
                piece.pressure += sides_[n].pressure[sides_[n].at(middle)];
        }
    }

    /// A patch has the pressure across its face. The force is on what lies behind it.
    void sum_load() {
        double weight = 0.0, highest = -1e300;
        Vec3 place(0, 0, 0), middle(0, 0, 0);
        for (const Side& side : sides_)
            for (std::size_t n = 0; n < side.behind.size(); ++n) {
                const Behind& behind = side.behind[n];
                const double force = side.patch(n).pressure * side.size * side.size;
                const Vec3 way = behind.size > 0.0 ? Vec3(behind.area / behind.area.dot(side.outward)) : side.outward;
                solid_.load -= force * way;
                if (behind.size <= 0.0) continue;
                const double flat = force * way.head<2>().norm();
                place += flat * behind.place / behind.size;
                weight += flat;
            }
        for (const auto& piece : solid_.pieces) {
            middle += middle_of(piece.corners) / static_cast<double>(solid_.pieces.size());
            highest = std::max(highest, piece.corners.back().z());
        }
        middle.z() = highest;
        solid_.middle_of_load = weight > 0.0 ? Vec3(place / weight) : middle;
    }

    /// As seen along the load: the picture of the struck face is painted in this order.
    void far_first() {
        const Vec2 ahead = solid_.load.head<2>();
        const auto depth = [&](const BarrierSolid::Piece& piece) { return ahead.dot(piece.corners.back().head<2>()); };
        std::stable_sort(solid_.pieces.begin(), solid_.pieces.end(),
                         [&](const auto& a, const auto& b) { return depth(a) > depth(b); });
    }

    const Raster& bed_;
    std::vector<Side> sides_;
    BarrierSolid solid_;
};

}  // namespace

BarrierSolid mesh_solid(const std::vector<LoadedFace>& faces, std::shared_ptr<const TriangleMesh> mesh,
                        const Raster& bed) {
    return MeshBuilder(faces, std::move(mesh), bed).solid();
}

}  // namespace frana
