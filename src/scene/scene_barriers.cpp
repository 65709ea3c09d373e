// [[barrier]] of the case file.
#include <fmt/format.h>

#include <cmath>
#include <map>

#include "base/error.h"
#include "scene/scene_parts.h"

namespace frana {
namespace {

/// Whether the box around it meets the terrain.
bool meets(const std::vector<Vec2>& points, const std::array<double, 4>& extent) {
    Vec2 low(INFINITY, INFINITY), high(-INFINITY, -INFINITY);
    for (const Vec2& p : points) low = low.cwiseMin(p), high = high.cwiseMax(p);
    return low.x() <= extent[2] && high.x() >= extent[0] && low.y() <= extent[3] && high.y() >= extent[1];
}

/// A line that a wall can stand along: no turn by more than 120 degrees.
void require_wall(const Polyline& line) {
    constexpr double kSharpest = -0.5;  // cosine
    for (std::size_t k = 1; k + 1 < line.size(); ++k) {
        const Vec2 way = line[k] - line[k - 1], next = line[k + 1] - line[k];
        if (way.dot(next) < kSharpest * way.norm() * next.norm())
            throw UserError(fmt::format(
                "found a turn by more than 120 degrees at ({:.10g}, {:.10g}); expected a wall without one; draw "
                "two walls",
                line[k].x(), line[k].y()));
    }
}

class BarrierReader {
public:
    BarrierReader(const CaseFile& file, const GisReader& reader, const MeshReader& meshes, Scene& scene,
                  Problems& problems)
        : case_(file), reader_(reader), meshes_(meshes), scene_(scene), problems_(problems) {}

    void read(Index i) {
        prefix_ = fmt::format("barrier.{}.", i);
        Barrier barrier;
        barrier.name = given("name") ? case_.word(prefix_ + "name") : fmt::format("barrier_{}", i + 1);
        std::vector<Vec2> vertices;
        if (given("mesh") ? !read_mesh(barrier, vertices) : !read_plan(barrier, vertices)) return;
        const auto extent = scene_.bed.geometry.pixel_extent();
        if (!meets(vertices, extent))
            problems_.add(place(), "found no point of it on the terrain",
                          fmt::format("expected the barrier within x {:.10g} to {:.10g}, y {:.10g} to {:.10g}",
                                      extent[0], extent[2], extent[1], extent[3]),
                          "correct the coordinates or the CRS, or widen terrain.window");
        else if (scene_.solid && !meets(vertices, window_extent()))
            scene_.log.push_back(
                fmt::format("{}: stands outside of stage.window: points in space do not meet it", place()));
        barrier.wet_left = case_.word(prefix_ + "wet") == "left";
        if (given("thickness")) barrier.thickness = case_.number(prefix_ + "thickness");
        if (given("top")) barrier.top = case_.number(prefix_ + "top");
        if (given("height")) barrier.height = case_.number(prefix_ + "height");
        barrier.friction = case_.number(prefix_ + "friction");
        barrier.stuck = case_.flag(prefix_ + "stuck");
        if (!case_.flag(prefix_ + "each")) return scene_.barriers.push_back(std::move(barrier));
        for (std::size_t n = 0; n < barrier.outline.parts.size(); ++n) {
            scene_.barriers.push_back(barrier);
            scene_.barriers.back().name = fmt::format("{}_{}", barrier.name, n + 1);
            scene_.barriers.back().outline.parts = {barrier.outline.parts[n]};
        }
    }

private:
    bool given(const char* name) const { return case_.given(prefix_ + name); }
    std::string place() const {
        return case_.place(prefix_ + (given("mesh") ? "mesh" : given("line") ? "line" : "outline"));
    }

    /// Of the 3D stage: x, y of the low corner and of the high one [m].
    std::array<double, 4> window_extent() const {
        const GridGeometry& g = scene_.bed.geometry;
        const std::array<Index, 4>& w = scene_.solid->window;
        return {g.x(w[0]), g.y(w[1]), g.x(w[2]), g.y(w[3])};
    }

