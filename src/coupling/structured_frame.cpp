// What a run of structured particles shows: fields of the particles, and of the nodes.
#include <algorithm>
#include <cmath>
#include <limits>

#include "coupling/structured_run.h"
#include "mpm/flow_fields.h"
#include "mpm/stencil.h"
#include "terrain/bed_points.h"

namespace frana {
namespace {

/// What a particle's nodes say of something, by its shape functions.
template <class At>
double from_nodes(const StructuredBody& body, Index p, At&& at) {
    const Quadratic sx(body.points.x[p]), sy(body.points.y[p]);
    double value = 0.0;
    for (int j = 0; j < 3; ++j)
        for (int i = 0; i < 3; ++i) value += sx.w[i] * sy.w[j] * at(body.grid.at(sx.base + i, sy.base + j));
    return value;
}

/// The nodes of the terrain on these tiles: each(storage index, index in a frame's fields).
template <class Each>
void for_each_node(const TileGrid& grid, const std::vector<Index>& tiles, Each&& each) {
    const Index count = static_cast<Index>(tiles.size());
#pragma omp parallel for schedule(static) if (count >= kTilesForThreads)
    for (Index t = 0; t < count; ++t) {
        const Index i0 = grid.tile_i(tiles[static_cast<std::size_t>(t)]),
                    j0 = grid.tile_j(tiles[static_cast<std::size_t>(t)]);
        for (Index j = std::max<Index>(j0, 0); j < std::min(j0 + kTile, grid.ny()); ++j)
            for (Index i = std::max<Index>(i0, 0); i < std::min(i0 + kTile, grid.nx()); ++i)
                each(grid.at(i, j), j * grid.nx() + i);
    }
}

}  // namespace

Frame StructuredRun::frame() {
    Frame frame;
    store_.begin();
    timed_("frame", [&] {
        if (alone_) alone_->sample();
        accumulate();
        frame.grid = flow().body().grid.geometry();
        frame.status = status_;
        if (solids_)
            particle_fields(frame);
        else
            ParticleFields(store_, frame.particles, 0);
        node_fields(frame);
        if (solids_) inner_fields(frame);
        if (both_) water_fields(frame);
        if (both_ && solids_) own_water_fields(frame);
    });
    return frame;
}

void StructuredRun::particle_fields(Frame& frame) {
    const StructuredBody& body = flow().body();
    const StructuredPoints& q = body.points;
    const Index count = q.count();
    const auto array = [&](const char* name, const char* unit, int components) {
        return store_.zeros(frame.particles, name, unit, components, count);
    };
    ParticleFields fields(store_, frame.particles, count);
    double *stress = array("stress", "Pa", 3), *effective = array("effective_stress", "Pa", 3),
           *damage = array("damage", "1", 1), *cohesion = array("cohesion", "Pa", 1);
#pragma omp parallel for schedule(static)
    for (Index p = 0; p < count; ++p) {
        const Vec2 x = flow().position(p);
        const double z = bed_below(bed_, x.x(), x.y()), h = q.layer[p];
        const double bx = from_nodes(body, p, [&](Index k) { return body.ground[k].slope_x; }),
                     by = from_nodes(body, p, [&](Index k) { return body.ground[k].slope_y; });
        const double up = from_nodes(body, p, [&](Index k) { return map_.climb(k, q.vx[p], q.vy[p]); });
        const double steep = std::sqrt(1.0 + bx * bx + by * by);
        const double holds = body.share * (1.0 - q.damage[p]);
        const double density = body.water ? q.mass[p] / q.volume[p] : body.density;
        const double vx = q.vx[p], vy = q.vy[p], speed = std::sqrt(vx * vx + vy * vy + up * up);
        const double pressure =
            density * h * from_nodes(body, p, [&](Index k) { return StructuredMap::pressing(body, k); });
        fields.set(p, {x.x(), x.y(), z + h, z, h, steep, vx, vy, up, speed, pressure, q.mass[p], q.volume[p], q.id[p]});
        stress[3 * p] = holds * q.xx[p], stress[3 * p + 1] = holds * q.yy[p], stress[3 * p + 2] = holds * q.xy[p];
        const Sym2 k =
            earth_pressure({q.cxx[p], q.cyy[p], 0.5 * (q.cxy[p] + q.cyx[p])}, h, q.normal_gravity[p], body.rankine);
        const double thrust = 0.5 * (1.0 - holds) * density * q.normal_gravity[p] * h;
        effective[3 * p] = stress[3 * p] - thrust * k.xx, effective[3 * p + 1] = stress[3 * p + 1] - thrust * k.yy,
                      effective[3 * p + 2] = stress[3 * p + 2] - thrust * k.xy;
        damage[p] = q.damage[p];
        cohesion[p] = (1.0 - q.damage[p]) * q.cohesion[p];
    }
}

void StructuredRun::node_fields(Frame& frame) {
    const StructuredBody& body = flow().body();
    const GridGeometry& g = bed_.geometry;
    const double footprint = map_.footprint_depth();
    NodeFields fields(store_, frame.nodes, g.size());
#pragma omp parallel for schedule(static)
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i) {
            const NodePeak& peak = map_.peak(body.grid.at(i, j));
            fields.stand(j * g.nx + i, bed_.at(i, j), peak, peak.arrival_time(footprint));
        }
    for_each_node(body.grid, body.active.work, [&](Index k, Index n) {
        const StructuredBody::Moved& node = body.moved[k];
        const StructuredBody::NodeGround& ground = body.ground[k];
        const double h = StructuredMap::depth_of(body, k), up = map_.climb(k, node.vx, node.vy);
        if (!(h > 0.0)) return;
        const double density = StructuredMap::density_of(body, k),
                     pressure = density * StructuredMap::pressing(body, k) * h,
                     speed = std::sqrt(node.vx * node.vx + node.vy * node.vy + up * up);
        if (!both_ && !aside_) {
            // Peaks were noted before the last drift, and the next step notes what stands there now. So no frame is above
            // its peaks. With water they were noted after it.
            NodePeak peak = map_.peak(k);
            peak.note({h, speed, pressure, density}, status_.time, footprint);
            fields.stand(n, fields.elevation[n], peak, peak.arrival_time(footprint));
        }
        fields.flow(n, {h, std::sqrt(1.0 + ground.slope_x * ground.slope_x + ground.slope_y * ground.slope_y), node.vx,
                        node.vy, up, speed, pressure});
    });
}

