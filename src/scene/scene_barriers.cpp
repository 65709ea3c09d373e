// [[barrier]] of the case file.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "base/error.h"
#include "base/round_number.h"
#include "scene/barrier_box.h"
#include "scene/barriers_of_case.h"
#include "scene/gap_below.h"
#include "scene/joined_barriers.h"
#include "scene/scene_parts.h"
#include "terrain/bed_points.h"
#include "terrain/outline_nodes.h"
#include "terrain/part_of.h"

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

constexpr double kTallest = 500.0;  ///< [m]: what is higher was given in other units, or is an elevation

/// The least distance of two parallels along one of its sides that hold a ring between them [m].
double width_of(const std::vector<Vec2>& ring) {
    double width = INFINITY;
    for (std::size_t k = 0; k < ring.size(); ++k) {
        const Vec2 side = ring[(k + 1) % ring.size()] - ring[k];
        const double length = side.norm();
        if (!(length > 0.0)) continue;
        const Vec2 across = Vec2(-side.y(), side.x()) / length;
        double low = INFINITY, high = -INFINITY;
        for (const Vec2& p : ring) low = std::min(low, across.dot(p)), high = std::max(high, across.dot(p));
        width = std::min(width, high - low);
    }
    return width;
}

class BarrierReader {
public:
    BarrierReader(const CaseFile& file, const GisReader& reader, const MeshReader& meshes, Scene& scene,
                  Problems& problems)
        : case_(file), reader_(reader), meshes_(meshes), scene_(scene), problems_(problems) {}

    void read(Index i) {
        prefix_ = fmt::format("barrier.{}.", i);
        heights_.clear();
        Barrier barrier;
        barrier.name = given("name") ? case_.word(prefix_ + "name") : fmt::format("barrier_{}", i + 1);
        std::vector<Vec2> vertices;
        if (given("mesh") ? !read_mesh(barrier, vertices) : !read_plan(barrier, vertices)) return;
        const auto extent = terrain_extent();
        const bool is_met = scene_.solid && meets(vertices, window_extent());
        if (!meets(vertices, extent))
            problems_.add(place(), "found no point of it on the terrain",
                          fmt::format("expected the barrier within x {:.10g} to {:.10g}, y {:.10g} to {:.10g}",
                                      extent[0], extent[2], extent[1], extent[3]),
                          "correct the coordinates or the CRS, or widen terrain.window");
        else if (scene_.solid && !is_met)
            scene_.log.push_back(fmt::format("{}: stands outside of stage.window: 3D points do not meet it", place()));
        barrier.wet_left = case_.word(prefix_ + "wet") == "left";
        if (given("thickness")) barrier.thickness = case_.number(prefix_ + "thickness");
        if (given("top")) barrier.top = case_.number(prefix_ + "top");
        if (given("height")) barrier.height = case_.number(prefix_ + "height");
        if (barrier.height > kTallest && given("outline"))
            problems_.add(case_.place(prefix_ + "height"), fmt::format("found {:.6g} m", barrier.height),
                          fmt::format("expected up to {:.6g} m above the ground", kTallest),
                          "correct it; an elevation is given by top");
        barrier.friction = case_.number(prefix_ + "friction");
        barrier.stuck = case_.flag(prefix_ + "stuck");
        if (is_met) remark_beyond(barrier, vertices);
        if (is_met && !case_.flag(prefix_ + "each")) remark_window(barrier, vertices);
        barrier.windows = windows();
        if (case_.word("material.structure.law") == "none") {  // structured particles meet boxes
            remark_thin(barrier.outline);
            remark_thin_wall(barrier);
        }
        const bool each = case_.flag(prefix_ + "each");
        if (!each || !scene_.solid) judge_buried(barrier);
        if (each) return add_each(barrier);
        if (is_met) remark_low(barrier);
        if (is_met && barrier.shape) remark_gap(barrier);
        scene_.barriers.push_back(std::move(barrier));
    }

private:
    /// Of all of the terrain, of which the scene may hold a part [m].
    std::array<double, 4> terrain_extent() const {
        return (scene_.wider ? scene_.wider->grid : scene_.bed.geometry).pixel_extent();
    }
    /// A top that no ground of its outline is below. Erodible ground may free it later. 3D points would meet its faces
    /// through the ground, and it is refused as a mesh is.
    void judge_buried(const Barrier& barrier) {
        if (scene_.erodible || !is_buried(barrier, scene_.bed)) return;
        const std::string at = case_.place(prefix_ + "top"), found = fmt::format("found {:.6g} m", *barrier.top),
                          expected = fmt::format("expected more than the ground's {:.6g} m: nothing meets {}",
                                                 lowest_ground(barrier, scene_.bed),
                                                 case_.flag(prefix_ + "each") && scene_.solid ? barrier.name : "it");
        if (scene_.solid)
            problems_.add(at, found, expected, "correct it, which is an elevation, or remove the barrier");
        else
            scene_.log.push_back(fmt::format("{}: {}; {}", at, found, expected));
    }

