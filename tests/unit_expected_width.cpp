// The width that a flow may be expected to have, in valleys of known shape.
#include <cmath>

#include "catch.h"
#include "compare/expected_width.h"

using namespace frana;

namespace {

constexpr double cell = 5.0, slope = 0.3, depth = 2.0;

/// 1500 m down to the east, 400 m across, with a section of its own.
template <class Section>
Raster valley(const Section& section) {
    Raster bed = Raster::filled({301, 81, 0.0, -200.0, cell}, 0.0);
    const GridGeometry& g = bed.geometry;
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i) bed.at(i, j) = 1000.0 - slope * g.x(i) + section(g.y(j));
    return bed;
}

/// A slab of points 5 m apart, in [100, 100 + length] x [-width / 2, width / 2].
Seeds slab(double length, double width) {
    Seeds seeds;
    for (double x = 2.5; x < length; x += 5.0)
        for (double y = 2.5 - 0.5 * width; y < 0.5 * width; y += 5.0) {
            seeds.x.push_back(100.0 + x), seeds.y.push_back(y);
            seeds.vx.push_back(0.0), seeds.vy.push_back(0.0);
            seeds.volume.push_back(25.0 * depth), seeds.depth.push_back(depth), seeds.size.push_back(5.0);
        }
    return seeds;
}

/// Sections are sampled every half cell, with one sample more or less on either side.
Approx to_a_cell(double width) { return Approx(width).margin(cell).epsilon(0.0); }

}  // namespace

TEST_CASE("On open ground a flow is expected to be as wide as its release", "[width]") {
    const ExpectedWidth found = expected_width(valley([](double) { return 0.0; }), slab(60, 100), 0.0);
    CHECK(found.release == Approx(100.0).epsilon(1e-9));
    CHECK(found.width == Approx(100.0).epsilon(1e-9));
}

TEST_CASE("A point stands for its material, not for a patch of the lattice that is mostly empty", "[width]") {
    Seeds one = slab(5, 5);
    one.size = {80.0};  // of which 25 m2 have material
    CHECK(expected_width(valley([](double) { return 0.0; }), one, 0.0).release == Approx(5.0).epsilon(1e-9));
}

TEST_CASE("In a valley it is as wide as what the release's section fills", "[width]") {
    // Sides of 1 in 2: a section of 2 m x 100 m is w^2 / 8.
    const ExpectedWidth wedge = expected_width(valley([](double y) { return 0.5 * std::abs(y); }), slab(60, 100), 0.0);
    CHECK(wedge.width == to_a_cell(std::sqrt(8.0 * depth * 100.0)));
    // A flat-bottomed channel of 30 m between walls that the flow does not climb.
    const ExpectedWidth box =
        expected_width(valley([](double y) { return std::abs(y) > 15.0 ? 50.0 : 0.0; }), slab(60, 100), 0.0);
    CHECK(box.width == to_a_cell(30.0));
}

TEST_CASE("Only the part of the valley that the flow may reach counts", "[width]") {
    // A gully for 300 m, then open ground that falls by 0.05 only: with a friction of 0.25 the flow ends there.
    Raster bed = valley([](double) { return 0.0; });
    const GridGeometry& g = bed.geometry;
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i) {
            const double x = g.x(i), out = std::max(0.0, x - 500.0);
            bed.at(i, j) += 0.25 * out + (out > 0.0 ? 0.0 : 0.5 * std::abs(g.y(j)));
        }
    CHECK(expected_width(bed, slab(60, 100), 0.25).width == to_a_cell(std::sqrt(8.0 * depth * 100.0)));
    CHECK(expected_width(bed, slab(60, 100), 0.0).width > 90.0);
}

TEST_CASE("The path begins at a node, which may lie above the point of the release that is nearest to it", "[width]") {
    Seeds release = slab(60, 100);
    for (double& x : release.x) x -= 0.1;  // 2.4 m down from a node, the nearest one
    CHECK(expected_width(valley([](double) { return 0.0; }), release, 0.2).width == Approx(100.0).epsilon(1e-9));
}

TEST_CASE("Without a release, or where nothing flows, no width is expected", "[width]") {
    const Raster bed = valley([](double) { return 0.0; });
    CHECK(std::isnan(expected_width(bed, Seeds{}, 0.0).width));
    Raster nothing = bed;
    for (double& z : nothing.values) z = Raster::nodata;
    CHECK(std::isnan(expected_width(nothing, slab(60, 100), 0.0).width));
}
