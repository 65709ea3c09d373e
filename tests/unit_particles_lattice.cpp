#include <random>

#include "base/error.h"
#include "catch.h"
#include "release_maker.h"

using namespace frana;
using namespace release_maker;

namespace {

// Total volume against a sum made in another way: both hold some 10^4 terms with round-off 1e-16 each.
constexpr double kVolumeError = 1e-12;

void check_volume(const Made& made, double exact) {
    CHECK(std::abs(made.volume() - exact) <= kVolumeError * exact);
    for (const auto& report : made.reports) CHECK(report.relative_error <= kVolumeError);
}

Polygon square_with_hole() { return {{rotated_square({50, 40}, 40.0, 0.3), rotated_square({52, 38}, 11.0, 1.0)}}; }

}  // namespace

TEST_CASE("Four per cell is the 2 x 2 lattice whose first point stands a quarter cell from node (0, 0)",
          "[particles]") {
    Release everywhere;
    everywhere.depth = 2.0;
    const Made made = make({everywhere}, flat_bed(6, 4, 10.0, 1000.0, 2000.0));
    REQUIRE(made.seeds.count() == 10 * 6);
    CHECK(made.seeds.x[0] == 1002.5);
    CHECK(made.seeds.y[0] == 2002.5);
    CHECK(made.seeds.x[1] == 1007.5);
    CHECK(made.seeds.y[10] == 2007.5);
    for (Index p = 0; p < made.seeds.count(); ++p) {
        CHECK(made.seeds.volume[p] == 50.0);
        CHECK(made.seeds.depth[p] == 2.0);
        CHECK(made.seeds.size[p] == 5.0);
    }
    CHECK(made.reports[0].volume == 50.0 * 30.0 * 2.0);
    CHECK(made.reports[0].area == 1500.0);
}

TEST_CASE("Particles hold the exact volume of outlines with holes, stars, squares and several parts", "[particles]") {
    const Raster bed = flat_bed(101, 81, 1.0);
    const std::vector<std::vector<Polygon>> outlines{
        {square_with_hole()},
        {{{star({48.3, 41.7}, 35.0, 12.0, 9, 0.05)}}},
        {{{rotated_square({33.3, 44.4}, 27.7, 0.6)}}},
        {{{star({25, 30}, 20, 8, 5)}}, {{star({75, 50}, 22, 9, 6)}}, {{rotated_square({70, 12}, 9, 0.2)}}}};
    for (const auto& outline : outlines)
        for (const double number : {1.0, 4.0, 5.3, 9.0}) {
            const Release release = release_of(outline, 1.37);
            const double exact = 1.37 * area_in_box(*release.outline, -1e4, -1e4, 1e4, 1e4);
            check_volume(make({release}, bed, per_cell(number)), exact);
        }
}

TEST_CASE("Particles hold the exact volume of depth rasters whose pixels do not fit the lattice", "[particles]") {
    const Raster bed = flat_bed(61, 51, 2.0);
    for (const double pixel : {0.37, 1.1, 3.3, 7.9}) {
        Release release = release_of({square_with_hole()}, 0.0);
        release.depth_field =
            bumpy_depth({static_cast<Index>(80 / pixel), static_cast<Index>(75 / pixel), 17.123, 9.87, pixel});
        for (const double number : {1.0, 4.0, 7.0})
            check_volume(make({release}, bed, per_cell(number)), volume_in_box(release, 0, 0, 120, 100));
        release.outline.reset();
        check_volume(make({release}, bed), volume_in_box(release, 0, 0, 120, 100));
    }
}

