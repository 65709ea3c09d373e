#include <random>

#include "catch.h"
#include "release_maker.h"

using namespace frana;
using namespace release_maker;

namespace {

/// Largest difference between the share of points in boxes [0, u] x [0, v] of the unit square and their area.
double discrepancy(const std::vector<Vec2>& points) {
    double worst = 0.0;
    for (int a = 1; a <= 40; ++a)
        for (int b = 1; b <= 40; ++b) {
            const double u = a / 40.0, v = b / 40.0;
            double inside = 0.0;
            for (const Vec2& p : points) inside += p.x() < u && p.y() < v;
            worst = std::max(worst, std::abs(inside / static_cast<double>(points.size()) - u * v));
        }
    return worst;
}

bool within(const Ring& ring, double x, double y) {
    bool inside = false;
    for (std::size_t k = 0; k < ring.size(); ++k) {
        const Vec2 a = ring[k], b = ring[(k + 1) % ring.size()];
        if ((a.y() > y) != (b.y() > y) && x < a.x() + (y - a.y()) * (b.x() - a.x()) / (b.y() - a.y())) inside = !inside;
    }
    return inside;
}

/// A valley side: gradient 0.1 west of the middle, 0.3 east of it.
Raster two_slopes(Index nodes, double cell) {
    Raster bed = flat_bed(nodes, nodes, cell);
    const double middle = 0.5 * bed.geometry.x_max();
    for (Index j = 0; j < nodes; ++j)
        for (Index i = 0; i < nodes; ++i) {
            const double x = bed.geometry.x(i) - middle;
            bed.at(i, j) = x < 0 ? 0.1 * x : 0.3 * x;
        }
    return bed;
}

}  // namespace

TEST_CASE("V17: R2 placement meets the count, stays in the outline and holds the exact volume", "[particles]") {
    const Ring outer = star({50, 40}, 36, 15, 7, 0.2), hole = rotated_square({50, 40}, 12, 0.3);
    Release release = release_of({{{outer, hole}}}, 0.0);
    release.depth_field = bumpy_depth({50, 40, 3.0, 1.0, 2.1});
    for (const Placement placement : {Placement::r2, Placement::slope})
        for (const Index count : {1, 17, 1000, 20000}) {
            const Made made = make({release}, two_slopes(101, 1.0), count_of(count, placement));
            REQUIRE(made.seeds.count() == count);
            const double exact = volume_in_box(release, 0, 0, 100, 100);
            CHECK(std::abs(made.volume() - exact) < 1e-12 * exact);
            for (Index p = 0; p < count; ++p) {
                CHECK(within(outer, made.seeds.x[p], made.seeds.y[p]));
                CHECK_FALSE(within(hole, made.seeds.x[p], made.seeds.y[p]));
                CHECK(made.seeds.volume[p] > 0.0);
            }
        }
}

TEST_CASE("V17: without a count, R2 places per_cell particles to the cell", "[particles]") {
    const Release release = release_of({{{rotated_square({50, 40}, 30, 0.2)}}}, 1.0);
    const Made made = make({release}, flat_bed(51, 51, 2.0), {4.0, {}, Placement::r2});
    CHECK(std::abs(static_cast<double>(made.seeds.count()) - 4.0 * 900.0 / 4.0) <= 1.0);
}

TEST_CASE("Two releases share an R2 count by their areas", "[particles]") {
    const Release small = release_of({{{rotated_square({30, 30}, 20, 0.2)}}}, 1.0);
    const Release large = release_of({{{rotated_square({70, 70}, 40, 0.2)}}}, 1.0);
    const Made made = make({small, large}, flat_bed(101, 101, 1.0), count_of(1003, Placement::r2));
    CHECK(made.seeds.count() == 1003);
    CHECK(std::abs(made.reports[0].count - 1003 / 5) <= 1);
}

TEST_CASE("V17: R2 points fill a square more evenly than random ones", "[particles]") {
    Release everywhere;
    everywhere.depth = 1.0;
    const Made made = make({everywhere}, flat_bed(11, 11, 1.0), count_of(1000, Placement::r2));
    std::vector<Vec2> quasi, drawn;
    for (Index p = 0; p < 1000; ++p) quasi.emplace_back(made.seeds.x[p] / 10.0, made.seeds.y[p] / 10.0);
    std::mt19937 random(11);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    double mean = 0.0;
    for (int round = 0; round < 8; ++round) {
        drawn.clear();
        for (int p = 0; p < 1000; ++p) drawn.emplace_back(unit(random), unit(random));
        mean += discrepancy(drawn) / 8.0;
    }
    // Random: about 1 / sqrt(1000) = 0.03; a low-discrepancy sequence some log(N) / N = 0.007.
    CHECK(discrepancy(quasi) < 0.4 * mean);
    CHECK(discrepancy(quasi) < 0.01);
}

TEST_CASE("R2 patches have nearly equal areas and the depth of their place", "[particles]") {
    Release release;
    release.depth_field = Raster::filled({100, 100, 0.5, 0.5, 1.0}, 0.0);
    for (Index j = 0; j < 100; ++j)
        for (Index i = 0; i < 100; ++i) release.depth_field->at(i, j) = 1.0 + 0.02 * static_cast<double>(i);
    const Made made = make({release}, flat_bed(101, 101, 1.0), count_of(10000, Placement::r2));
    for (Index p = 0; p < 10000; ++p) {
        // A patch of mean edge 1 m reaches about 1 m from its particle, over which the depth changes by 0.02
        // m.
        CHECK(std::abs(made.seeds.depth[p] - (1.0 + 0.02 * (made.seeds.x[p] - 0.5))) < 0.03);
        const double x = made.seeds.x[p], y = made.seeds.y[p];
        if (x > 2 && x < 98 && y > 2 && y < 98) CHECK(made.seeds.size[p] == Approx(1.0).margin(0.25));
    }
}

TEST_CASE("Slope placement follows the steepness of the bed", "[particles]") {
    Release everywhere;
    everywhere.depth = 1.0;
    const Made made = make({everywhere}, two_slopes(101, 1.0), count_of(20000, Placement::slope));
    double gentle = 0.0, steep = 0.0;
    for (const double x : made.seeds.x) {
        gentle += x > 5 && x < 45;
        steep += x > 55 && x < 95;
    }
    // Gradients 0.1 and 0.3: three times the density. 5 % is three times the scatter of as many random
    // points.
    CHECK(steep / gentle == Approx(3.0).epsilon(0.05));
    CHECK(made.volume() == Approx(10000.0).epsilon(1e-12));
    for (const double depth : made.seeds.depth) CHECK(depth == Approx(1.0).epsilon(1e-13));
}

TEST_CASE("On flat ground slope placement is even", "[particles]") {
    Release everywhere;
    everywhere.depth = 1.0;
    const Made made = make({everywhere}, flat_bed(101, 101, 1.0), count_of(8000, Placement::slope));
    double west = 0.0;
    for (const double x : made.seeds.x) west += x < 50.0;
    CHECK(west == Approx(4000.0).epsilon(0.01));
}
