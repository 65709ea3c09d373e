// The Voellmy-Salm classes are typed numbers: their order shows a slip.
#include <cmath>

#include "catch.h"
#include "scene/salm_table.h"

using namespace frana;

TEST_CASE("In the classes of snow, xi grows with altitude and size and falls from flat ground to gullies",
          "[parameters]") {
    for (std::size_t size = 0; size < 4; ++size)
        for (std::size_t ground = 0; ground < 4; ++ground)
            for (std::size_t altitude = 0; altitude < 3; ++altitude) {
                CAPTURE(salm::size_names[size], salm::ground_names[ground], altitude);
                const double xi = salm::xi[size][ground][altitude];
                CHECK(std::fmod(xi, 50.0) == 0.0);  // as the source is rounded; m/s2, not k
                CHECK(xi >= 900.0);
                CHECK(xi <= 4000.0);
                if (altitude > 0) CHECK(xi > salm::xi[size][ground][altitude - 1]);
                if (ground > 0) CHECK(xi < salm::xi[size][ground - 1][altitude]);
                if (size > 0) CHECK(xi > salm::xi[size - 1][ground][altitude]);
            }
}

TEST_CASE(
    "In the classes of snow, mu falls with altitude, return period and size and grows from flat ground to gullies",
    "[parameters]") {
    for (std::size_t size = 0; size < 4; ++size)
        for (std::size_t period = 0; period < 4; ++period)
            for (std::size_t ground = 0; ground < 4; ++ground)
                for (std::size_t altitude = 0; altitude < 3; ++altitude) {
                    CAPTURE(salm::size_names[size], salm::return_periods[period], salm::ground_names[ground], altitude);
                    const double mu = salm::mu[size][period][ground][altitude];
                    CHECK(std::abs(mu / 0.005 - std::round(mu / 0.005)) < 1e-9);  // typed to 0.005
                    CHECK(mu >= 0.14);
                    CHECK(mu <= 0.47);
                    if (altitude > 0) CHECK(mu < salm::mu[size][period][ground][altitude - 1]);
                    // Tiny avalanches of 100 and of 300 years are the same on open slopes.
                    if (period > 0) CHECK(mu <= salm::mu[size][period - 1][ground][altitude]);
                    if (ground > 0) CHECK(mu > salm::mu[size][period][ground - 1][altitude]);
                    if (size > 0) CHECK(mu < salm::mu[size - 1][period][ground][altitude]);
                }
}

TEST_CASE("The value of snow that is no source's is interpolated in the logarithm of the period", "[parameters]") {
    const auto& tiny = salm::mu[salm::tiny];
    const double share = std::log(100.0 / 30.0) / std::log(300.0 / 30.0);
    for (std::size_t altitude = 0; altitude < 3; ++altitude) {
        const double between =
            (1.0 - share) * tiny[1][salm::channelled][altitude] + share * tiny[3][salm::channelled][altitude];
        CHECK(tiny[salm::hundred_years][salm::channelled][altitude] ==
              Approx(0.005 * std::round(between / 0.005)).epsilon(1e-12));
    }
}

TEST_CASE("Limits of the classes of snow grow", "[parameters]") {
    CHECK((salm::size_limits[0] < salm::size_limits[1] && salm::size_limits[1] < salm::size_limits[2]));
    CHECK(salm::altitude_limits[0] < salm::altitude_limits[1]);
    for (std::size_t k = 1; k < 4; ++k) CHECK(salm::return_periods[k] > salm::return_periods[k - 1]);
}
