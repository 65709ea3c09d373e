// The scene of structured particles that a case describes.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "base/error.h"
#include "coupling/structured_run.h"
#include "coupling/water_sources.h"
#include "mpm/stencil.h"
#include "scene/barrier_box.h"
#include "terrain/bed_points.h"
#include "terrain/places.h"

namespace frana {
namespace {

/// The bed as particles feel it. Beyond the outer nodes it goes on as it is there.
class Terrain {
public:
    Terrain(const Scene& scene)
        : bed_(scene.bed),
          holes_(scene.holes.nodes),
          gravity_(scene.gravity),
          unrolled_(scene.structure && scene.structure->unrolled) {}

    GroundGravity operator()(double x, double y) const {
        const NodeSquare around(bed_.geometry, x, y);
        Vec2 slope(0, 0);
        GroundGravity ground;
        for (Index k = 0; k < 4; ++k) {
            const double w = around.weight(k);
            if (w < 1e-9) continue;  // round-off of a place on a node
            const auto [i, j] = around.node(k);
            const double z = bed_.at(i, j);
            ground.exit = ground.exit || !std::isfinite(z);
            ground.hole = ground.hole || is_hole(i, j);
            ground.elevation += w * z, slope += w * slope_at(i, j);
        }
        if (ground.exit) ground.elevation = ground_near_hole(around.i, around.j), slope = Vec2(0, 0);
        // Along the ground the slope is a sine, on the map a tangent.
        const double drive = unrolled_ ? gravity_ : gravity_ / (1.0 + slope.squaredNorm());
        ground.across = unrolled_ ? gravity_ * std::sqrt(std::max(0.0, 1.0 - slope.squaredNorm())) : drive;
        ground.x = -drive * slope.x(), ground.y = -drive * slope.y();
        if (!unrolled_) ground.slope_x = slope.x(), ground.slope_y = slope.y();
        return ground;
    }

private:
    bool is_hole(Index i, Index j) const {
        return std::binary_search(holes_.begin(), holes_.end(), j * bed_.geometry.nx + i);
    }

    /// Mean elevation of the nearest ring of nodes with ground, where there is none, as far as particles reach [m].
    /// Nodes there carry a share of the particles at the hole, and that share has its height.
    double ground_near_hole(Index i, Index j) const {
        constexpr Index kReach = 4;
        for (Index reach = 1; reach <= kReach; ++reach) {
            double sum = 0.0, known = 0.0;
            for (Index b = std::max<Index>(0, j - reach); b <= std::min(bed_.geometry.ny - 1, j + reach); ++b)
                for (Index a = std::max<Index>(0, i - reach); a <= std::min(bed_.geometry.nx - 1, i + reach); ++a)
                    if (std::isfinite(bed_.at(a, b))) sum += bed_.at(a, b), known += 1.0;
            if (known > 0.0) return sum / known;
        }
        return 0.0;
    }

    /// Central differences; one-sided at the edge and next to what has no ground.
    Vec2 slope_at(Index i, Index j) const {
        const auto along = [&](Index di, Index dj) {
            const auto known = [&](Index a, Index b) {
                return a >= 0 && b >= 0 && a < bed_.geometry.nx && b < bed_.geometry.ny && std::isfinite(bed_.at(a, b));
            };
            const Index up = known(i + di, j + dj) ? 1 : 0, down = known(i - di, j - dj) ? 1 : 0;
            if (up + down == 0) return 0.0;
            return (bed_.at(i + up * di, j + up * dj) - bed_.at(i - down * di, j - down * dj)) /
                   (static_cast<double>(up + down) * bed_.geometry.cell);
        };
        return {along(1, 0), along(0, 1)};
    }

