#include "checks/verify/structured_cases.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "base/constants.h"
#include "mpm/stencil.h"

namespace frana::verify {
namespace {

using constants::kDegree;
constexpr double kLength = 0.30, kWidth = 0.25,
                 kSide = 0.125;  // of the flume's block; its side's way to the wall [m]

/// Particles of the field scenarios: 1900 kg/m^3, phi 30 degrees, E 100 MPa, 12 degrees at the bed.
StructuredScene field_block(double depth, double cohesion, double length, double cell, int per_side) {
    StructuredScene s;
    s.density = 1900.0;
    s.material.young = 100e6;
    s.material.friction = 30.0 * kDegree;
    s.material.critical_strain = 0.1;  // on any cell: on a fan all of a block breaks, not one crack
    s.bed_law = bed::Coulomb{std::tan(12.0 * kDegree)};
    s.grid = grid_over({-20.0, -150.0}, {length, 210.0}, cell);
    StructuredBlock block;
    block.high = {100.0, 60.0};
    block.depth = depth, block.cohesion = cohesion, block.per_side = per_side;
    add_block(s, block);
    return s;
}

/// From 0 to 1 around x = 0, over some 10 m.
double turn(double x) { return 0.5 * (1.0 + std::tanh(x / 10.0)); }

}  // namespace

StructuredScene clay_flume(const Clay& clay, double cell, int per_side) {
    StructuredScene s;
    s.density = 1700.0;
    s.material.young = 1.5e6;
    s.material.friction = clay.friction_deg * kDegree;
    s.material.critical_strain = critical_strain(0.07, 0.0125, cell);
    s.bed_law = bed::Coulomb{std::tan(27.0 * kDegree)};
    s.ground = flume_ground([](double x) { return (x < 0.0 ? 42.0 : 5.0) * kDegree; });
    s.cfl = 0.3;
    s.grid = grid_over({-0.4, 0.0}, {1.8, 0.5}, cell);
    add_channel(s, 0.0, 0.5);
    // Half a cell narrower, so that the nodes along its side are free. On them the obstacle is wider by half
    // a cell all the same, and coverage is 0.75 and 0.46. A twentieth of the block's width does as much.
    Obstacle wall;
    wall.low.x() = 0.0, wall.high = {0.15, kSide + 0.4 * kWidth - 0.5 * cell}, wall.friction = 0.3;
    s.obstacles.push_back(wall);
    StructuredBlock block;
    block.low = {-kLength, kSide}, block.high = {0.0, kSide + kWidth};
    block.depth = 0.1, block.cohesion = clay.cohesion, block.velocity = {2.39, 0.0}, block.per_side = per_side;
    add_block(s, block);
    return s;
}

double crack_coverage(const StructuredFlow& flow, const StructuredSeeds& seeds) {
    const double cell = flow.body().grid.cell();
    std::set<Index> broken, all;
    const StructuredPoints& q = flow.body().points;
    for (Index p = 0; p < q.count(); ++p) {
        const std::size_t seed = static_cast<std::size_t>(q.id[p]);
        if (seed >= seeds.y.size()) continue;  // a part of another that was split: that one is counted
        const double across = (seeds.y[seed] - kSide) / kWidth;
        const Index slice = static_cast<Index>(std::floor(-seeds.x[seed] / cell));
        all.insert(slice);
        if (across > 0.28 && across < 0.80 && q.damage[p] > 0.9) broken.insert(slice);
    }
    return static_cast<double>(broken.size()) / static_cast<double>(all.size());
}

StructuredScene convex_block(double cohesion, double cell, int per_side) {
    StructuredScene s = field_block(5.0, cohesion, 700.0, cell, per_side);
    s.ground = terrain_ground([](double x, double) {
        const double first = std::tan(10.0 * kDegree), second = std::tan(30.0 * kDegree);
        return Vec2(-(first + (second - first) * turn(x - 50.0) - second * turn(x - 250.0)), 0.0);
    });
    return s;
}

/// Slope -tan(25 deg) (1 - t) along x and t fan tanh(y / 20 m) across, t = turn(x - 220 m), y from the
/// block's middle. It is the gradient of a surface but for the 20 m where t turns. There the surface would rise or fall
/// along x too.
StructuredScene valley_block(double cohesion, double fan, double cell, int per_side) {
    StructuredScene s = field_block(12.0, cohesion, 600.0, cell, per_side);
    s.ground = terrain_ground([fan](double x, double y) {
        const double t = turn(x - 220.0), across = (y - 30.0) / 20.0;
        return Vec2(-std::tan(25.0 * kDegree) * (1.0 - t), t * fan * std::tanh(across));
    });
    return s;
}

namespace {

/// Height of ground with the scene's fall along x, from x = 0 on, in steps of a metre.
Function height_along_x(const Ground& ground) {
    return [ground](double x, double y) {
        double z = 0.0;
        const int parts = static_cast<int>(std::ceil(std::abs(x)));
        for (int n = 0; n < parts; ++n) {
            const GroundGravity ground_gravity = ground((n + 0.5) * x / parts, y);
            z -= x / parts * ground_gravity.x / ground_gravity.across;
        }
        return z;
    };
}

}  // namespace

std::vector<ShownBlock> shown_blocks(const std::string& problem) {
    std::vector<ShownBlock> shown;
    if (problem == "clay_flume")
        for (const auto& [name, clay] : {std::pair{"soft", kSoftClay}, std::pair{"stiff", kStiffClay}})
            shown.push_back({name, std::string("Clay flume, the ") + name + " clay after 0.6 s",
                             clay_flume(clay, 0.0125), 0.6,
                             [](double x, double) { return -x * std::tan((x < 0.0 ? 42.0 : 5.0) * kDegree); }});
    const auto add = [&](const char* name, const char* title, const StructuredScene& scene, double end) {
        shown.push_back({name, title, scene, end, height_along_x(scene.ground)});
    };
    if (problem == "blocks_2") {
        add("2a", "2A: 200 kPa over a convex slope, 14 s", convex_block(200e3, 2.5), 14.0);
        add("2b", "2B: 60 kPa over a convex slope, 14 s", convex_block(60e3, 2.5), 14.0);
    }
    if (problem == "blocks_3") {
        add("3a", "3A: 400 kPa into the valley, 16 s", valley_block(400e3, -0.2, 2.5), 16.0);
        add("3b", "3B: 28 kPa into the valley, 16 s", valley_block(28e3, -0.2, 2.5), 16.0);
        add("3c", "3C: 15 kPa on the slope, 5 s", valley_block(15e3, 0.1, 2.5), 5.0);
        for (ShownBlock& block : shown)
            block.bed = [along = block.bed, fan = block.name == "3c" ? 0.1 : -0.2](double x, double y) {
                return along(x, y) + turn(x - 220.0) * fan * 20.0 * std::log(std::cosh((y - 30.0) / 20.0));
            };
    }
    return shown;
}

NodeMaps node_maps(const StructuredFlow& flow) {
    const GridGeometry& g = flow.body().grid.geometry();
    const StructuredPoints& q = flow.body().points;
    NodeMaps maps;
    maps.depth.assign(static_cast<std::size_t>(g.size()), 0.0), maps.damage = maps.depth;
    for (Index p = 0; p < q.count(); ++p) {
        const Quadratic x(q.x[p]), y(q.y[p]);
        for (int j = 0; j < 3; ++j)
            for (int i = 0; i < 3; ++i) {
                const std::size_t node = static_cast<std::size_t>((y.base + j) * g.nx + x.base + i);
                const double depth = x.w[i] * y.w[j] * q.volume[p] / (g.cell * g.cell);
                maps.depth[node] += depth, maps.damage[node] += depth * q.damage[p];
            }
    }
    for (std::size_t node = 0; node < maps.depth.size(); ++node)
        maps.damage[node] =
            maps.depth[node] > 0.0 ? maps.damage[node] / maps.depth[node] : std::numeric_limits<double>::quiet_NaN();
    return maps;
}

}  // namespace frana::verify
