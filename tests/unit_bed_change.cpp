// A simulated change of the ground against a surveyed one, with answers found by hand.
#include <cmath>

#include "base/error.h"
#include "catch.h"
#include "compare/comparison.h"

using namespace frana;

namespace {

constexpr double cell = 10.0, pixel = 100.0;

template <class Value>
Raster made(const GridGeometry& g, const Value& value) {
    Raster raster = Raster::filled(g, 0.0);
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i) raster.at(i, j) = value(i, j);
    return raster;
}

GridGeometry row(Index n) { return {n, 1, 0.5 * cell, 0.5 * cell, cell}; }

/// Values of one row of pixels.
Raster of(const std::vector<double>& values) {
    return made(row(static_cast<Index>(values.size())), [&](Index i, Index) { return values[std::size_t(i)]; });
}

}  // namespace

TEST_CASE("Volumes of both, what is misplaced, and the errors follow from the pixels", "[compare][bed_change]") {
    //                    agree, too little, opposite, ours alone, theirs alone, noise, noise of one
    const Raster ours = of({-1.0, -0.5, 0.5, 2.0, 0.0, 0.05, -0.05});
    const Raster theirs = of({-1.0, -1.5, -0.5, 0.05, 1.0, -0.1, 0.4});
    const BedChangeErrors e = bed_change_errors(ours, theirs, 0.1);
    CHECK(e.simulated.eroded == Approx(1.5 * pixel));
    CHECK(e.simulated.deposited == Approx(2.5 * pixel));
    CHECK(e.surveyed.eroded == Approx(3.0 * pixel));
    CHECK(e.surveyed.deposited == Approx(1.4 * pixel));
    CHECK(e.eroded_error() == Approx(-0.5));
    CHECK(e.deposited_error() == Approx(1.1 / 1.4));
    CHECK(e.within_noise.eroded == Approx(0.05 * pixel));
    CHECK(e.within_noise.deposited == Approx(0.05 * pixel));
    CHECK(e.misplaced == Approx((1.0 + 2.0 + 1.0 + 0.4) * pixel));
    CHECK(e.misplaced_share() == Approx(4.4 / 4.4));
    CHECK(e.compared_area == Approx(6 * pixel));
    const double differences[] = {0.0, 1.0, 1.0, 1.95, 1.0, 0.45};
    double sum = 0.0, square = 0.0;
    for (const double d : differences) sum += d, square += d * d;
    CHECK(e.mae == Approx(sum / 6));
    CHECK(e.rmse == Approx(std::sqrt(square / 6)));
}

TEST_CASE("The misplaced share is 0 for the survey itself, 1 for no change, 2 for the same change elsewhere",
          "[compare][bed_change]") {
    const Raster theirs = of({-1.0, 0.0, 0.5, 0.0}), elsewhere = of({0.0, -1.0, 0.0, 0.5});
    CHECK(bed_change_errors(theirs, theirs, 0.1).misplaced_share() == 0.0);
    CHECK(bed_change_errors(theirs, theirs, 0.1).mae == 0.0);
    CHECK(bed_change_errors(of({0, 0, 0, 0}), theirs, 0.1).misplaced_share() == Approx(1.0));
    CHECK(bed_change_errors(elsewhere, theirs, 0.1).misplaced_share() == Approx(2.0));
    const BedChangeErrors none = bed_change_errors(of({0, 0, 0, 0}), of({0, 0, 0.1, 0}), 0.1);
    CHECK((std::isnan(none.misplaced_share()) && std::isnan(none.mae) && std::isnan(none.eroded_error())));
}