TEST_CASE("Each particle holds the volume over its own patch", "[particles]") {
    const double cell = 2.0, spacing = cell / std::sqrt(3.0);
    Release release = release_of({square_with_hole()}, 0.0);
    release.depth_field = bumpy_depth({40, 30, 15.0, 5.0, 2.3});
    const Made made = make({release}, flat_bed(61, 51, cell), per_cell(3.0));
    REQUIRE(made.seeds.count() > 500);
    Index shared = 0;
    for (Index p = 0; p < made.seeds.count(); ++p) {
        const double x = made.seeds.x[p], y = made.seeds.y[p], half = 0.5 * spacing;
        const double area = area_in_box(*release.outline, x - half, y - half, x + half, y + half);
        const double exact = volume_in_box(release, x - half, y - half, x + half, y + half);
        // A patch that got a neighbour's dust may have at most 8 x 1e-3 of a patch more.
        if (std::abs(made.seeds.volume[p] - exact) > 1e-11 * exact) {
            ++shared;
            CHECK(std::abs(made.seeds.volume[p] - exact) < 8e-3 * spacing * spacing * 2.5);
        }
        if (area > 0.999 * spacing * spacing) CHECK(made.seeds.depth[p] == Approx(exact / area).epsilon(1e-2));
        CHECK(made.seeds.size[p] == Approx(spacing).epsilon(1e-15));
    }
    CHECK(shared < made.seeds.count() / 100);
}

TEST_CASE("The depth of a patch is the mean of samples taken on it", "[particles]") {
    Release release = release_of({{{star({50, 40}, 36.0, 15.0, 5, 0.2)}}}, 0.0);
    release.depth_field = bumpy_depth({60, 50, 10.0, 0.0, 1.7});
    const Raster& field = *release.depth_field;
    const Made made = make({release}, flat_bed(26, 21, 4.0), per_cell(1.0));
    std::mt19937 random(7);
    std::uniform_real_distribution<double> within(-2.0, 2.0);
    for (Index p = 0; p < made.seeds.count(); ++p) {
        const double x = made.seeds.x[p], y = made.seeds.y[p];
        if (area_in_box(*release.outline, x - 2, y - 2, x + 2, y + 2) < 15.999) continue;
        double sum = 0.0, covered = 0.0;
        for (int k = 0; k < 4000; ++k) {
            const double u = x + within(random), v = y + within(random);
            const double depth = field.at(static_cast<Index>(std::floor((u - field.geometry.x0) / 1.7 + 0.5)),
                                          static_cast<Index>(std::floor((v - field.geometry.y0) / 1.7 + 0.5)));
            if (depth > 0.0) sum += depth, covered += 1.0;
        }
        // Depth scatters by 0.6 m within a patch; five standard errors of 4000 samples.
        CHECK(std::abs(made.seeds.depth[p] - sum / covered) < 5.0 * 0.6 / std::sqrt(4000.0));
    }
}

TEST_CASE("A count is met within one per cent on a free lattice", "[particles]") {
    const Raster bed = flat_bed(101, 81, 1.0);
    for (const Index count : {100, 773, 2500, 12345, 70001}) {
        const Release release = release_of({{{star({48.3, 41.7}, 35.0, 17.0, 7, 0.05)}}}, 1.5);
        const Made made = make({release}, bed, count_of(count));
        const bool aligned = made.said("grid-aligned");
        CHECK(std::abs(static_cast<double>(made.seeds.count() - count)) <=
              (aligned ? 0.02 : 0.01) * static_cast<double>(count));
        CHECK(made.reports[0].count == made.seeds.count());
        check_volume(made, 1.5 * area_in_box(*release.outline, 0, 0, 100, 80));
    }
}

TEST_CASE("The image of Fois et al. (2025), section 4.1, is met for every number of the paper", "[particles]") {
    Release release;
    release.depth_field = Raster::filled({100, 100, 0.5, 0.5, 1.0}, 0.0);
    double exact = 0.0;
    for (Index j = 0; j < 100; ++j)
        for (Index i = 0; i < 100; ++i) {
            const double r2 = std::pow(static_cast<double>(i) - 49.5, 2) + std::pow(static_cast<double>(j) - 49.5, 2);
            exact += release.depth_field->at(i, j) = 1.0 + 2.0 * std::exp(-r2 / 150.0);
        }
    for (const Index count : {10000, 100000, 1000000}) {
        const Made made = make({release}, flat_bed(101, 101, 1.0), count_of(count));
        CHECK(std::abs(static_cast<double>(made.seeds.count() - count)) <= 0.01 * static_cast<double>(count));
        check_volume(made, exact);
    }
}