    /// How high it stands above the lowest ground below it; not a number where it has none [m].
    double height_of(const Barrier& barrier) const {
        if (barrier.shape) return mesh_height_;
        return barrier.top ? *barrier.top - lowest_ground(barrier, scene_.bed) : barrier.height;
    }

    /// Below water at rest the forces on walls of a cell or more err by 5 %, on one of half a cell by 10 %, on one of a
    /// tenth by 40 %.
    void remark_low(const Barrier& barrier) {
        constexpr double kCells = 1.0;
        const double cell = scene_.solid->cell, height = height_of(barrier);
        if (!(height > 0.0) || height >= kCells * cell || !std::isfinite(height)) return;
        const char* const off = height >= 0.5 * cell   ? "a tenth"
                                : height >= 0.1 * cell ? "a tenth to two fifths"
                                                       : "half or more";
        scene_.log.push_back(fmt::format(
            "{}: {} stands {:.3g} m high, {:.2g} cells of the 3D stage; expected {:g} or more, or the "
            "forces on its sides and on its top err by {}, and moments by more; stage.cell = {:g} "
            "would do",
            place(), barrier.name, height, height / cell, kCells, off, round_number_below(height / kCells)));
    }

    /// Material between two surfaces less than a few cells apart is pressed by both. In a room of a cell below a deck, half
    /// a metre of flow pressed the deck with 180 times its weight.
    void remark_gap(const Barrier& barrier) {
        constexpr double kFlush = 0.02, kRoom = 3.0;  // [cells]
        const double cell = scene_.solid->cell;
        const Gap gap = gap_below(*barrier.shape, scene_.bed, kFlush * cell, kRoom * cell);
        if (!(gap.share > 0.0)) return;
        scene_.log.push_back(
            fmt::format("{}: found the foot of {} up to {:.3g} m above the ground over {:.0f} % of it; expected it in "
                        "the ground, or {:g} cells of the 3D stage, {:.3g} m, above; what gets into that room is "
                        "pressed by both, and forces mean nothing; let it reach a cell into the ground",
                        place(), barrier.name, gap.height, 100.0 * gap.share, kRoom, kRoom * cell));
    }

    static BarrierBox box_of(const std::vector<Vec2>& vertices) {
        BarrierBox box{vertices.front(), vertices.front()};
        for (const Vec2& p : vertices) box.low = box.low.cwiseMin(p), box.high = box.high.cwiseMax(p);
        return box;
    }

    /// Of what lies on the terrain.
    void remark_window(const Barrier& barrier, const std::vector<Vec2>& vertices) {
        const BarrierBox box = box_of(vertices);
        const double inside =
            share_of_foot(barrier, box, window_extent()) / share_of_foot(barrier, box, terrain_extent());
        if (inside > 0.0 && inside < 0.99)
            scene_.log.push_back(
                fmt::format("{}: {:.0f} % of {} stand in stage.window; forces are those on that part; expected all of "
                            "it, if the force on the whole is asked for",
                            place(), 100.0 * inside, barrier.name));
    }

    /// What is beyond the terrain takes no load. Where its sides are walls a barrier across it is drawn into them.
    void remark_beyond(const Barrier& barrier, const std::vector<Vec2>& vertices) {
        const BarrierBox box = box_of(vertices);
        const double beyond = 1.0 - share_of_foot(barrier, box, terrain_extent());
        if (beyond > (case_.word("boundary.sides") != "open" ? 0.5 : 0.01))
            scene_.log.push_back(
                fmt::format("{}: {:.0f} % of the foot of {} lie beyond the terrain, where nothing meets it; forces and "
                            "moments are those on the rest; expected terrain under all of it, if they are asked for on "
                            "the whole",
                            place(), 100.0 * beyond, barrier.name));
    }

