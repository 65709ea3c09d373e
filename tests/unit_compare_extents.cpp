// Extents and outlines of known areas and distances.
#include <algorithm>
#include <cmath>
#include <random>

#include "catch.h"
#include "compare/nearest.h"
#include "compare/overlap.h"
#include "compare/union_area.h"

using namespace frana;

namespace {

constexpr double cell = 5.0;

/// 200 x 160 m; the pixels' outer edge starts at (0, 0).
GridGeometry field_grid() { return {40, 32, 0.5 * cell, 0.5 * cell, cell}; }

/// 1 m deep in [x0, x1] x [y0, y1], whole pixels.
Raster flooded(double x0, double y0, double x1, double y1) {
    Raster raster = Raster::filled(field_grid(), 0.0);
    const GridGeometry& g = raster.geometry;
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i)
            if (g.x(i) > x0 && g.x(i) < x1 && g.y(j) > y0 && g.y(j) < y1) raster.at(i, j) = 1.0;
    return raster;
}

std::vector<Vec2> box(double x0, double y0, double x1, double y1) { return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}; }

Rings survey_of(const std::vector<Polygon>& parts) { return rings_of({parts, "", ""}); }

/// Sums of at most 1280 areas of 25 m2 in double precision.
Approx exactly(double value) { return Approx(value).epsilon(1e-12).margin(1e-9); }

}  // namespace

TEST_CASE("A survey that is the simulated extent scores 1 everywhere, and its outline lies at no distance") {
    const Raster depth = flooded(20, 30, 120, 130);
    const Rings survey = survey_of({Polygon{{box(20, 30, 120, 130)}}});
    const Overlap areas = overlap(depth, 0.1, survey);
    CHECK(areas.hit == exactly(1e4));
    CHECK(areas.beyond == exactly(0));
    CHECK(areas.missed == exactly(0));
    CHECK(areas.missed_outside == 0.0);
    for (const double one : {areas.iou(), areas.precision(), areas.recall(), areas.f1(), areas.area_ratio()})
        CHECK(one == exactly(1));
    CHECK(areas.area_difference_percent() == exactly(0));
    CHECK(areas.symmetric_difference_percent() == exactly(0));
    const OutlineDistance distance = distance_between(pixel_outline(depth, 0.1), survey, 1.25);
    CHECK(distance.mean == exactly(0));
    CHECK(distance.max == exactly(0));
}

TEST_CASE("Extents apart share nothing, though their areas are the same") {
    const Overlap areas = overlap(flooded(0, 0, 50, 50), 0.1, survey_of({Polygon{{box(100, 100, 150, 150)}}}));
    CHECK(areas.hit == 0.0);
    CHECK(areas.beyond == exactly(2500));
    CHECK(areas.missed == exactly(2500));
    CHECK(areas.iou() == 0.0);
    CHECK(areas.precision() == 0.0);
    CHECK(areas.recall() == 0.0);
    CHECK(areas.area_difference_percent() == exactly(0));
    CHECK(areas.symmetric_difference_percent() == exactly(200));
}

TEST_CASE("A square of 100 m moved by 20 m has IoU 2/3 and outlines 10 m apart on average") {
    const Raster depth = flooded(20, 30, 120, 130);
    const Rings survey = survey_of({Polygon{{box(40, 30, 140, 130)}}});
    const Overlap areas = overlap(depth, 0.1, survey);
    CHECK(areas.hit == exactly(8000));
    CHECK(areas.iou() == exactly(2.0 / 3.0));
    CHECK(areas.precision() == exactly(0.8));
    CHECK(areas.recall() == exactly(0.8));
    CHECK(areas.f1() == exactly(0.8));
    // By hand, per square: the side that leads or trails alone 100 x 20, the one inside the other square
    // 60 x 20 + 2 x 20^2 / 2, the ends of the two others 2 x 20^2 / 2; together 4000 m2 over 400 m. The steps end
    // where these distances change their slope, so their midpoints are exact.
    const OutlineDistance distance = distance_between(pixel_outline(depth, 0.1), survey, 1.25);
    CHECK(distance.mean == exactly(10));
    CHECK(distance.p95 == exactly(20));  // 40 % of the length lies just there
    CHECK(distance.max == exactly(20));
}

