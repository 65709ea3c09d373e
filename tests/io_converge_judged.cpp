// The judgement of a study on several cells, on run folders whose answer is known.
#include <fmt/core.h>

#include <filesystem>
#include <vector>

#include "base/atomic_file.h"
#include "base/error.h"
#include "catch.h"
#include "fresh_folder.h"
#include "run/converge/study.h"
#include "run/folder/products.h"

namespace fs = std::filesystem;
using Catch::Contains;
using namespace frana;

namespace {

constexpr double kBegin = 20.0, kReleased = 40.0, kLength = 160.0, kWidth = 60.0;  // [m]

/// Pixels whose edges start at (0, 0), with a number of each one's middle.
template <class Number>
Raster raster_of(double cell, const Number& number) {
    const auto nx = static_cast<Index>(kLength / cell), ny = static_cast<Index>(kWidth / cell);
    Raster raster = Raster::filled({nx, ny, 0.5 * cell, 0.5 * cell, cell}, 0.0);
    for (Index j = 0; j < ny; ++j)
        for (Index i = 0; i < nx; ++i) raster.at(i, j) = number(raster.geometry.x(i), raster.geometry.y(j));
    return raster;
}

/// The ground falls along x alone, and so does the steepest path.
Raster bed_of(double cell) {
    return raster_of(cell, [](double x, double) { return 100.0 - 0.5 * x; });
}

/// The folder of a run whose flow, 20 m wide, came from kBegin to `front`. What lies there at the end begins at 60 m.
void leave_run(const fs::path& folder, double cell, double front, const char* end = "rest", double left = 0.0) {
    const auto slab = [&](double from, double to, double inside, double outside) {
        return raster_of(
            cell, [=](double x, double y) { return x > from && x < to && y > 20.0 && y < 40.0 ? inside : outside; });
    };
    Raster arrival = slab(kBegin, front, 5.0, Raster::nodata);
    const Raster released = slab(kBegin, kReleased, 1.0, 0.0);
    for (std::size_t k = 0; k < arrival.values.size(); ++k)
        if (released.values[k] > 0.0) arrival.values[k] = 0.0;
    write_rasters(folder,
                  {elevation_raster(bed_of(cell)),
                   {"peak_depth", "m", "", slab(kBegin, front, 2.0, 0.0)},
                   {"peak_speed", "m/s", "", slab(kBegin, front, 20.0, 0.0)},
                   {"final_depth", "m", "", slab(60.0, front, 1.0, 0.0)},
                   {"arrival_time", "s", "", arrival}},
                  "a slab");
    write_text(
        folder / "run.json",
        fmt::format(
            R"({{"title": "slab", "exit_reason": "{}", "flow_width_cells": {}, "results": )"
            R"({{"footprint_depth": 0.1}}, "wall_seconds": {{"total": 3.5}}, "budgets": {{"mass": {{"left_share": {}}}}}}})",
            end, 20.0 / cell, left));
}

/// A study of the folders cell_N.
ConvergenceStudy study_of(const fs::path& folder, const std::vector<double>& cells) {
    ConvergenceStudy study;
    study.folder = folder;
    for (const double cell : cells) study.runs.push_back({cell, folder / fmt::format("cell_{}", cell)});
    return study;
}

}  // namespace

TEST_CASE("A study measures its runs along one path, and finds the coarsest cell that agrees", "[converge]") {
    const FreshFolder folder;
    leave_run(folder.path() / "cell_10", 10.0, 140.0, "end");
    leave_run(folder.path() / "cell_5", 5.0, 120.0);
    leave_run(folder.path() / "cell_2.5", 2.5, 120.0);
    ConvergenceStudy study = study_of(folder.path(), {10.0, 5.0, 2.5});
    measure_runs(study, bed_of(2.5));
    REQUIRE(study.figures.size() == 3);
    CHECK(study.title == "slab");
    const CellFigures &coarse = study.figures[0], &middle = study.figures[1], &finest = study.figures[2];
    // From the released node nearest to the middle of the release, at 30 m, to the front.
    CHECK(finest.runout == Approx(90.0).margin(2.5));
    CHECK(middle.runout == Approx(finest.runout).epsilon(1e-9));
    CHECK(coarse.runout - finest.runout == Approx(20.0).epsilon(1e-9));
    // All edges lie between pixels: areas are exact.
    CHECK(finest.footprint_area == Approx(100.0 * 20.0));
    CHECK(coarse.iou == Approx(100.0 / 120.0));
    CHECK(middle.iou == Approx(1.0));
    CHECK(coarse.elsewhere == Approx(1.0 - 60.0 / 80.0));
    CHECK(coarse.deposit_volume == Approx(80.0 * 20.0));
    CHECK(middle.peak_speed == Approx(20.0));
    CHECK(middle.cells_across == 4.0);
    CHECK(middle.seconds == 3.5);
    CHECK(study.ends == std::vector<std::string>{"end", "rest", "rest"});
    REQUIRE(study.remarks.size() == 1);
    CHECK_THAT(study.remarks[0], Contains("on cells of 10 m the simulated time ended the run"));
    CHECK(study.verdict.converged);
    REQUIRE(study.verdict.enough);
    CHECK(*study.verdict.enough == 5.0);
}

