// The quick rows of verification.txt again, with every build of the library: the first grid of the problems that take
// less than a second. The test "verification" runs all of them.
#include <fstream>
#include <sstream>

#include "catch.h"
#include "checks/verify/library.h"
#include "checks/verify/table.h"

using namespace frana;

namespace {

struct Row {
    std::string text, problem, preset;
    Index cells = 0, particles = 0, steps = 0;
};

/// The first row of each problem.
std::vector<Row> first_rows() {
    std::ifstream file(FRANA_SOURCE_DIR "/tests/verification.txt");
    std::vector<Row> rows;
    int per_cell = 0;
    for (std::string line; std::getline(file, line);) {
        Row row;
        row.text = line;
        std::istringstream words(line);
        if (!(words >> row.problem >> row.preset >> row.cells >> per_cell >> row.particles >> row.steps)) continue;
        if (rows.empty() || rows.back().problem != row.problem) rows.push_back(row);
    }
    return rows;
}

}  // namespace

TEST_CASE("The first grids of the verification table give the figures that stand there", "[verify]") {
    constexpr Index kQuick = 600000;  // steps of a particle
    constexpr double kTolerance =
        0.05;  // of `frana verify --against`: another compiler's round-off, grown by splitting
    int run = 0;
    for (const Row& row : first_rows()) {
        if (row.particles * row.steps > kQuick) continue;
        const verify::Problem* problem = verify::find_problem(row.problem);
        REQUIRE(problem != nullptr);
        verify::Setup setup;
        setup.preset = row.preset;
        const std::string now = verify::table_row(verify::measure(*problem, setup, {row.cells}).front(), false);
        CAPTURE(row.text, now);
        CHECK(verify::differences(now, row.text, kTolerance).empty());
        ++run;
    }
    CHECK(run >= 20);
}