/// Stresses, damage and cohesion on the nodes: means over the mass of what the particles show.
void StructuredRun::inner_fields(Frame& frame) {
    const StructuredBody& body = flow().body();
    const StructuredPoints& q = body.points;
    const double *stress = frame.particle("stress")->data, *effective = frame.particle("effective_stress")->data,
                 *damage = frame.particle("damage")->data, *cohesion = frame.particle("cohesion")->data;
    if (!inner_) inner_ = LazyArray<Inner>(body.grid.size());
    for_each_work_tile(body.active, [&](Index, Index tile) {
        const Index first = body.grid.at(body.grid.tile_i(tile), body.grid.tile_j(tile));
        for (Index j = 0; j < kTile; ++j) std::fill_n(&inner_[first + j * body.grid.stride()], kTile, Inner{});
    });
    for_each_tile_in_turn(body.active, [&](Index n) {
        for (Index p = body.active.begin[n]; p < body.active.begin[n + 1]; ++p) {
            const Quadratic sx(q.x[p]), sy(q.y[p]);
            for (int j = 0; j < 3; ++j)
                for (int i = 0; i < 3; ++i) {
                    Inner& node = inner_[body.grid.at(sx.base + i, sy.base + j)];
                    const double m = sx.w[i] * sy.w[j] * q.mass[p];
                    for (int c = 0; c < 3; ++c)
                        node.stress[c] += m * stress[3 * p + c], node.effective[c] += m * effective[3 * p + c];
                    node.damage += m * damage[p], node.cohesion += m * cohesion[p];
                    node.mass += m;
                }
        }
    });
    const GridGeometry& g = bed_.geometry;
    const auto array = [&](const char* name, const char* unit, int components) {
        return store_.zeros(frame.nodes, name, unit, components, g.size());
    };
    double *stress_to = array("stress", "Pa", 3), *effective_to = array("effective_stress", "Pa", 3),
           *damage_to = array("damage", "1", 1), *cohesion_to = array("cohesion", "Pa", 1);
    for_each_node(body.grid, body.active.work, [&](Index k, Index n) {
        const Inner& node = inner_[k];
        if (!(node.mass > 0.0)) return;
        for (int c = 0; c < 3; ++c)
            stress_to[3 * n + c] = node.stress[c] / node.mass, effective_to[3 * n + c] = node.effective[c] / node.mass;
        damage_to[n] = node.damage / node.mass, cohesion_to[n] = node.cohesion / node.mass;
    });
}