    Raster bed_;
    std::vector<Index> holes_;  ///< nodes inside the terrain that have no ground, growing
    double gravity_;
    bool unrolled_;
};

/// Walls along the outer nodes.
void add_walls(const GridGeometry& g, std::vector<Obstacle>& obstacles) {
    for (int side = 0; side < 4; ++side) {
        Obstacle wall;
        if (side == 0) wall.high.x() = g.x0;
        if (side == 1) wall.low.x() = g.x_max();
        if (side == 2) wall.high.y() = g.y0;
        if (side == 3) wall.low.y() = g.y_max();
        obstacles.push_back(wall);
    }
}

}  // namespace

std::optional<Obstacle> obstacle_of(const Barrier& barrier, const Raster& bed) {
    if (is_buried(barrier, bed)) return {};
    const BarrierBox box = box_around(barrier, bed.geometry.cell);
    return Obstacle{box.low, box.high, barrier.stuck ? Obstacle::kFar : barrier.friction};
}

namespace {

/// What make_bed_geometry needs, stored: grains may come long after the scene is gone.
std::function<BedGeometry(const TileGrid&)> bed_under(const Scene& scene) {
    Scene of;
    of.bed = scene.bed, of.scheme = scene.scheme, of.sides = scene.sides, of.curvature = scene.curvature;
    return [of = std::make_shared<const Scene>(std::move(of))](const TileGrid& grid) {
        return make_bed_geometry(*of, grid);
    };
}

/// At the nodes of a scene of particles.
std::function<BedCurvature(double x, double y)> curvature_of(const StructuredScene& scene) {
    const auto grid = std::make_shared<const TileGrid>(scene.grid);
    const auto bed = std::make_shared<const BedGeometry>(scene.bed(*grid));
    return [grid, bed](double x, double y) {
        const GridGeometry& g = grid->geometry();
        const Index k = grid->at(std::lround((x - g.x0) / g.cell), std::lround((y - g.y0) / g.cell));
        return BedCurvature{bed->hxx[k], bed->hxy[k], bed->hyy[k]};
    };
}

}  // namespace

namespace {

/// Of water alone: particles that are never there, and so pass no sound on.
Structure no_structure() {
    Structure none;
    none.share = 0.0, none.hydrostatic = true;
    return none;
}

}  // namespace

StructuredScene structured_scene(const Scene& scene) {
    expect(scene.structure || scene.water, "a structured run has a structure, or water alone");
    const Structure of = scene.structure ? *scene.structure : no_structure();
    StructuredScene s;
    s.grid = scene.bed.geometry;
    s.ground = Terrain(scene);
    s.density = scene.density;
    s.material = of.material;
    s.share = of.share;
    s.gravity = scene.gravity;
    s.bed_law = scene.bed_law;
    if (const auto* of_nodes = scene.bed_laws()) s.laws = {scene.friction, of_nodes};
    s.hydrostatic = of.hydrostatic;
    s.scheme = scene.scheme;
    if (!of.unrolled) s.bed = bed_under(scene), s.curved = scene.curvature != Curvature::none;
    s.cfl = of.cfl;
    if (are_closed(scene.sides)) add_walls(s.grid, s.obstacles);
    for (const Barrier& barrier : scene.barriers)
        if (const auto box = obstacle_of(barrier, scene.bed)) s.obstacles.push_back(*box);
    if (!scene.structure) return s;  // all that is released is water
    const Seeds& seeds = scene.particles;
    s.confined = of.confined;
    const double solid = 1.0 - (scene.water ? scene.water->share : 0.0);
    for (std::size_t p = 0; p < seeds.x.size(); ++p)
        s.points.add({seeds.x[p], seeds.y[p], seeds.vx[p], seeds.vy[p], solid * seeds.volume[p] * scene.density,
                      solid * seeds.depth[p], of.cohesion, of.share > 0.0 ? 0.0 : 1.0});
    return s;
}

namespace {

/// Depth and discharge of the water of the releases. It is in the pores of particles, spread as they are, or all of it.
class ReleasedWater {
public:
    ReleasedWater(const Scene& scene) : g_(scene.bed.geometry), depth_(size()), qx_(size()), qy_(size()) {
        if (scene.structure)
            spread(scene);
        else
            fill(scene);
    }
    WaterState at(std::size_t k) const {
        const double h = depth_[k];
        return h > 0.0 ? WaterState{h, qx_[k] / h, qy_[k] / h} : WaterState{};
    }

private:
    void spread(const Scene& scene) {
        const Seeds& seeds = scene.particles;
        for (std::size_t p = 0; p < seeds.x.size(); ++p) {
            const Quadratic sx((seeds.x[p] - g_.x0) / g_.cell), sy((seeds.y[p] - g_.y0) / g_.cell);
            const double h = scene.water->share * seeds.volume[p] / (g_.cell * g_.cell);
            for (int j = 0; j < 3; ++j)
                for (int i = 0; i < 3; ++i) {
                    const Index a = std::clamp<Index>(sx.base + i, 0, g_.nx - 1),
                                b = std::clamp<Index>(sy.base + j, 0, g_.ny - 1);
                    const std::size_t k = static_cast<std::size_t>(b * g_.nx + a);
                    const double w = sx.w[i] * sy.w[j] * h;
                    depth_[k] += w, qx_[k] += w * seeds.vx[p], qy_[k] += w * seeds.vy[p];
                }
        }
    }
    /// Each particle's volume over the square around it, shared by the cells there: edges stay sharp. A release up to one
    /// level within its shore is at that level in each cell, so that it rests.
    void fill(const Scene& scene) {
        const Seeds& seeds = scene.particles;
        for (std::size_t p = 0; p < seeds.x.size(); ++p) {
            const double half = 0.5 * seeds.size[p] / g_.cell, h = seeds.volume[p] / (g_.cell * g_.cell);
            for_each_cell((seeds.y[p] - g_.y0) / g_.cell, half, g_.ny, [&](Index j, double share_y) {
                for_each_cell((seeds.x[p] - g_.x0) / g_.cell, half, g_.nx, [&](Index i, double share_x) {
                    const std::size_t k = static_cast<std::size_t>(j * g_.nx + i);
                    const double w = share_x * share_y * h;
                    depth_[k] += w, qx_[k] += w * seeds.vx[p], qy_[k] += w * seeds.vy[p];
                });
            });
        }
        for (std::size_t k = 0; scene.still_surface && k < depth_.size(); ++k)
            if (depth_[k] > 0.0) depth_[k] = std::max(0.0, *scene.still_surface - scene.bed.values[k]);
    }
    /// Cells that [at - half, at + half] lies in, all in cells, with their shares of it.
    template <class Each>
    static void for_each_cell(double at, double half, Index count, Each&& each) {
        const double low = at - half, high = at + half;
        for (auto n = static_cast<Index>(std::floor(low + 0.5)); static_cast<double>(n) - 0.5 < high; ++n) {
            const double middle = static_cast<double>(n),
                         part = std::min(high, middle + 0.5) - std::max(low, middle - 0.5);
            if (part > 0.0) each(std::clamp<Index>(n, 0, count - 1), part / (high - low));
        }
    }
    std::size_t size() const { return static_cast<std::size_t>(g_.size()); }
    GridGeometry g_;
    std::vector<double> depth_, qx_, qy_;
};

/// Depth of the particles on the nodes of the terrain [m].
std::vector<double> depths_of(const StructuredScene& particles) {
    const StructuredFlow flow(particles);
    const StructuredBody& body = flow.body();
    const GridGeometry& g = particles.grid;
    // As with water: of the mass on the node (two_phase_flow.cpp, confine), not of the grains' sub-points.
    const double per_mass = 1.0 / (body.density * g.cell * g.cell);
    std::vector<double> depths(static_cast<std::size_t>(g.size()), 0.0);
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i)
            if (StructuredMap::is_in_reach(body, i, j)) {
                const Index k = body.grid.at(i, j);
                if (body.node_mass[k] > 0.0)
                    depths[static_cast<std::size_t>(j * g.nx + i)] = per_mass * body.node_mass[k] / body.ground[k].open;
            }
    return depths;
}

}  // namespace