TEST_CASE("What was not surveyed, lies outside of the run or in the release stands apart", "[compare][bed_change]") {
    const Raster bed = of({-1.0, -2.0, 0.0, -1.0}), lying = of({0.0, 0.5, 3.0, NAN}),
                 arrival = of({0.0, 5.0, 9.0, NAN});
    const Raster seen = surface_change(bed, &lying, &arrival);
    CHECK(std::isnan(seen.at(0, 0)));
    CHECK((seen.at(1, 0) == -1.5 && seen.at(2, 0) == 3.0 && seen.at(3, 0) == -1.0));
    CHECK(surface_change(bed, nullptr, nullptr).values == bed.values);
    const Raster later = of({0.0, 1.0, 0.0, 0.0});
    const Raster without = surface_change(bed, &lying, &arrival, &later);
    CHECK((std::isnan(without.at(0, 0)) && std::isnan(without.at(1, 0)) && without.at(2, 0) == 3.0));
    // The survey has a pixel more to the west, where the run has none.
    Raster theirs = made({5, 1, -0.5 * cell, 0.5 * cell, cell}, [](Index, Index) { return -1.0; });
    theirs.at(4, 0) = NAN;
    const BedChangeErrors e = bed_change_errors(seen, theirs, 0.1);
    CHECK(e.release.eroded == Approx(pixel));
    CHECK(e.unsurveyed.eroded == Approx(pixel));
    CHECK(e.surveyed.eroded == Approx(3 * pixel));
    CHECK((e.simulated.eroded == Approx(1.5 * pixel) && e.simulated.deposited == Approx(3 * pixel)));
    CHECK(e.misplaced == Approx((4.0 + 1.0) * pixel));
}

TEST_CASE("Along a path the steps hold all volumes, each where its nearest point lies", "[compare][bed_change]") {
    const GridGeometry g{20, 5, 0.5 * cell, 0.5 * cell, cell};  // 200 x 50 m
    const Raster ours = made(g, [](Index i, Index) { return i < 10 ? -1.0 : 0.0; });
    const Raster theirs = made(g, [](Index i, Index) { return i >= 10 ? 0.5 : 0.0; });
    const Polyline path = {{20, 25}, {20, 25}, {160, 25}};  // with a point twice, 140 m
    const auto steps = bed_change_along(path, ours, theirs, 0.1);
    REQUIRE(steps.size() == 7);
    BedVolumes simulated, surveyed;
    for (std::size_t k = 0; k < steps.size(); ++k) {
        CHECK(steps[k].distance == Approx(20.0 * double(k) + 10.0));
        CHECK((steps[k].point.x() == Approx(30.0 + 20.0 * double(k)) && steps[k].point.y() == Approx(25.0)));
        simulated.eroded += steps[k].simulated.eroded, surveyed.deposited += steps[k].surveyed.deposited;
    }
    CHECK(steps[0].simulated.eroded == Approx(4 * 5 * pixel));          // two columns of its own, and two before it
    CHECK(steps[6].surveyed.deposited == Approx(0.5 * 6 * 5 * pixel));  // two of its own, and four beyond it
    const BedChangeErrors all = bed_change_errors(ours, theirs, 0.1);
    CHECK(simulated.eroded == Approx(all.simulated.eroded));
    CHECK(surveyed.deposited == Approx(all.surveyed.deposited));
    CHECK(bed_change_along({{0, 0}}, ours, theirs, 0.1).empty());
}

TEST_CASE("A comparison scores changes of the ground when run and survey have them, and says what is left out",
          "[compare][bed_change]") {
    const GridGeometry g{20, 5, 0.5 * cell, 0.5 * cell, cell};
    const Raster peak = made(g, [](Index i, Index) { return i > 1 && i < 15 ? 1.0 : 0.0; });
    const Raster change = made(g, [](Index i, Index) { return i > 4 && i < 8 ? -0.5 : 0.0; });
    Survey survey;
    survey.footprint = {{Polygon{{{{0, 0}, {100, 0}, {100, 50}, {0, 50}}}}}, "", "survey.geojson"};
    survey.path = Polyline{{0, 25}, {200, 25}};
    survey.bed_change = made(g, [](Index i, Index) { return i > 5 && i < 8 ? -0.5 : i == 5 ? NAN : 0.0; });
    survey.bed_change_source = "dod.tif";
    SimulatedRun run;
    run.peak_depth = &peak;
    CHECK_FALSE(compare(run, survey).bed_change);  // a bed of rock
    run.bed_change = &change;
    const Comparison c = compare(run, survey);
    REQUIRE(c.bed_change);
    CHECK(c.bed_change->eroded_error() == 0.0);
    CHECK(c.bed_change_steps.size() == 10);
    CHECK(c.bed_change_source == "dod.tif");
    REQUIRE(c.remarks.size() == 1);
    CHECK_THAT(c.remarks[0],
               Catch::Contains("250 m3 of the simulated changes of the bed lie where dod.tif has no data"));
    survey.bed_change_noise = 0.6;
    const Comparison quiet = compare(run, survey);
    REQUIRE(quiet.remarks.size() == 1);
    CHECK_THAT(quiet.remarks[0], Catch::Contains("dod.tif changes nowhere by more than 0.6 m"));
}
