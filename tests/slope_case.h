#pragma once
// A slope with a release that exists in memory only, and what is wrong with a case on it.
#include <string>
#include <vector>

#include "catch.h"
#include "fake_gis.h"

namespace frana::test {

/// 40 x 30 nodes, 5 m apart, on a plane that rises 1 in 2 to the east from 100 m.
inline FakeGis slope_gis() {
    FakeGis gis;
    gis.rasters["dem.tif"] =
        sampled({40, 30, 1002.5, 2002.5, 5.0}, [](double x, double) { return 100.0 + 0.5 * (x - 1000.0); });
    gis.polygons["release.geojson"] = rectangle(1050, 2050, 1100, 2080);
    return gis;
}

/// The one problem of a case that has exactly one: what build() throws.
template <class Build>
std::string only_problem(Build&& build) {
    std::vector<std::string> problems;
    try {
        build();
    } catch (const UserError& error) {
        problems = error.problems();
    }
    CAPTURE(problems);
    REQUIRE(problems.size() == 1);
    return problems[0];
}

}  // namespace frana::test
