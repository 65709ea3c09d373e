// What of a survey counts: differences by blocks, and likelihoods, where the numbers are known.
#include <cmath>
#include <limits>

#include "catch.h"
#include "compare/blocks.h"
#include "ensemble/evidence.h"

using namespace frana;

namespace {

Raster of(Index nx, Index ny, double x0, double y0, double value) {
    return Raster::filled({nx, ny, x0, y0, 2.0}, value);
}

}  // namespace

TEST_CASE("Heights are compared by the means of blocks", "[ensemble]") {
    Raster surveyed = of(4, 4, 1.0, 1.0, 0.0), simulated = surveyed;
    // Blocks of two pixels. In the south-western one the same volume lies elsewhere; in the north-eastern one 1 m is missing on one
    // of four pixels; the others are empty in both.
    simulated.at(0, 0) = 3.0, surveyed.at(1, 1) = 3.0;
    surveyed.at(3, 3) = 1.0;
    const BlockErrors apart = block_errors(simulated, surveyed, 4.0);
    CHECK(apart.number == 2.0);
    CHECK(apart.rms == Approx(std::sqrt(0.5 * 0.25 * 0.25)).epsilon(1e-14));

    SECTION("a pixel is the smallest block, and the whole survey the largest") {
        CHECK(block_errors(simulated, surveyed, 0.1).number == 3.0);
        const BlockErrors whole = block_errors(simulated, surveyed, 1e9);
        CHECK(whole.number == 1.0);
        CHECK(whole.rms == Approx(1.0 / 16.0).epsilon(1e-14));
    }
    SECTION("what was not surveyed is in no mean, and a block counts for the part that was") {
        surveyed.at(2, 2) = surveyed.at(2, 3) = Raster::nodata;
        const BlockErrors part = block_errors(simulated, surveyed, 4.0);
        CHECK(part.number == 1.5);
        CHECK(part.rms == Approx(std::sqrt(0.5 * 0.5 * 0.5 / 1.5)).epsilon(1e-14));
    }
    SECTION("nothing was simulated around the run's pixels") {
        const Raster small = of(2, 2, 1.0, 1.0, 0.75);  // the south-western block, with the survey's volume
        CHECK(block_errors(small, surveyed, 4.0).rms == Approx(std::sqrt(0.5 * 0.25 * 0.25)).epsilon(1e-14));
    }
    SECTION("two empty rasters are the same") {
        const Raster none = of(4, 4, 1.0, 1.0, 0.0);
        CHECK(block_errors(none, none, 4.0).number == 0.0);
        CHECK(block_errors(none, none, 4.0).rms == 0.0);
    }
}

TEST_CASE("Likelihoods of all that counts are weighed by their errors", "[ensemble]") {
    EventScores scores;
    scores.misfits = {Misfit{30.0, 8.0}, Misfit{10.0, 1.0}, Misfit{0.2, 5.0}, Misfit{0.1, 3.0}, Misfit{0.5, 2.0}};
    SurveyErrors errors;
    errors.outline = 15.0, errors.runout = 5.0, errors.height = 0.1, errors.log = 0.25;
    const double each[] = {-0.5 * 8.0 * 4.0, -0.5 * 4.0, -0.5 * 5.0 * 4.0, -0.5 * 3.0, -0.5 * 2.0 * 4.0};
    double sum = 0.0;
    std::vector<Evidence> objective;
    for (std::size_t k = 0; k < kEvidence; ++k) {
        CAPTURE(k);
        CHECK(log_likelihood(scores, {all_evidence()[k]}, errors) == Approx(each[k]).epsilon(1e-14));
        objective.push_back(all_evidence()[k]);
        sum += each[k];
        CHECK(log_likelihood(scores, objective, errors) == Approx(sum).epsilon(1e-14));
    }
    CHECK(log_likelihood(scores, {}, errors) == 0.0);
    scores.misfits[1].reset();
    CHECK(log_likelihood(scores, {Evidence::outline}, errors) == Approx(each[0]).epsilon(1e-14));
    CHECK(log_likelihood(scores, {Evidence::outline, Evidence::runout}, errors) ==
          -std::numeric_limits<double>::infinity());
}
