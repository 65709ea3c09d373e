// What a calibration says to people, of runs whose distances from the survey are given.
#include <string>
#include <vector>

#include "catch.h"
#include "run/calibrate/results.h"

using namespace frana;
using Catch::Contains;

namespace {

/// Points of one key, whose outlines are so far from the surveyed one [m] in one place; the standard deviation is 20 m.
Calibration calibration_of(const std::vector<double>& distances) {
    Calibration c{{}, Posterior(1, 1), std::vector<EventFit>(1)};
    c.plan.samples = static_cast<Index>(distances.size());
    c.plan.vary.push_back({"material.bed.mu", {}, "", 0, {}});
    SurveyedEvent& event = c.plan.events.emplace_back();
    event.name = "slope", event.objective = {Evidence::outline}, event.errors.outline = 20.0;
    for (const double distance : distances) {
        EventScores& scores = c.fits[0].scores.emplace_back();
        scores.boundary = distance;
        scores.misfits[static_cast<std::size_t>(Evidence::outline)] = Misfit{distance, 1.0};
        c.fits[0].left_share.push_back(0.0);
        c.fits[0].log_likelihood.push_back(log_likelihood(scores, event.objective, event.errors));
    }
    const auto points = c.posterior.next(c.plan.samples);
    c.posterior.add(points, c.fits[0].log_likelihood);
    return c;
}

constexpr const char* no_fit = "does not reach the survey";
constexpr const char* no_spread = "Fewer than 5 have no spread";

}  // namespace

TEST_CASE("A calibration says so where its best run is far from the survey", "[ensemble]") {
    Calibration c = calibration_of(std::vector<double>(16, 405.0));
    CHECK_THAT(calibration_section(c),
               Contains("slope: the best run is 20 sigma off in outline. The model with these keys does not reach"));
    CHECK_THAT(calibration_section(calibration_of(std::vector<double>(16, 59.0))), !Contains(no_fit));
    // An optimum beyond the points may reach it.
    c.optimum = Optimum{{0.5}, 0.5, {}, 1, "there", c.fits[0].scores};
    c.optimum->scores.resize(1);
    CHECK_THAT(calibration_section(c), Contains(no_fit));
    c.optimum->scores[0].misfits[static_cast<std::size_t>(Evidence::outline)]->rms = 20.0;
    CHECK_THAT(calibration_section(c), !Contains(no_fit));
}

TEST_CASE("A calibration gives no spread of fewer than five points of equal weight", "[ensemble]") {
    std::vector<double> distances(16, 400.0);
    for (std::size_t k = 0; k < 4; ++k) distances[k] = 10.0;  // the others have no weight beside these
    const std::string few = calibration_section(calibration_of(distances));
    CHECK_THAT(few, Contains(no_spread) && Contains(" - | - | - | - |"));
    distances[4] = distances[5] = 10.0;
    CHECK_THAT(calibration_section(calibration_of(distances)), !Contains(no_spread) && !Contains(" - | - | - | - |"));
}

TEST_CASE("A calibration says which of its runs left the terrain, and whether its best one did", "[ensemble]") {
    Calibration c = calibration_of(std::vector<double>(16, 10.0));
    CHECK_THAT(calibration_section(c), !Contains("left the terrain"));
    c.left_terrain = 3;
    CHECK_THAT(calibration_section(c), Contains("Of 3 a noticeable share left the terrain") &&
                                           Contains("lower bounds") && !Contains("at the best point"));
    c.fits[0].left_share.assign(16, 0.25);
    CHECK_THAT(calibration_section(c), Contains("slope: at the best point 25 % of all that flowed left the terrain"));
}

TEST_CASE("A calibration does not tell a fall of the misfit that its numbers do not show", "[ensemble]") {
    Calibration c = calibration_of(std::vector<double>(16, 10.0));
    const double best = -c.fits[0].log_likelihood[0];
    c.optimum = Optimum{{0.5}, best - 1e-9, {}, 1, "there", c.fits[0].scores};
    c.optimum->scores.resize(1);
    CHECK_THAT(calibration_section(c), Contains("the misfit did not fall from ") && !Contains("fell from"));
    c.optimum->misfit = 0.5 * best;
    CHECK_THAT(calibration_section(c), Contains("the misfit fell from "));
}
