// What surveys tell of one another, on misfits by hand.
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "catch.h"
#include "ensemble/predictions.h"

using Catch::Contains;

TEST_CASE("a survey that misleads about another event is named", "[ensemble]") {
    // Four values, likely by one survey each or by none, and how far the outlines of each event are apart with them.
    // Medians by hand: (5 + 6) / 2, (5 + 5) / 2, (8 + 8) / 2.
    frana::Calibration found{{}, frana::Posterior(1, 1), std::vector<frana::EventFit>(3), 0, 0, 0.0};
    found.plan.samples = 4;
    const double apart[3][4] = {{1, 9, 5, 6}, {5, 1, 5, 7}, {8, 9, 1, 8}};
    for (std::size_t e = 0; e < 3; ++e) {
        found.plan.events.emplace_back().name = std::string(1, static_cast<char>('a' + e));
        for (std::size_t k = 0; k < 4; ++k) {
            found.fits[e].scores.emplace_back().boundary = apart[e][k];
            found.fits[e].log_likelihood.push_back(e == k ? 0.0 : -std::numeric_limits<double>::infinity());
        }
    }
    const auto points = found.posterior.next(4);
    found.posterior.add(points, {0.0, -1.0, -2.0, -3.0});
    const auto rows = frana::predictions(found);
    REQUIRE(rows.size() == 3);
    for (std::size_t e = 0; e < 3; ++e) {
        CHECK(rows[e].own.mean == 1.0);
        for (std::size_t f = 0; f < 3; ++f) {
            CHECK(rows[e].by_one[f].mean == apart[e][f]);
            CHECK(rows[e].by_one[f].median == apart[e][f]);
        }
    }
    CHECK(rows[0].prior.mean == Approx(21.0 / 4.0));
    CHECK(rows[0].prior.median == 5.5);
    CHECK(rows[1].prior.median == 5.0);
    CHECK(rows[2].prior.median == 8.0);
    const std::string text = frana::predictions_section(found);
    CHECK_THAT(
        text, Contains("What b alone tells predicts a worse than what was known before: by the medians, outlines 9.0 m "
                       "apart instead of 5.5 m.") &&
                  Contains("What b alone tells predicts c worse"));
    for (const char* fair : {"What c alone tells predicts", "What a alone tells predicts"})
        CHECK_THAT(text, !Contains(fair));

    // Nothing flows of the first event where the second one's survey has all of its weight.
    found.fits[0].scores[1].boundary.reset();
    CHECK(std::isnan(frana::predictions(found)[0].by_one[1].mean));
    const std::string without = frana::predictions_section(found);
    CHECK_THAT(without, Contains("| a | 1.0 | - | 5.0 |") &&
                            Contains("What b alone tells predicts no flow for a, and so misleads.") &&
                            Contains("points of equal weight: it may be chance.") && !Contains("nan"));
}
