#include "verify/structured_cases.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace frana::verify {
namespace {

constexpr double kDegree = M_PI / 180.0;
constexpr double kLength = 0.30, kWidth = 0.25,
                 kSide = 0.125;  // of the flume's block; its side's way to the wall [m]

/// Columns of the field scenarios: 1900 kg/m^3, phi 30 degrees, E 100 MPa, 12 degrees at the bed.
StructuredScene field_block(double depth, double cohesion, double length, double cell, int per_side) {
    StructuredScene s;
    s.density = 1900.0;
    s.material.young = 100e6;
    s.material.friction = 30.0 * kDegree;
    s.material.critical_strain = critical_strain(0.1, 2.5, cell);
    s.bed_friction = std::tan(12.0 * kDegree);
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
    s.bed_friction = std::tan(27.0 * kDegree);
    s.ground = flume_ground([](double x) { return (x < 0.0 ? 42.0 : 5.0) * kDegree; });
    s.grid = grid_over({-0.4, 0.0}, {1.8, 0.5}, cell);
    add_channel(s, 0.0, 0.5);
    // Half a cell narrower, so that the nodes along its side are free. On them the obstacle is wider by half
    // a cell all the same, and coverage is 0.75 and 0.46: as much as a twentieth of the block's width does.
    Obstacle wall;
    wall.low.x() = 0.0, wall.high = {0.15, kSide + 0.4 * kWidth - 0.5 * cell}, wall.friction = 0.3;
    s.obstacles.push_back(wall);
    StructuredBlock block;
    block.low = {-kLength, kSide}, block.high = {0.0, kSide + kWidth};
    block.depth = 0.1, block.cohesion = clay.cohesion, block.velocity = {2.39, 0.0},
    block.per_side = per_side;
    add_block(s, block);
    return s;
}

double crack_coverage(const StructuredFlow& flow, const StructuredSeeds& seeds) {
    const double cell = flow.body().grid.cell();
    std::set<Index> broken, all;
    const StructuredPoints& q = flow.body().points;
    for (Index p = 0; p < q.count(); ++p) {
        const std::size_t seed = static_cast<std::size_t>(q.id[p]);
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
/// block's middle: the gradient of a surface but for the 20 m where t turns, where the surface would rise or
/// fall along x too.
StructuredScene valley_block(double cohesion, double fan, double cell, int per_side) {
    StructuredScene s = field_block(12.0, cohesion, 600.0, cell, per_side);
    s.ground = terrain_ground([fan](double x, double y) {
        const double t = turn(x - 220.0), across = (y - 30.0) / 20.0;
        return Vec2(-std::tan(25.0 * kDegree) * (1.0 - t), t * fan * std::tanh(across));
    });
    return s;
}

}  // namespace frana::verify
