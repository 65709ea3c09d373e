// Agreement between cells, on figures whose answer is known.
#include <cmath>

#include "catch.h"
#include "compare/refinement.h"

using namespace frana;

namespace {

/// `depth` in [x0, x1] x [0, 40], on pixels whose edges start at (0, 0), 120 x 40 m.
Raster slab(double cell, double x0, double x1, double depth) {
    const auto nx = static_cast<Index>(std::lround(120.0 / cell)), ny = static_cast<Index>(std::lround(40.0 / cell));
    Raster raster = Raster::filled({nx, ny, 0.5 * cell, 0.5 * cell, cell}, 0.0);
    for (Index j = 0; j < ny; ++j)
        for (Index i = 0; i < nx; ++i)
            if (raster.geometry.x(i) > x0 && raster.geometry.x(i) < x1) raster.at(i, j) = depth;
    return raster;
}

/// Sums of a few hundred numbers.
Approx exactly(double value) { return Approx(value).epsilon(1e-12).margin(1e-12); }

/// A run that agrees with a finest one of runout 500 m, peaks 2 m and 20 m/s in everything.
CellFigures run_on(double cell) {
    CellFigures run;
    run.cell = cell;
    run.runout = 500.0;
    run.peak_depth = 2.0;
    run.peak_speed = 20.0;
    return run;
}

}  // namespace

TEST_CASE("Footprints on different grids are overlaid as their pixels lie", "[refinement]") {
    CHECK(footprints_iou(slab(10, 0, 60, 1), slab(2.5, 0, 60, 1), 0.1) == exactly(1.0));
    CHECK(footprints_iou(slab(10, 0, 60, 1), slab(2.5, 20, 80, 1), 0.1) == exactly(0.5));
    CHECK(footprints_iou(slab(10, 0, 60, 1), slab(4, 0, 40, 1), 0.1) == exactly(40.0 / 60.0));
    CHECK(footprints_iou(slab(10, 0, 60, 1), slab(4, 80, 120, 1), 0.1) == 0.0);
}

TEST_CASE("The share of a deposit that lies elsewhere is what would have to be moved", "[refinement]") {
    CHECK(share_elsewhere(slab(10, 0, 60, 1), slab(2.5, 0, 60, 1)) == exactly(0.0));
    CHECK(share_elsewhere(slab(10, 0, 60, 1), slab(2.5, 15, 75, 1)) == exactly(0.25));
    CHECK(share_elsewhere(slab(10, 0, 60, 1), slab(4, 0, 120, 0.5)) == exactly(0.5));
    CHECK(share_elsewhere(slab(10, 0, 60, 1), slab(4, 80, 120, 1)) == exactly(1.0));
    CHECK(std::isnan(share_elsewhere(slab(10, 0, 60, 0), slab(4, 80, 120, 1))));
    // Half of a coarse pixel's depth, on all of it: half lies where the finest has none. Its own pixel would not see that.
    CHECK(share_elsewhere(slab(10, 0, 10, 1), slab(2.5, 0, 5, 2)) == exactly(0.5));
    // A finer raster of a smaller window, shifted: what is not in it lies elsewhere.
    Raster window = slab(2.5, 0, 120, 1);
    window.geometry.x0 += 100.0;
    CHECK(share_elsewhere(slab(10, 80, 120, 2), window) == exactly(0.75));
}

TEST_CASE("A quantile is of the covered nodes only", "[refinement]") {
    Raster depth = slab(1, 0, 100, 1), speed = depth;  // 4000 covered nodes
    for (std::size_t k = 0; k < speed.values.size(); ++k) speed.values[k] = static_cast<double>(k % 120);
    CHECK(covered_quantile(speed, depth, 0.1, 1.0) == 99.0);
    CHECK(covered_quantile(speed, depth, 0.1, 0.99) == 98.0);
    CHECK(covered_quantile(speed, depth, 0.1, 0.5) == 49.0);
    CHECK(std::isnan(covered_quantile(speed, depth, 2.0, 0.5)));
}

TEST_CASE("The order of a power law is found, on any three cells; without one there is none", "[refinement]") {
    for (const double order : {0.5, 1.0, 2.0, 3.3})
        for (const auto& cells : {std::array<double, 3>{10, 5, 2.5}, std::array<double, 3>{10, 6, 5}}) {
            CAPTURE(order, cells[1]);
            std::array<double, 3> values{};
            for (std::size_t k = 0; k < 3; ++k) values[k] = 7.0 - 0.3 * std::pow(cells[k], order);
            const auto found = observed_order(cells, values, 0.0);
            REQUIRE(found);
            CHECK(*found == Approx(order).margin(1e-5));
        }
    CHECK_FALSE(observed_order({10, 5, 2.5}, {1.0, 2.0, 1.5}, 0.0));  // to and fro
    CHECK_FALSE(observed_order({10, 5, 2.5}, {1.0, 2.0, 4.0}, 0.0));  // away
    CHECK_FALSE(observed_order({10, 5, 2.5}, {1.0, 1.0, 1.0}, 0.0));
    CHECK_FALSE(observed_order({10, 5, 2.5}, {500.0, 496.0, 494.0}, 10.0));  // less than a cell
    CHECK_FALSE(observed_order({10, 5, 2.5}, {NAN, 496.0, 494.0}, 0.0));
}