TEST_CASE("A count near that of a grid-aligned lattice gives that lattice", "[particles]") {
    const Raster bed = flat_bed(51, 51, 2.0);
    const Release release = release_of({{{rotated_square({50, 50}, 60.0, 0.4)}}}, 1.0);
    for (const double each : {1.0, 4.0, 9.0, 16.0}) {
        const Index own = make({release}, bed, per_cell(each)).seeds.count();
        const Made made = make({release}, bed, count_of(own + own / 60));
        CHECK(made.seeds.count() == own);
        CHECK(made.seeds.size[0] == 2.0 / std::sqrt(each));
        CHECK(made.seeds.x == make({release}, bed, per_cell(each)).seeds.x);
    }
}

TEST_CASE("A patch covered by less than a thousandth gives its volume to a neighbour", "[particles]") {
    const Raster bed = flat_bed(11, 11, 1.0);
    const double sliver = 1e-4;  // beyond the lattice line, in m of a patch edge of 0.5 m
    const Release exact = release_of_ring(rectangle_ring(2, 2, 6, 5), 3.0);
    const Release wider = release_of_ring(rectangle_ring(2, 2, 6 + sliver, 5 + sliver), 3.0);
    const Made made = make({wider}, bed);
    CHECK(made.seeds.count() == make({exact}, bed).seeds.count());
    check_volume(made, 3.0 * (4 + sliver) * (3 + sliver));
    for (const double depth : made.seeds.depth) CHECK(depth == Approx(3.0).epsilon(1e-14));
}

TEST_CASE("Material beyond the outer nodes is left out and said", "[particles]") {
    const Raster bed = flat_bed(21, 21, 5.0);
    const Release release = release_of({{{star({95, 50}, 40.0, 20.0, 6)}}}, 2.0);
    const double inside = area_in_box(*release.outline, 0, 0, 100, 100);
    for (const double each : {4.0, 3.1}) {
        const Made made = make({release}, bed, per_cell(each));
        check_volume(made, 2.0 * inside);
        CHECK(made.said("beyond the outer nodes"));
        CHECK(made.reports[0].clipped_volume ==
              Approx(2.0 * (std::abs(shoelace(release.outline->parts[0].rings[0])) - inside)).epsilon(1e-12));
        for (const double x : made.seeds.x) CHECK((x > 0.0 && x < 100.0));
    }
    CHECK_FALSE(make({release_of({{{star({50, 50}, 30, 20, 6)}}}, 2.0)}, bed).said("beyond"));
}

TEST_CASE("Map coordinates of millions of metres cost neither particles nor volume", "[particles]") {
    const double east = 512345.6, north = 5123456.7;
    Release near, far;
    near.depth_field = bumpy_depth({33, 29, 10.0, 12.5, 2.5});
    far.depth_field = near.depth_field;
    far.depth_field->geometry.x0 += east;
    far.depth_field->geometry.y0 += north;
    const Made here = make({near}, flat_bed(41, 41, 2.5));
    const Made there = make({far}, flat_bed(41, 41, 2.5, east, north));
    REQUIRE(there.seeds.count() == here.seeds.count());
    check_volume(there, volume_in_box(near, 0, 0, 100, 100));
}

TEST_CASE("Two releases keep their own records and velocities", "[particles][nan]") {
    Release first = release_of({{{rotated_square({30, 30}, 20, 0.1)}}}, 1.0);
    Release second = release_of({{{rotated_square({70, 60}, 25, 0.7)}}}, 2.0);
    first.velocity = Vec2(1.0, -2.0);
    second.velocity = Vec2(0.5, 0.25);
    second.velocity_x = Raster::filled({100, 100, 0.5, 0.5, 1.0}, Raster::nodata);
    for (Index j = 0; j < 100; ++j)
        for (Index i = 70; i < 100; ++i) second.velocity_x->at(i, j) = 7.0;
    const Made made = make({first, second}, flat_bed(101, 101, 1.0));
    REQUIRE(made.reports.size() == 2);
    CHECK(made.reports[0].count + made.reports[1].count == made.seeds.count());
    CHECK(made.reports[0].particle_volume == Approx(400.0).epsilon(1e-13));
    CHECK(made.reports[1].particle_volume == Approx(1250.0).epsilon(1e-13));
    for (Index p = 0; p < made.seeds.count(); ++p) {
        const bool is_first = p < made.reports[0].count;
        CHECK(made.seeds.vx[p] == (is_first ? 1.0 : made.seeds.x[p] >= 70.0 ? 7.0 : 0.5));
        CHECK(made.seeds.vy[p] == (is_first ? -2.0 : 0.25));
    }
    const std::string table = conservation_table(made.reports);
    CHECK(std::count(table.begin(), table.end(), '\n') == 4);
}