TEST_CASE("Distances are taken both ways: a small square in the middle of a large one") {
    const Rings small = {box(40, 40, 60, 60)}, large = {box(0, 0, 100, 100)};
    const double step = 1.25;
    for (const OutlineDistance& distance :
         {distance_between(small, large, step), distance_between(large, small, step)}) {
        // 40 m from each point of the small one; from the large one 40 m over 20 m of each side, and beyond that
        // sqrt(40^2 + d^2), whose integral over d from 0 to 40 is 800 (sqrt 2 + ln(1 + sqrt 2)).
        const double slanting = 800.0 * (std::sqrt(2.0) + std::log(1.0 + std::sqrt(2.0)));
        const double exact = (80.0 * 40.0 + 4.0 * (20.0 * 40.0 + 2.0 * slanting)) / (80.0 + 400.0);
        // midpoint rule: step^2 / 24 times the largest second derivative, 1/40
        CHECK(distance.mean == Approx(exact).margin(step * step / 24.0 / 40.0));
        CHECK(distance.max == Approx(40.0 * std::sqrt(2.0)).margin(0.5 * step));  // a corner, half a step off
        CHECK(distance.p95 < distance.max);
        CHECK(distance.p95 > 40.0);
    }
}

TEST_CASE("The area of slanting edges in pixels is exact") {
    const Rings triangle = survey_of({Polygon{{{{0, 0}, {100, 0}, {0, 100}}}}});
    const Overlap areas = overlap(flooded(0, 0, 80, 80), 0.1, triangle);
    CHECK(areas.hit == exactly(6400 - 60 * 60 / 2));
    CHECK(areas.beyond == exactly(60 * 60 / 2));
    CHECK(areas.surveyed() == exactly(5000));
    const Rings shifted_box = survey_of({Polygon{{box(1.7, 2.3, 61.7, 42.3)}}});
    const Overlap shifted = overlap(flooded(0, 0, 100, 100), 0.1, shifted_box);
    CHECK(shifted.hit == exactly(2400));
}

TEST_CASE("Holes are missing from the survey and parts add up, whichever way their rings run") {
    std::vector<Polygon> parts = {Polygon{{box(0, 0, 100, 100), box(30, 30, 70, 70)}},
                                  Polygon{{box(150, 110, 170, 130)}}};
    const Raster depth = flooded(0, 0, 100, 100);
    for (int way = 0; way < 2; ++way) {
        const Overlap areas = overlap(depth, 0.1, survey_of(parts));
        CHECK(areas.hit == exactly(8400));
        CHECK(areas.beyond == exactly(1600));
        CHECK(areas.missed == exactly(400));
        CHECK(areas.missed_outside == 0.0);
        for (Polygon& part : parts)
            for (auto& ring : part.rings) std::reverse(ring.begin(), ring.end());
    }
}

TEST_CASE("What several polygons cover is counted once, holes apart, wherever they lie on the map") {
    const Vec2 far(612345.6, 5212345.6);
    const auto at_far = [&](std::vector<Polygon> parts) {
        for (Polygon& part : parts)
            for (auto& ring : part.rings)
                for (Vec2& corner : ring) corner += far;
        return survey_of(parts);
    };
    const Polygon square{{box(0, 0, 100, 100)}}, next{{box(80, -20, 180, 60)}},
        holed{{box(0, 0, 100, 100), box(20, 20, 60, 60)}};
    constexpr double kDigits = 1e-9;  // of corners there, to 1e-9 m
    const auto once = [&](double value) { return Approx(value).epsilon(kDigits); };
    CHECK(union_area(at_far({square})) == once(1e4));
    CHECK(union_area(at_far({square, square})) == once(1e4));
    CHECK(union_area(at_far({square, next})) == once(1e4 + 8e3 - 20 * 60));
    CHECK(union_area(at_far({holed})) == once(1e4 - 1600));
    CHECK(union_area(at_far({holed, Polygon{{box(30, 30, 40, 140)}}})) == once(1e4 - 1600 + 10 * 30 + 10 * 40));
    // A diamond whose corners stick out of a square by 20 m each, in triangles as wide as twice that.
    const Polygon diamond{{{{50, -20}, {120, 50}, {50, 120}, {-20, 50}}}};
    CHECK(union_area(at_far({square, diamond})) == once(1e4 + 4 * 20 * 20));
    CHECK(union_area({}) == 0.0);
}