    bool given(const char* name) const { return case_.given(prefix_ + name); }
    std::string place() const {
        return case_.place(prefix_ + (given("mesh") ? "mesh" : given("line") ? "line" : "outline"));
    }

    /// Times over which forces are averaged [s].
    std::vector<double> windows() {
        constexpr double kShortest = 1e-6, kLongest = 10.0;
        constexpr std::size_t kMost = 8;
        std::vector<double> windows = case_.numbers(prefix_ + "windows");
        const bool ascend = std::adjacent_find(windows.begin(), windows.end(), std::greater_equal<>()) == windows.end();
        const bool fit = !windows.empty() && windows.size() <= kMost && windows.front() >= kShortest &&
                         windows.back() <= kLongest && ascend;
        if (!fit)
            problems_.add(case_.place(prefix_ + "windows"),
                          windows.empty() ? "found no number" : fmt::format("found [{:.6g}]", fmt::join(windows, ", ")),
                          fmt::format("expected one to {} times from {:g} to {:g} s, each longer than the one before",
                                      kMost, kShortest, kLongest),
                          "give the times over which a designer needs the force, such as [0.01, 0.05, 1.0]");
        return windows;
    }

    /// Every polygon on the terrain by itself. Files of a whole valley have many beyond it: their numbers are left out.
    void add_each(const Barrier& barrier) {
        const auto extent = terrain_extent();
        std::size_t beyond = 0;
        for (std::size_t n = 0; n < barrier.outline.parts.size(); ++n) {
            std::vector<Vec2> corners;
            for (const auto& ring : barrier.outline.parts[n].rings)
                corners.insert(corners.end(), ring.begin(), ring.end());
            if (!meets(corners, extent)) {
                ++beyond;
                continue;
            }
            Barrier one;
            one.name = fmt::format("{}_{}", barrier.name, n + 1);
            one.outline.parts = {barrier.outline.parts[n]};
            one.outline.source = barrier.outline.source;
            one.top = barrier.top, one.height = heights_.empty() ? barrier.height : heights_[n];
            one.stuck = barrier.stuck, one.friction = barrier.friction, one.windows = barrier.windows;
            if (scene_.solid) judge_buried(one);
            if (scene_.solid && meets(corners, window_extent())) {
                remark_low(one);
                remark_window(one, corners);
            }
            scene_.barriers.push_back(std::move(one));
        }
        if (beyond > 0)
            scene_.log.push_back(fmt::format("{}: {} of {} polygons are not on the terrain: they are no barriers",
                                             place(), beyond, barrier.outline.parts.size()));
    }

    /// Particles see no face thinner than two cells: nodes within half a cell of a polygon stand on it.
    void remark_thin(const Polygons& outline) const {
        const double cell = scene_.bed.geometry.cell;
        double thinnest = INFINITY;
        const auto thin = std::count_if(outline.parts.begin(), outline.parts.end(), [&](const Polygon& polygon) {
            const double width = polygon.rings.empty() ? INFINITY : width_of(polygon.rings.front());
            thinnest = std::min(thinnest, width);
            return width < 2.0 * cell;
        });
        if (thin > 0 && !scene_.solid)
            scene_.log.push_back(fmt::format(
                "{}: {} of {} polygons are thinner than two cells of {:.6g} m: each stands on the cells that "
                "it cuts, the thinnest about {:.3g} m wide; areas in results are those of the file",
                place(), thin, outline.parts.size(), cell, std::max(thinnest, cell) + cell));
    }

    void remark_thin_wall(const Barrier& barrier) const {
        const double cell = scene_.bed.geometry.cell;
        if (scene_.solid || barrier.line.empty() || !barrier.thickness || *barrier.thickness >= 2.0 * cell) return;
        scene_.log.push_back(fmt::format(
            "{}: found {:.4g} m, less than two cells of {:.6g} m: the wall stands on the cells that it cuts, about "
            "{:.3g} m wide",
            case_.place(prefix_ + "thickness"), *barrier.thickness, cell, std::max(*barrier.thickness, cell) + cell));
    }

