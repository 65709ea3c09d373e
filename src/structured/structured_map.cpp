#include "structured/structured_map.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "structured/node_water.h"
#include "terrain/places.h"

namespace frana {

StructuredMap::StructuredMap(const TileGrid& grid, const Vec2& centre, double footprint_depth, LazyArray<Pair> path)
    : path_(std::move(path)),
      peaks_(grid.size()),
      nx_(grid.nx()),
      ny_(grid.ny()),
      stride_(grid.stride()),
      centre_(centre),
      footprint_depth_(footprint_depth) {}

namespace {

/// What stands on a node.
struct Standing {
    double depth = 0.0, pressure = 0.0, inertia = 0.0;  ///< [m], [Pa], density * depth [kg/m^2]
    Vec2 velocity{0, 0};
};

/// What particles bring, a mean over their mass. What stress does to a node in a step is left out: one with next to no
/// mass gets any speed by it, and no particle does. The depth-averaged flow's peaks are of the same velocity.
Vec2 brought_by_particles(const StructuredBody& body, Index k) {
    const double mass = body.node_mass[k];
    return mass > 0.0 ? Vec2(Vec2(body.nodes[k].px, body.nodes[k].py) / mass) : Vec2(0, 0);
}

Standing particles_on(const StructuredBody& body, Index k) {
    const double depth = StructuredMap::depth_of(body, k);
    if (!(depth > 0.0)) return {};
    const double density = StructuredMap::density_of(body, k);
    return {depth, density * StructuredMap::pressing(body, k) * depth, density * depth, brought_by_particles(body, k)};
}

/// With the water: velocities are those of both masses together.
Standing with_water(const Standing& particles, const WaterBody& water, double density, Index k) {
    const double h = water.now.h[k];
    if (!(h > 0.0)) return particles;
    const double inertia = density * h;
    const Vec2 v = h > water.film ? Vec2(Vec2(water.now.qx[k], water.now.qy[k]) / h) : Vec2(0, 0);
    return {particles.depth + h, particles.pressure + density * water.pressing(k, v) * h, particles.inertia + inertia,
            (particles.inertia * particles.velocity + inertia * v) / (particles.inertia + inertia)};
}

Standing on_node(const StructuredBody& body, const WaterFlow* water, Index i, Index j) {
    const Index k = body.grid.at(i, j);
    const Standing particles = StructuredMap::is_in_reach(body, i, j) ? particles_on(body, k) : Standing{};
    return water ? with_water(particles, water->body(), body.water->by.material.fluid_density, k) : particles;
}

}  // namespace

void StructuredMap::note(const StructuredBody& body, const WaterFlow* water, double time, Peaks peaks) {
    const GridGeometry& g = body.grid.geometry();
    tiles_ = body.active.work;
    if (water) {
        tiles_.clear();
        std::set_union(body.active.work.begin(), body.active.work.end(), water->body().work.begin(),
                       water->body().work.end(), std::back_inserter(tiles_));
    }
    of_tile_.resize(tiles_.size());
    const Index count = static_cast<Index>(tiles_.size());
#pragma omp parallel for schedule(dynamic, 1) if (count >= kTilesForThreads)
    for (Index n = 0; n < count; ++n) {
        FlowExtent extent;
        const Index tile = tiles_[static_cast<std::size_t>(n)];
        const Index i0 = body.grid.tile_i(tile), j0 = body.grid.tile_j(tile);
        for (Index j = std::max<Index>(j0, 0); j < std::min(j0 + kTile, ny_); ++j)
            for (Index i = std::max<Index>(i0, 0); i < std::min(i0 + kTile, nx_); ++i) {
                const Standing node = on_node(body, water, i, j);
                if (!(node.depth > 0.0)) continue;
                const Index k = body.grid.at(i, j);
                const auto along = [&](const Vec2& v) {
                    const double up = climb(k, v.x(), v.y());
                    return std::sqrt(v.squaredNorm() + up * up);
                };
                const NodeState now{node.depth, along(node.velocity), node.pressure, node.inertia / node.depth};
                if (peaks == Peaks::grow) peaks_[k].note(now, time, footprint_depth_);
                extent.note(now, footprint_depth_, g.cell * g.cell, (Vec2(g.x(i), g.y(j)) - centre_).norm());
                if (water) continue;
                // The mean is of the step's end. By their mass, nodes with next to none do not count.
                const Vec2 end(body.moved[k].vx, body.moved[k].vy);
                extent.motion += body.node_mass[k] * (along(end) - now.speed);
            }
        of_tile_[static_cast<std::size_t>(n)] = extent;
    }
    extent_ = {};
    for (const FlowExtent& tile : of_tile_) extent_.add(tile);
}

Index StructuredMap::fronts(const StructuredBody& body, const WaterFlow* water, double since, double speed) const {
    Index count = 0;
    for (const Index tile : tiles_) {
        const Index i0 = body.grid.tile_i(tile), j0 = body.grid.tile_j(tile);
        for (Index j = std::max<Index>(j0, 0); j < std::min(j0 + kTile, ny_); ++j)
            for (Index i = std::max<Index>(i0, 0); i < std::min(i0 + kTile, nx_); ++i) {
                const NodePeak& peak = peaks_[body.grid.at(i, j)];
                if (!peak.covered(footprint_depth_) || peak.arrival < since) continue;
                count += on_node(body, water, i, j).velocity.norm() > speed;
            }
    }
    return count;
}

double StructuredMap::pressing(const StructuredBody& body, Index k) {
    if (!(body.node_mass[k] > 0.0)) return body.ground[k].across;  // parts of particles around, without a velocity
    const double borne = body.water ? meet_water(body, k).support : 0.0;
    return body.moved[k].normal_gravity + borne * body.ground[k].across;
}

double StructuredMap::density_of(const StructuredBody& body, Index k) {
    if (!body.water || !(body.node_mass[k] > 0.0)) return body.density;
    return frana::density_of(body, k, meet_water(body, k));
}

bool StructuredMap::is_in_reach(const StructuredBody& body, Index i, Index j) {
    const Index tile = (j + kTile) / kTile * body.grid.tiles_x() + (i + kTile) / kTile;
    return body.active.in_work[static_cast<std::size_t>(tile)] != 0;
}

void StructuredMap::sample(const StructuredBody& body, const WaterFlow* water, const Vec2& point, double& depth,
                           Vec2& velocity) {
    const NodeSquare around(body.grid.geometry(), point);
    depth = 0.0;
    double inertia = 0.0;
    Vec2 momentum(0, 0);
    for (Index k = 0; k < 4; ++k) {
        const Standing node = on_node(body, water, around.node(k).i, around.node(k).j);
        const double w = around.weight(k);
        depth += w * node.depth;
        inertia += w * node.inertia, momentum += w * node.inertia * node.velocity;
    }
    velocity = inertia > 0.0 ? Vec2(momentum / inertia) : Vec2(0, 0);
}

void StructuredMap::serialize(Archive& archive) {
    const Archive::Part part(archive, "map");
    archive.numbers("sums", extent_.numbers());
    if (archive.aside()) return;  // steps aside leave the peaks as they are
    const auto each = [&](auto&& body) {
        for (Index j = 0; j < ny_; ++j)
            for (Index i = 0; i < nx_; ++i) body(peaks_[(j + kTile) * stride_ + i + kTile]);
    };
    std::vector<double> all;
    if (!archive.loading())
        each([&](const NodePeak& q) {
            for (const double number : q.numbers()) all.push_back(number);
        });
    archive.array("peaks", all);
    const std::size_t expected = NodePeak::kNumbers * static_cast<std::size_t>(nx_ * ny_);
    if (all.size() != expected) Archive::wrong_length("peaks", all.size(), expected);
    if (!archive.loading()) return;
    const double* v = all.data();
    each([&](NodePeak& q) { q = NodePeak::of(v), v += NodePeak::kNumbers; });
}

}  // namespace frana