namespace {

/// Where water comes in and goes out.
void set_edges(const Scene& scene, WaterScene& w) {
    using Is = WaterPhase::Side::Is;
    const WaterPhase& of = *scene.water;
    w.sides.fill(are_closed(scene.sides) ? WaterSide::wall : WaterSide::open);
    if (of.lake.empty()) w.level = of.level;
    for (std::size_t side = 0; side < w.sides.size(); ++side) {
        const WaterPhase::Side& given = of.sides[side];
        if (given.is == Is::wall) w.sides[side] = WaterSide::wall;
        if (given.is == Is::level) w.sides[side] = WaterSide::level, w.side_levels[side] = given.level;
        if (given.is == Is::free) w.sides[side] = WaterSide::free;
    }
    w.sources = water_sources(scene);
}

/// With the momentum of what came; `still`: depth that rests there, below 0 on dry ground [m].
WaterState on_top_of(double still, const WaterState& came) {
    if (!(still > 0.0)) return came;
    const double depth = still + came.depth, share = came.depth / depth;
    return {depth, share * came.u, share * came.v};
}

}  // namespace

TwoPhaseScene two_phase_scene(const Scene& scene) {
    const WaterPhase& of = *scene.water;
    TwoPhaseScene s;
    s.structured = structured_scene(scene);
    s.alone = !scene.structure;
    s.exchange = of.exchange;
    WaterScene& w = s.water;
    const GridGeometry g = w.grid = scene.bed.geometry;
    double highest = -std::numeric_limits<double>::infinity();
    for (const double z : scene.bed.values)
        if (std::isfinite(z)) highest = std::max(highest, z);
    const auto node = [g](double x, double y) {
        return static_cast<std::size_t>(std::lround((y - g.y0) / g.cell) * g.nx + std::lround((x - g.x0) / g.cell));
    };
    w.bed = [&scene, node, highest](double x, double y) {  // only called while the flow is made
        const double z = scene.bed.values[node(x, y)];
        return std::isfinite(z) ? z : highest;
    };
    const auto bound =
        std::make_shared<std::vector<double>>(of.level ? depths_of(s.structured) : std::vector<double>{});
    const auto released = std::make_shared<ReleasedWater>(scene);
    // A depth that is released stands on the lake. Pores, and a release up to a level, fill within it.
    const bool adds = s.alone && !scene.still_surface;
    w.start = [bound, released, node, adds, bed = w.bed, level = of.level, lake = of.lake](double x, double y) {
        const std::size_t k = node(x, y);
        WaterState state = released->at(k);
        if (adds && level && (lake.empty() || lake[k])) return on_top_of(*level - bed(x, y), state);
        if (level && (lake.empty() || lake[k]) && *level > bed(x, y) + (*bound)[k] + state.depth)
            state = {*level - bed(x, y) - (*bound)[k], 0.0, 0.0};
        return state;
    };
    // Only called while the flow is made, so that the scene's rasters need not be copied.
    const auto on_nodes = [node](const Raster& rate) -> WaterScene::Function {
        if (rate.values.empty()) return {};
        return [&rate, node](double x, double y) { return rate.values[node(x, y)]; };
    };
    w.rain = on_nodes(of.rain), w.infiltration = on_nodes(of.infiltration);
    set_edges(scene, w);
    if (s.structured.curved) w.curvature = curvature_of(s.structured);
    w.friction = of.friction, w.viscosity = of.viscosity;
    if (const WaterLawMap* of_nodes = scene.water_laws())
        w.friction_at = [of_nodes, node](double x, double y) {
            return water_friction(of_nodes->at(node(x, y))).coefficient;
        };
    if (s.alone && !std::holds_alternative<bed::None>(scene.bed_law)) {
        w.bed_law = scene.bed_law;
        if (const auto* of_nodes = scene.bed_laws()) w.bed_laws = {scene.friction, of_nodes};
    }
    w.density = scene.density;
    w.gravity = scene.gravity;
    return s;
}

}  // namespace frana