    bool read_plan(Barrier& barrier, std::vector<Vec2>& vertices) {
        if (given("line")) {
            vertices = barrier.line = case_.points(prefix_ + "line");
            return problems_.attempt(place(), [&] { require_wall(barrier.line); });
        }
        const bool read = problems_.attempt(place(), [&] {
            barrier.outline = reader_.read_polygons(case_.path(prefix_ + "outline"), scene_.bed.crs_wkt, scene_.log);
        });
        for (const Polygon& polygon : barrier.outline.parts)
            for (const auto& ring : polygon.rings) vertices.insert(vertices.end(), ring.begin(), ring.end());
        return read;
    }

    /// Two nodes a cell hold edges to a quarter of it; the field reaches as far as images do, in any direction.
    bool read_mesh(Barrier& barrier, std::vector<Vec2>& vertices) {
        const double cell = scene_.solid ? scene_.solid->cell : scene_.bed.geometry.cell;
        return problems_.attempt(place(), [&] {
            if (!meshes_) throw UserError("found a mesh; this build of the library reads none");
            const double reach = 3.0 * std::sqrt(3.0) + 0.5;
            MeshSampling sampling{0.5 * cell, reach * cell};
            if (given("origin"))
                for (int axis = 0; axis < 3; ++axis)
                    sampling.origin[axis] = case_.numbers(prefix_ + "origin")[static_cast<std::size_t>(axis)];
            const MeshField mesh = meshes_(case_.path(prefix_ + "mesh"), sampling);
            barrier.shape = mesh.field;
            vertices = {{mesh.low.x(), mesh.low.y()}, {mesh.high.x(), mesh.high.y()}};
            require_on_ground(mesh);
        });
    }

    /// Refuses what lies wholly under the ground below it, or above: an origin without its elevation.
    void require_on_ground(const MeshField& mesh) const {
        const GridGeometry& g = scene_.bed.geometry;
        double low = INFINITY, high = -INFINITY;
        for (Index j = 0; j < g.ny; ++j)
            for (Index i = 0; i < g.nx; ++i) {
                const double z = scene_.bed.at(i, j), x = g.x(i), y = g.y(j);
                const bool near = x >= mesh.low.x() - g.cell && x <= mesh.high.x() + g.cell &&
                                  y >= mesh.low.y() - g.cell && y <= mesh.high.y() + g.cell;
                if (near && std::isfinite(z)) low = std::min(low, z), high = std::max(high, z);
            }
        if (low > high || (mesh.high.z() > low && mesh.low.z() < high + g.cell)) return;
        throw UserError(
            fmt::format("found it from {:.6g} to {:.6g} m, the ground there from {:.6g} to {:.6g} m; expected a "
                        "barrier that stands on the ground; give the elevation of its origin",
                        mesh.low.z(), mesh.high.z(), low, high));
    }

    const CaseFile& case_;
    const GisReader& reader_;
    const MeshReader& meshes_;
    Scene& scene_;
    Problems& problems_;
    std::string prefix_;
};

}  // namespace

void read_barriers(const CaseFile& file, const GisReader& reader, const MeshReader& meshes, Scene& scene,
                   Problems& problems) {
    constexpr std::size_t kMost = 24;  // with the ground and the sides, within the surfaces that points can tell apart
    BarrierReader barriers(file, reader, meshes, scene, problems);
    std::map<std::string, Index> tables;
    for (Index i = 0; i < file.count("barrier"); ++i) {
        const std::size_t before = scene.barriers.size();
        barriers.read(i);
        const std::string place = file.table_place(fmt::format("barrier.{}", i));
        if (before <= kMost && scene.barriers.size() > kMost)
            problems.add(place, fmt::format("found {} barriers up to here", scene.barriers.size()),
                         fmt::format("expected {} at most", kMost),
                         "put several polygons into one barrier, without each");
        for (std::size_t n = before; n < scene.barriers.size(); ++n)
            if (const auto [first, is_new] = tables.emplace(scene.barriers[n].name, i); !is_new && first->second != i)
                problems.add(place,
                             fmt::format("found a barrier \"{}\", which barrier.{} has made as well",
                                         scene.barriers[n].name, first->second),
                             "expected names that differ", "give another name");
    }
}

}  // namespace frana