TEST_CASE("Overlapping parts of an outline count once and are said", "[particles]") {
    const Release release =
        release_of({{{{{10, 10}, {30, 10}, {30, 30}, {10, 30}}}}, {{{{20, 10}, {40, 10}, {40, 30}, {20, 30}}}}}, 1.0);
    const Made made = make({release}, flat_bed(51, 51, 1.0));
    CHECK(made.said("overlap on 200 m2"));
    CHECK(made.volume() == Approx(600.0).epsilon(1e-13));
    CHECK(made.reports[0].area == Approx(600.0).epsilon(1e-13));
}

TEST_CASE("An outline that reaches beyond its depth raster is said", "[particles]") {
    Release release = release_of_ring(rectangle_ring(10, 10, 30, 30), 0.0);
    release.depth_field = Raster::filled({10, 20, 10.5, 10.5, 1.0}, 1.0);
    release.depth_field->source = "depth.tif";
    CHECK(make({release}, flat_bed(51, 51, 1.0)).said("50 % of its outline has no depth in depth.tif"));
}

TEST_CASE("A release that cannot be is explained", "[particles][nan]") {
    const Raster bed = flat_bed(51, 51, 1.0);
    const auto square = [](double x) { return rectangle_ring(x, 10, x + 20, 30); };
    CHECK_THROWS_WITH(make({release_of_ring(square(1000), 1.0)}, bed),
                      Catch::Contains("release 1: no material of outline.geojson on the grid") &&
                          Catch::Contains("x 1000.00 to 1020.00"));
    CHECK_THROWS_WITH(make({release_of_ring(square(10), 0.0)}, bed), Catch::Contains("depth is 0 m"));
    CHECK_THROWS_WITH(make({release_of_ring({{10, 10}, {30, 30}, {30, 10}, {10, 29}}, 1.0)}, bed),
                      Catch::Contains("crosses itself") && Catch::Contains("ogr2ogr -makevalid"));
    CHECK_THROWS_WITH(make({release_of_ring({{10, 10}, {30, 30}, {30, 10}, {10, 30}}, 1.0)}, bed),
                      Catch::Contains("crosses itself"));  // no net area at all
    CHECK_THROWS_WITH(make({release_of({}, 1.0)}, bed), Catch::Contains("holds no polygon"));
    Raster holed = bed;
    holed.source = "dem.tif";
    holed.at(20, 20) = Raster::nodata;
    for (const Placement placement : {Placement::lattice, Placement::r2})
        CHECK_THROWS_WITH(make({release_of_ring(square(10), 1.0)}, holed, count_of(1600, placement)),
                          Catch::Contains("nodata of the elevation model dem.tif near pixel column"));
    CHECK_NOTHROW(make({release_of_ring(square(25), 1.0)}, holed));
}

TEST_CASE("The same release gives the same bits twice", "[particles]") {
    Release release = release_of({square_with_hole()}, 0.0);
    release.depth_field = bumpy_depth({40, 30, 15.0, 5.0, 2.3});
    for (const Placement placement : {Placement::lattice, Placement::r2, Placement::slope}) {
        const Made one = make({release}, flat_bed(61, 51, 2.0), count_of(3000, placement));
        const Made two = make({release}, flat_bed(61, 51, 2.0), count_of(3000, placement));
        CHECK(one.seeds.x == two.seeds.x);
        CHECK(one.seeds.y == two.seeds.y);
        CHECK(one.seeds.volume == two.seeds.volume);
        CHECK(one.seeds.depth == two.seeds.depth);
    }
}