namespace {

/// Slope of the bed under a cell of the water, central differences [1].
Vec2 slope_under(const WaterBody& water, Index k) {
    const Index stride = water.grid.stride();
    return 0.5 / water.grid.cell() *
           Vec2(water.bed[k + 1] - water.bed[k - 1], water.bed[k + stride] - water.bed[k - stride]);
}

/// Velocity on the map; films stand still [m/s].
Vec2 velocity_of(const WaterBody& water, Index k) {
    const double h = water.now.h[k];
    return h > water.film ? Vec2(water.now.qx[k] / h, water.now.qy[k] / h) : Vec2(0, 0);
}

}  // namespace

/// Depth, surface and pressure of nodes are those of both, velocity that of both masses together.
void StructuredRun::water_fields(Frame& frame) {
    const WaterBody& water = both_->water().body();
    const auto find = [&](const char* name) {
        return const_cast<double*>(frame.node(name)->data);  // made just now, by node_fields()
    };
    double *depth = find("depth"), *thickness = find("thickness"), *surface = find("surface"),
           *velocity = find("velocity"), *speed = find("speed"), *pressure = find("pressure");
    const double* elevation = find("elevation");
    for_each_node(water.grid, water.work, [&](Index k, Index n) {
        const double h = water.now.h[k];
        if (!(h > 0.0) || !std::isfinite(elevation[n])) return;
        const Vec2 slope = slope_under(water, k), v = velocity_of(water, k);
        const double own[3] = {v.x(), v.y(), map_.climb(k, v.x(), v.y())}, all = depth[n] + h,
                     particles = StructuredMap::density_of(flow().body(), k) * depth[n],
                     both = particles + water_density_ * h;
        for (int c = 0; c < 3; ++c)
            velocity[3 * n + c] = (particles * velocity[3 * n + c] + water_density_ * h * own[c]) / both;
        speed[n] = Vec3(velocity[3 * n], velocity[3 * n + 1], velocity[3 * n + 2]).norm();
        depth[n] = all, surface[n] += h;
        thickness[n] = all / std::sqrt(1.0 + slope.x() * slope.x() + slope.y() * slope.y());
        pressure[n] += water_density_ * water.pressing(k, v) * h;
    });
}

/// The water's own, where particles are with it.
void StructuredRun::own_water_fields(Frame& frame) {
    const WaterBody& water = both_->water().body();
    const Index size = bed_.geometry.size();
    const double* elevation = frame.node("elevation")->data;
    double *depth = store_.zeros(frame.nodes, "water_depth", "m", 1, size),
           *velocity = store_.zeros(frame.nodes, "water_velocity", "m/s", 3, size),
           *speed = store_.zeros(frame.nodes, "water_speed", "m/s", 1, size);
    for_each_node(water.grid, water.work, [&](Index k, Index n) {
        const double h = water.now.h[k];
        if (!(h > 0.0) || !std::isfinite(elevation[n])) return;
        const Vec2 v = velocity_of(water, k);
        const Vec3 own(v.x(), v.y(), map_.climb(k, v.x(), v.y()));
        for (int c = 0; c < 3; ++c) velocity[3 * n + c] = own[c];
        depth[n] = h, speed[n] = own.norm();
    });
}

}  // namespace frana
