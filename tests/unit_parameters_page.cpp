// The tables of cases/PARAMETERS.md are typed numbers: their order shows a slip.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "catch.h"

namespace {

using Cells = std::vector<std::string>;

/// The rows of the table whose header begins with `head`, without header and rule, each cut into its cells.
std::vector<Cells> table(const std::string& head) {
    std::ifstream page(FRANA_SOURCE_DIR "/cases/PARAMETERS.md");
    std::vector<Cells> rows;
    bool within = false;
    for (std::string line; std::getline(page, line);) {
        if (line.rfind(head, 0) == 0) {
            within = true;
            std::getline(page, line);
        } else if (within && line.rfind('|', 0) != 0) {
            break;
        } else if (within) {
            std::istringstream row(line.substr(1));
            Cells cells;
            for (std::string cell; std::getline(row, cell, '|');) {
                const std::size_t first = cell.find_first_not_of(' ');
                cells.push_back(
                    first == std::string::npos ? "" : cell.substr(first, cell.find_last_not_of(' ') + 1 - first));
            }
            rows.push_back(cells);
        }
    }
    return rows;
}

/// "a/b/c" as three numbers.
std::vector<double> classes(const std::string& cell) {
    std::vector<double> values;
    std::string plain = cell;
    plain.erase(std::remove(plain.begin(), plain.end(), '*'), plain.end());  // of an interpolated value
    std::istringstream numbers(plain);
    for (std::string value; std::getline(numbers, value, '/');)
        if (value.find_first_not_of("0123456789.") == std::string::npos) values.push_back(std::stod(value));
    return values;
}

}  // namespace

TEST_CASE("In the table of snow, xi grows with altitude and mu falls with altitude and return period", "[parameters]") {
    const auto xi = table("| xi [m/s2]");
    REQUIRE(xi.size() == 4);
    for (const Cells& row : xi)
        for (std::size_t k = 1; k < 5; ++k) {
            const auto c = classes(row[k]);
            REQUIRE(c.size() == 3);
            CHECK((c[0] < c[1] && c[1] < c[2]));
        }
    const auto mu = table("| size | return period");
    REQUIRE(mu.size() == 16);
    for (std::size_t row = 0; row < mu.size(); ++row)
        for (std::size_t k = 2; k < 6; ++k) {
            const auto c = classes(mu[row][k]);
            CAPTURE(row, k);
            REQUIRE(c.size() == 3);
            CHECK((c[0] > c[1] && c[1] > c[2]));
            const bool same_size = row % 4 != 0;
            const auto longer = same_size ? classes(mu[row - 1][k]) : std::vector<double>{};
            for (std::size_t n = 0; n < longer.size(); ++n) CHECK(longer[n] <= c[n]);
        }
}

TEST_CASE("In the table of mud, strengths at 0.30 and 0.40 follow from the row's own coefficients", "[parameters]") {
    const auto mud = table("| Sample | a1");
    REQUIRE(mud.size() == 13);
    for (const Cells& row : mud) {
        CAPTURE(row[0]);
        for (const std::size_t pair : {1, 3}) {
            const double a = std::stod(row[pair]), b = std::stod(row[pair + 1]);
            std::istringstream both(row[pair == 1 ? 5 : 6]);
            std::string low, high;
            std::getline(both, low, '/');
            std::getline(both, high);
            // The page rounds to three digits.
            CHECK(std::stod(low) == Approx(a * std::exp(b * 0.30)).epsilon(5e-3));
            CHECK(std::stod(high) == Approx(a * std::exp(b * 0.40)).epsilon(5e-3));
        }
    }
}
