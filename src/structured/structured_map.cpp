#include "structured/structured_map.h"

#include <algorithm>
#include <cmath>

namespace frana {

StructuredMap::StructuredMap(const TileGrid& grid, const Vec2& centre, double footprint_depth)
    : peaks_(grid.size()),
      nx_(grid.nx()),
      ny_(grid.ny()),
      stride_(grid.stride()),
      centre_(centre),
      footprint_depth_(footprint_depth) {}

void StructuredMap::note(const StructuredBody& body, double time) {
    const GridGeometry& g = body.grid.geometry();
    of_tile_.resize(body.active.work.size());
    for_each_work_tile(body.active, [&](Index n, Index tile) {
        Sums sums;
        const Index i0 = body.grid.tile_i(tile), j0 = body.grid.tile_j(tile);
        for (Index j = std::max<Index>(j0, 0); j < std::min(j0 + kTile, ny_); ++j)
            for (Index i = std::max<Index>(i0, 0); i < std::min(i0 + kTile, nx_); ++i) {
                const Index k = body.grid.at(i, j);
                const StructuredBody::Moved& node = body.moved[k];
                if (!(node.depth > 0.0)) continue;
                Peak& peak = peaks_[k];
                if (node.depth > footprint_depth_ && !(peak.depth > footprint_depth_)) peak.arrival = time;
                peak.depth = std::max(peak.depth, node.depth);
                peak.pressure = std::max(peak.pressure, body.density * node.pull * node.depth);
                if (node.depth >= 0.1 * footprint_depth_) {
                    const StructuredBody::Pull& ground = body.pull[k];
                    const double up = ground.slope_x * node.vx + ground.slope_y * node.vy;
                    const double speed = std::sqrt(node.vx * node.vx + node.vy * node.vy + up * up);
                    peak.speed = std::max(peak.speed, speed);
                    peak.dynamic_pressure = std::max(peak.dynamic_pressure, body.density * speed * speed);
                }
                sums.max_depth = std::max(sums.max_depth, node.depth);
                if (!(node.depth > footprint_depth_)) continue;
                sums.covered_area += g.cell * g.cell * body.pull[k].open;
                sums.front = std::max(sums.front, (Vec2(g.x(i), g.y(j)) - centre_).norm());
            }
        of_tile_[static_cast<std::size_t>(n)] = sums;
    });
    sums_ = {};
    for (const Sums& tile : of_tile_) {
        sums_.max_depth = std::max(sums_.max_depth, tile.max_depth);
        sums_.covered_area += tile.covered_area;
        sums_.front = std::max(sums_.front, tile.front);
    }
}

bool StructuredMap::touches(const StructuredBody& body, Index i, Index j) {
    const Index tile = (j + kTile) / kTile * body.grid.tiles_x() + (i + kTile) / kTile;
    return body.active.in_work[static_cast<std::size_t>(tile)] != 0;
}

void StructuredMap::sample(const StructuredBody& body, const Vec2& point, double& depth, Vec2& velocity) {
    const GridGeometry& g = body.grid.geometry();
    const double u = std::clamp((point.x() - g.x0) / g.cell, 0.0, static_cast<double>(g.nx - 1));
    const double v = std::clamp((point.y() - g.y0) / g.cell, 0.0, static_cast<double>(g.ny - 1));
    const Index i = std::min(static_cast<Index>(u), g.nx - 2), j = std::min(static_cast<Index>(v), g.ny - 2);
    const double fu = u - static_cast<double>(i), fv = v - static_cast<double>(j);
    depth = 0.0;
    Vec2 flux(0, 0);
    for (Index dj = 0; dj < 2; ++dj)
        for (Index di = 0; di < 2; ++di) {
            if (!touches(body, i + di, j + dj)) continue;
            const StructuredBody::Moved& node = body.moved[body.grid.at(i + di, j + dj)];
            const double w = (di ? fu : 1.0 - fu) * (dj ? fv : 1.0 - fv) * node.depth;
            depth += w, flux += w * Vec2(node.vx, node.vy);
        }
    velocity = depth > 0.0 ? Vec2(flux / depth) : Vec2(0, 0);
}

void StructuredMap::keep(Archive& archive) {
    const Archive::Part part(archive, "map");
    constexpr std::size_t kNumbers = 5;  // of a node
    const auto each = [&](auto&& body) {
        for (Index j = 0; j < ny_; ++j)
            for (Index i = 0; i < nx_; ++i) body(peaks_[(j + kTile) * stride_ + i + kTile]);
    };
    std::vector<double> all;
    if (!archive.loading())
        each([&](const Peak& q) {
            all.insert(all.end(), {q.depth, q.speed, q.pressure, q.dynamic_pressure, q.arrival});
        });
    archive.array("peaks", all);
    archive.numbers("sums", {&sums_.max_depth, &sums_.covered_area, &sums_.front});
    const std::size_t expected = kNumbers * static_cast<std::size_t>(nx_ * ny_);
    if (all.size() != expected) Archive::wrong_length("peaks", all.size(), expected);
    if (!archive.loading()) return;
    const double* v = all.data();
    each([&](Peak& q) { q = {v[0], v[1], v[2], v[3], v[4]}, v += kNumbers; });
}

}  // namespace frana