    /// One for each polygon [m].
    void read_heights(const std::filesystem::path& file, Barrier& barrier) {
        const std::string& field = case_.word(prefix_ + "height_field");
        ValuedPolygons valued = reader_.read_valued_polygons(file, field, scene_.bed.crs_wkt, scene_.log);
        const std::array<double, 4> extent = scene_.bed.geometry.pixel_extent();
        for (std::size_t n = 0; n < valued.values.size(); ++n)
            if (meets(valued.polygons.parts[n].rings.front(), extent) &&
                !(valued.values[n] > 0.0 && valued.values[n] <= kTallest))
                throw UserError(fmt::format(
                    "found {} = {:.6g} m at polygon {} of {}; expected a height above 0 and up to {:.6g} m; correct it "
                    "there, or remove the polygon",
                    field, valued.values[n], n + 1, file.filename().string(), kTallest));
        barrier.outline = std::move(valued.polygons);
        heights_ = std::move(valued.values);
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
        const std::filesystem::path file = case_.path(prefix_ + "outline");
        const bool read = problems_.attempt(place(), [&] {
            if (given("height_field")) return read_heights(file, barrier);
            barrier.outline = reader_.read_polygons(file, scene_.bed.crs_wkt, scene_.log);
        });
        for (const Polygon& polygon : barrier.outline.parts)
            for (const auto& ring : polygon.rings) vertices.insert(vertices.end(), ring.begin(), ring.end());
        return read;
    }

    /// Two nodes a cell resolve edges to a quarter of it. The field reaches as far as mirror particles do, in any
    /// direction.
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
    void require_on_ground(const MeshField& mesh) {
        const GridGeometry& g = scene_.bed.geometry;
        double low = INFINITY, high = -INFINITY;
        for (Index j = 0; j < g.ny; ++j)
            for (Index i = 0; i < g.nx; ++i) {
                const double z = scene_.bed.at(i, j), x = g.x(i), y = g.y(j);
                const bool near = x >= mesh.low.x() - g.cell && x <= mesh.high.x() + g.cell &&
                                  y >= mesh.low.y() - g.cell && y <= mesh.high.y() + g.cell;
                if (near && std::isfinite(z)) low = std::min(low, z), high = std::max(high, z);
            }
        mesh_height_ = mesh.high.z() - low;
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
    std::vector<double> heights_;  ///< of the outline's polygons, where the file gives them [m]
    double mesh_height_ = 0.0;     ///< of a mesh, above the lowest ground below it [m]
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
        if (scene.solid && before <= kMost && scene.barriers.size() > kMost)
            problems.add(place, fmt::format("found {} barriers up to here", scene.barriers.size()),
                         fmt::format("expected {} at most in a run with 3D points, which tell no more apart", kMost),
                         "put several polygons into one barrier, without each, or remove the stage");
        for (std::size_t n = before; n < scene.barriers.size(); ++n)
            if (const auto [first, is_new] = tables.emplace(scene.barriers[n].name, i); !is_new && first->second != i)
                problems.add(place,
                             fmt::format("found a barrier \"{}\", which barrier.{} has made as well",
                                         scene.barriers[n].name, first->second),
                             "expected names that differ", "give another name");
    }
    if (!scene.solid || !problems.empty()) return;
    for (std::string& remark : remarks_on_joined(scene.barriers, scene.solid->cell))
        scene.log.push_back(std::move(remark));
}

std::vector<Barrier> barriers_of_case(const CaseFile& file, const GisReader& reader, const Raster& bed,
                                      std::vector<std::string>& log) {
    Scene scene;
    scene.bed = bed;
    Problems problems;
    const MeshReader anywhere = [&](const std::filesystem::path&, const MeshSampling&) {
        const auto extent = bed.geometry.pixel_extent();
        MeshField mesh;
        mesh.low = {extent[0], extent[1], -INFINITY}, mesh.high = {extent[2], extent[3], INFINITY};
        return mesh;
    };
    read_barriers(file, reader, anywhere, scene, problems);
    problems.throw_if_any();
    log.insert(log.end(), scene.log.begin(), scene.log.end());
    return scene.barriers;
}

}  // namespace frana