TEST_CASE("Enough is the coarsest cell that agrees with the finest, as all between do", "[refinement]") {
    std::vector<CellFigures> runs = {run_on(20), run_on(10), run_on(5)};
    Verdict verdict = judge(runs);
    CHECK(verdict.converged);
    CHECK(verdict.enough == 20.0);
    runs[0].runout = 520.0;  // a cell of its own: allowed
    CHECK(judge(runs).enough == 20.0);
    runs[0].runout = 520.5;
    verdict = judge(runs);
    CHECK(verdict.converged);
    CHECK(verdict.enough == 10.0);
    CHECK(verdict.sentence ==
          "Converged, and cells of 10 m are enough: between them and 5 m the runout differs by 0 "
          "m, the footprints' IoU is 1.000, 0 % of the deposit lies elsewhere, the peak depth "
          "differs by 0 % and the peak speed differs by 0 %.");
    runs[0].runout = 500.0, runs[1].iou = 0.89;  // the coarsest agrees by chance
    verdict = judge(runs);
    CHECK_FALSE(verdict.converged);
    CHECK_FALSE(verdict.enough);
    CHECK(verdict.sentence ==
          "Not converged: between cells of 10 and 5 m the footprints' IoU is 0.890 (expected 0.9 "
          "or more); add a finer cell, such as 2.5 m.");
}

TEST_CASE("Each part of the rule is required", "[refinement]") {
    const auto converged_with = [](double CellFigures::*figure, double value) {
        std::vector<CellFigures> runs = {run_on(10), run_on(5)};
        runs[0].*figure = value;
        return judge(runs).converged;
    };
    CHECK(converged_with(&CellFigures::iou, 0.9));
    CHECK_FALSE(converged_with(&CellFigures::iou, 0.899));
    CHECK(converged_with(&CellFigures::elsewhere, 0.1));
    CHECK_FALSE(converged_with(&CellFigures::elsewhere, 0.101));
    CHECK(converged_with(&CellFigures::peak_depth, 2.09));
    CHECK_FALSE(converged_with(&CellFigures::peak_depth, 2.11));
    CHECK(converged_with(&CellFigures::peak_speed, 19.1));
    CHECK_FALSE(converged_with(&CellFigures::peak_speed, 18.9));
    CHECK_FALSE(converged_with(&CellFigures::runout, NAN));
}

TEST_CASE("A bed of which one cell takes more than another has not converged", "[refinement]") {
    std::vector<CellFigures> runs = {run_on(10), run_on(5)};
    const auto with = [&](double coarse, double fine) {
        runs[0].eroded_volume = coarse, runs[1].eroded_volume = fine;
        return judge(runs);
    };
    CHECK(with(1099.0, 1000.0).converged);
    CHECK(with(0.0, 0.0).converged);
    const Verdict verdict = with(1200.0, 1000.0);
    CHECK_FALSE(verdict.converged);
    CHECK_THAT(verdict.sentence,
               Catch::Contains("the volume taken of the bed differs by 20 % (expected 10 % at most)"));
    CHECK_FALSE(with(1.0, 0.0).converged);
}

TEST_CASE("Where no run has a runout the rule goes without, and says so", "[refinement]") {
    std::vector<CellFigures> runs = {run_on(10), run_on(5)};
    runs[0].runout = runs[1].runout = NAN;
    Verdict verdict = judge(runs);
    CHECK(verdict.converged);
    CHECK(verdict.sentence ==
          "Converged, and cells of 10 m are enough: between them and 5 m the footprints' IoU is 1.000, 0 % of the "
          "deposit lies elsewhere, the peak depth differs by 0 % and the peak speed differs by 0 %. Runouts are not "
          "known and were left out.");
    runs[0].iou = 0.89;
    CHECK(judge(runs).sentence ==
          "Not converged: between cells of 10 and 5 m the footprints' IoU is 0.890 (expected 0.9 or more); add a finer "
          "cell, such as 2.5 m. Runouts are not known and were left out.");
    const std::string spread = spread_sentence("scheme.cfl", {0.2, 0.5}, runs);
    CHECK(spread.find("m runouts are not known; up to") != std::string::npos);
    runs[0].runout = 500.0, runs[0].iou = 1.0;
    verdict = judge(runs);
    CHECK_FALSE(verdict.converged);
    CHECK(verdict.sentence.find("the runout is known on one of them only (expected") != std::string::npos);
}

TEST_CASE("Runs that differ in one key are said to lie apart by as many cells as their runouts do", "[refinement]") {
    std::vector<CellFigures> runs = {run_on(5.0), run_on(5.0), run_on(5.0)};
    runs[1].runout = 504.0, runs[2].iou = 0.93, runs[0].elsewhere = 0.06;
    CHECK(runout_spread(runs) == exactly(0.8));
    const std::string agree = spread_sentence("particles.per_cell", {4, 9, 16}, runs);
    CHECK(agree ==
          "With particles.per_cell of 4, 9 and 16 on cells of 5 m the runouts lie 0.8 cells apart; up to 6 % of the "
          "deposit lies elsewhere, and the footprints' IoU is 0.930 or more.");
    runs[2].runout = 489.5;
    CHECK(runout_spread(runs) == exactly(2.9));
    CHECK(spread_sentence("scheme.cfl", {0.1, 0.2, 0.5}, runs).find("2.9 cells apart (expected 1 at most") !=
          std::string::npos);
    runs[1].runout = std::nan("");
    CHECK(std::isnan(runout_spread(runs)));
}