TEST_CASE("What is surveyed outside the raster is missed, and told apart") {
    const Overlap areas = overlap(flooded(0, 0, 70, 100), 0.1, survey_of({Polygon{{box(-30, -20, 70, 100)}}}));
    CHECK(areas.hit == exactly(7000));
    CHECK(areas.beyond == exactly(0));
    CHECK(areas.missed == exactly(12000 - 7000));
    CHECK(areas.missed_outside == exactly(5000));
    CHECK(areas.recall() == exactly(7.0 / 12.0));
}

TEST_CASE("Depths at the limit and nodata are not covered", "[nan]") {
    Raster depth = flooded(0, 0, 10, 5);
    depth.at(0, 0) = 0.1;
    depth.at(5, 5) = Raster::nodata;
    CHECK(overlap(depth, 0.1, survey_of({Polygon{{box(0, 0, 50, 50)}}})).hit == exactly(25));
    CHECK(pixel_outline(depth, 0.1).size() == 1);
}

TEST_CASE("Outlines of pixels enclose their area: corners, holes, pixels that touch at a corner") {
    Raster depth = flooded(10, 10, 60, 60);
    depth.at(5, 5) = 0.0;  // a hole
    Rings rings = pixel_outline(depth, 0.1);
    REQUIRE(rings.size() == 2);
    CHECK(rings[0].size() == 4);
    CHECK(ring_area(rings[0]) == exactly(2500));
    CHECK(ring_area(rings[1]) == exactly(-25));
    CHECK(area_of(rings) == exactly(2475));

    depth = Raster::filled(field_grid(), 0.0);
    depth.at(3, 3) = depth.at(4, 4) = 1.0;
    rings = pixel_outline(depth, 0.1);
    REQUIRE(rings.size() == 2);
    for (const auto& ring : rings) CHECK(ring_area(ring) == exactly(25));

    depth = Raster::filled(field_grid(), 1.0);  // up to the raster's edge
    rings = pixel_outline(depth, 0.1);
    REQUIRE(rings.size() == 1);
    CHECK(area_of(rings) == exactly(200 * 160));
}

TEST_CASE("Random pixels: the outline's area is theirs, and it lies at no distance from itself") {
    std::mt19937 random(7);
    Raster depth = Raster::filled(field_grid(), 0.0);
    int wet = 0;
    for (double& h : depth.values) wet += (h = random() % 2 ? 1.0 : 0.0) > 0.0;
    const Rings rings = pixel_outline(depth, 0.1);
    CHECK(area_of(rings) == exactly(wet * cell * cell));
    CHECK(distance_between(rings, rings, 1.0).max == exactly(0));
    const Overlap areas = overlap(depth, 0.1, rings);
    CHECK(areas.iou() == exactly(1));
}

TEST_CASE("The nearest edge is found among many, from inside, outside and far away") {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> place(0.0, 1000.0), anywhere(-3000.0, 4000.0);
    Rings rings;
    for (int k = 0; k < 40; ++k) {
        const Vec2 centre(place(random), place(random));
        rings.push_back({centre, centre + Vec2(0.2 * place(random), 3.0), centre + Vec2(1.0, 0.05 * place(random))});
    }
    const NearestOnRings nearest(rings);
    for (int k = 0; k < 300; ++k) {
        const Vec2 p = k % 2 ? Vec2(place(random), place(random)) : Vec2(anywhere(random), anywhere(random));
        double best = INFINITY;
        for (const auto& ring : rings)
            for (std::size_t m = 0; m < 3; ++m) {
                const Vec2 a = ring[m], b = ring[(m + 1) % 3];
                best = std::min(best, (p - a - nearest_fraction(a, b, p) * (b - a)).norm());
            }
        CHECK(nearest.distance(p) == Approx(best).epsilon(1e-12));
    }
}

TEST_CASE("Without an extent there are no distances, and scores that need one are not numbers", "[nan]") {
    const Raster dry = Raster::filled(field_grid(), 0.0);
    const Rings survey = survey_of({Polygon{{box(0, 0, 50, 50)}}});
    CHECK(std::isnan(distance_between(pixel_outline(dry, 0.1), survey, 1.0).mean));
    const Overlap areas = overlap(dry, 0.1, survey);
    CHECK(std::isnan(areas.precision()));
    CHECK(areas.iou() == 0.0);
    CHECK(areas.area_difference_percent() == exactly(100));
}