TEST_CASE("A study whose last two runs lie two cells apart has not converged", "[converge]") {
    const FreshFolder folder;
    leave_run(folder.path() / "cell_5", 5.0, 130.0);
    leave_run(folder.path() / "cell_2.5", 2.5, 120.0);
    ConvergenceStudy study = study_of(folder.path(), {5.0, 2.5});
    measure_runs(study, bed_of(2.5));
    CHECK_FALSE(study.verdict.converged);
    CHECK_FALSE(study.verdict.enough);
}

TEST_CASE("Runouts that agree at the edge of the terrain are no evidence of convergence", "[converge]") {
    const FreshFolder folder;
    const auto verdict_with = [&](double left) {
        leave_run(folder.path() / "cell_5", 5.0, 160.0, "rest", left);
        leave_run(folder.path() / "cell_2.5", 2.5, 160.0, "rest", left);
        ConvergenceStudy study = study_of(folder.path(), {5.0, 2.5});
        measure_runs(study, bed_of(2.5));
        return study;
    };
    CHECK(verdict_with(0.0).verdict.converged);
    CHECK(verdict_with(1e-3).verdict.converged);  // as in an ensemble: more than a thousandth
    const ConvergenceStudy study = verdict_with(0.4);
    CHECK_FALSE(study.verdict.converged);
    CHECK_FALSE(study.verdict.enough);
    CHECK_THAT(study.verdict.sentence, Contains("It is not known whether") && Contains("On this terrain alone: "));
    REQUIRE_FALSE(study.remarks.empty());
    CHECK_THAT(study.remarks[0], Contains("40 % on 5 m, 40 % on 2.5 m left the terrain"));
}

TEST_CASE("A study takes the straight reach where its path ends before the fronts", "[converge]") {
    const FreshFolder folder;
    leave_run(folder.path() / "cell_5", 5.0, 120.0);
    leave_run(folder.path() / "cell_2.5", 2.5, 120.0);
    Raster bed = bed_of(2.5);
    for (Index j = 0; j < bed.geometry.ny; ++j)
        for (Index i = 0; i < bed.geometry.nx; ++i)
            if (bed.geometry.x(i) > 80.0) bed.at(i, j) = Raster::nodata;  // an edge, at which paths end
    ConvergenceStudy study = study_of(folder.path(), {5.0, 2.5});
    measure_runs(study, bed);
    REQUIRE(study.remarks.size() == 1);
    // From 78.75 m, the last node with ground, to the edge of the last pixel of the flow.
    CHECK_THAT(study.remarks[0],
               Contains("the path ends 41.25 m before the farther front and goes on straight there; so "
                        "the straight reach counts as the runout"));
    for (const CellFigures& f : study.figures) CHECK(f.runout == f.reach);
    CHECK_THAT(study_section(study), Contains("| straight reach [m] |") && !Contains("along the path [m]"));
    ConvergenceStudy whole = study_of(folder.path(), {5.0, 2.5});
    measure_runs(whole, bed_of(2.5));
    CHECK(whole.remarks.empty());
    CHECK_THAT(study_section(whole), Contains("| runout along the path [m] |"));
}

TEST_CASE("A study says which file of a run it lacks", "[converge]") {
    const FreshFolder folder;
    leave_run(folder.path() / "cell_10", 10.0, 120.0);
    leave_run(folder.path() / "cell_5", 5.0, 120.0);
    const auto complaint = [&] {
        ConvergenceStudy study = study_of(folder.path(), {10.0, 5.0});
        try {
            measure_runs(study, bed_of(5.0));
        } catch (const UserError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    CHECK(complaint().empty());
    fs::remove(folder.path() / "cell_10" / "rasters" / "final_depth.tif");
    CHECK_THAT(complaint(), Contains("cell_10/rasters/final_depth.tif: is not there"));
    fs::remove(folder.path() / "cell_10" / "run.json");
    CHECK_THAT(complaint(), Contains("cell_10/run.json: has no \"results\""));
}
