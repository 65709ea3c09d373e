// 3D material on rough ground: none gets through it.
#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "catch.h"
#include "solid3d/bed_height.h"
#include "solid_maker.h"

using namespace frana;

namespace {

constexpr double kCell = 0.1;

enum class Feature { ridge, pit, step, needle };

/// Level ground with one feature a cell wide, whose flanks are that steep.
Raster ground_with(Feature feature, double degrees) {
    Raster bed = Raster::filled({80, 49, -3.2, -2.2, kCell}, 0.0);
    const double height = kCell * std::tan(degrees * constants::kPi / 180.0);
    for (Index j = 0; j < bed.geometry.ny; ++j)
        for (Index i = 0; i < bed.geometry.nx; ++i) {
            const bool here = i == 40, middle = j == 24;
            if (feature == Feature::ridge && here) bed.at(i, j) = height;
            if (feature == Feature::pit && here) bed.at(i, j) = -height;
            if (feature == Feature::step && i > 40) bed.at(i, j) = height;
            if (feature == Feature::needle && here && middle) bed.at(i, j) = height;
        }
    return bed;
}

/// A block of 0.5 x 0.4 x 0.4 m that falls onto the feature at a slant, at 4 m/s.
SolidScene thrown(const SolidLaw& law, const Surface& ground) {
    SolidScene s;
    s.law = law;
    s.density = 1000.0;
    s.grid.cell = kCell;
    s.grid.origin = {-3.2, -2.2, -0.5};
    s.grid.nodes = {80, 49, 45};
    s.surfaces = {ground};
    verify::for_each_part({0.3, -0.2, 0.3}, {0.8, 0.2, 0.7}, kCell, 2, [&](const Vec3& x, double volume) {
        s.points.add(x, {2.8, 0.0, -2.8}, s.density * volume);
    });
    return s;
}

/// How far the deepest point that the ground is still under lies below it [m].
double deepest(const Mpm3d& flow, const Raster& bed) {
    double worst = 0.0;
    for (Index p = 0; p < flow.body().points.count(); ++p) {
        const Vec3 x = flow.position(p);
        worst = std::max(worst, bed_height(bed, x.x(), x.y()).z - x.z());
    }
    return worst;
}

}  // namespace

TEST_CASE("Nothing gets through ground with features a cell wide, at slopes up to 68 degrees", "[solid]") {
    // Every pair of feature, slope and hold, and at the steepest of these and law: a point's place does not hang on it.
    for (const Feature feature : {Feature::ridge, Feature::pit, Feature::step, Feature::needle})
        for (const double degrees : {45.0, 60.0, 68.0})
            for (const SolidLaw& law : all_solid_laws()) {
                const std::size_t shape = static_cast<std::size_t>(feature), steep = degrees > 50.0;
                if (degrees < 68.0 && law.index() != (shape / 2 + steep) % 2) continue;
                const std::size_t turn = degrees < 68.0 ? steep : law.index();
                const Hold hold = (shape + turn) % 2 == 0 ? Hold::free : Hold::stuck;
                CAPTURE(static_cast<int>(feature), degrees, static_cast<int>(hold), law.index());
                const Raster bed = ground_with(feature, degrees);
                SolidScene s = thrown(law, Surface::ground(bed, hold, hold == Hold::free ? 0.3 : 0.0));
                Mpm3d flow(s);
                const double mass = flow.status().mass;
                double worst = 0.0;
                while (flow.status().time < 0.4) {
                    flow.advance(0.4);
                    worst = std::max(worst, deepest(flow, bed));
                }
                // Points are put back along a plane that touches the ground, which bends only beside the needle.
                CHECK(worst < (feature == Feature::needle ? 0.01 * kCell : 1e-12));
                CHECK(flow.status().mass == Approx(mass).epsilon(1e-13));  // the sides are too far to leave by
            }
}

namespace {

/// Points of 1 kg at rest on the ground. The grid's nodes lie between those of the ground, and half a cell beyond them
/// points are still there.
SolidScene resting(const Raster& bed, double cell, const std::vector<Vec3>& points) {
    SolidScene s;
    s.density = 1000.0;
    s.law = solid::Bingham{1.74e5, 268.0, 0.0, 2.68};
    const GridGeometry& g = bed.geometry;
    s.grid.cell = cell;
    s.grid.origin = {g.x0 - 1.5 * cell, g.y0 - 1.5 * cell, -3.0 * cell};
    s.grid.nodes = {g.nx + 3, g.ny + 3, 16};
    s.surfaces = {Surface::ground(bed)};
    for (const Vec3& x : points) s.points.add(x, Vec3::Zero(), 1.0);
    return s;
}

/// The most that energy has risen above the start's, over what the points fell through [1].
double gained(const SolidScene& scene, double end) {
    Mpm3d flow(scene);
    const SolidStatus& s = flow.status();
    const double start = s.energy_given, high = s.potential;
    double most = 0.0, low = high;
    while (s.time < end && s.points > 0) {
        flow.advance(1e9);
        most = std::max(most, s.kinetic + s.potential + s.stored + s.energy_left - start);
        low = std::min(low, s.potential + s.energy_left);
    }
    CHECK(high > low);
    return most / (high - low);
}

}  // namespace

TEST_CASE("A point slides off the end of sloping ground with the energy of its fall", "[solid]") {
    Raster bed = Raster::filled({5, 5, 0.0, 0.0, 1.0}, 0.0);
    for (Index j = 0; j < 5; ++j)
        for (Index i = 0; i < 5; ++i) bed.at(i, j) = 0.8 * static_cast<double>(j);
    // Half of the last cell lies beyond the outer nodes. A step of velocity first errs by m g^2 dt^2 / 2, and loses.
    CHECK(gained(resting(bed, 1.0, {{2.1, 1.2, 0.97}}), 2.0) < 1e-12);
}

TEST_CASE("Ground that bends like a corner gives few points no energy", "[solid]") {
    // A cliff of 65 degrees, askew to the grid. The bound is that of corners (conserve_solid_corners.cpp).
    Raster bed = Raster::filled({4, 4, 0.0, 0.0, 0.5}, 0.0);
    for (Index j = 0; j < 4; ++j)
        for (Index i = 0; i < 4; ++i) bed.at(i, j) = (i + j < 3 ? 1.08 : 0.08) - 0.028 * static_cast<double>(i + j);
    std::vector<Vec3> points;
    for (const double x : {0.375, 0.625})
        for (const double y : {0.875, 1.125}) points.push_back({x, y, bed_height(bed, x, y).z + 0.045});
    CHECK(gained(resting(bed, 0.5, points), 0.45) < 0.01);
}
