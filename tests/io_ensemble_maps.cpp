// What `frana ensemble` tells of gauges, arrival, indices and hazard, on ponds whose answers are known.
#include <cmath>
#include <nlohmann/json.hpp>

#include "catch.h"
#include "pond.h"

namespace fs = std::filesystem;
using Catch::Contains;
using Json = nlohmann::json;

namespace {

/// All of the pond is released with the weight 0.7, else its west, which does not come to its east in half a second.
const std::string two_outlines =
    "[ensemble]\ncase = \"case.toml\"\nmethod = \"grid\"\nquantiles = [0.5, 0.95]\n"
    "[[ensemble.vary]]\nkey = \"release.0.outline\"\ndistribution = \"discrete\"\n"
    "values = [\"all.geojson\", \"west.geojson\"]\nweights = [0.7, 0.3]\n";

const std::string gauges =
    "[[gauge]]\nname = \"west\"\npoint = [10, 30]\n[[gauge]]\nname = \"east\"\npoint = [50, 30]\n";

}  // namespace

TEST_CASE("Gauges of the case are columns of the runs and outcomes of the ensemble", "[ensemble]") {
    const Pond pond;
    pond.write("case.toml", text_of(pond.path("case.toml")) + gauges);
    pond.write("many.toml", two_outlines);
    REQUIRE(pond.frana("ensemble many.toml --out many --quiet").code == 0);
    const auto numbers = [&](const std::string& name) { return pond.column("many", "gauge_" + name); };
    CHECK(std::stod(numbers("east_depth_m").at(0)) == Approx(1.5).epsilon(1e-12));
    CHECK(std::stod(numbers("east_speed_m_s").at(0)) == Approx(0.0).margin(1e-9));
    CHECK(numbers("east_arrival_s").at(0) == "0");
    for (const char* name : {"east_depth_m", "east_speed_m_s", "east_arrival_s"}) CHECK(numbers(name).at(1).empty());
    CHECK(std::stod(numbers("west_depth_m").at(1)) == Approx(1.5).epsilon(1e-3));  // the wave from the edge is near
    const Json results = Json::parse(text_of(pond.path("many/ensemble.json")))["results"];
    // Where a run never comes its depth is 0, and its time later than any.
    CHECK(results["gauge_east_depth_m"]["mean"].get<double>() == Approx(0.7 * 1.5));
    CHECK(results["gauge_east_depth_m"]["q0.5"].get<double>() == Approx(1.5));
    CHECK(results["gauge_east_arrival_s"]["q0.5"] == 0.0);
    CHECK(results["gauge_east_arrival_s"]["q0.95"].is_null());
    CHECK(results["gauge_east_arrival_s"]["share_that_came"].get<double>() == Approx(0.7));
    CHECK(results["gauge_west_arrival_s"]["q0.95"] == 0.0);
    CHECK_THAT(text_of(pond.path("many/report.md")), Contains("largest depth [m] at east") && Contains("| never |"));
    const std::string runs = text_of(pond.path("many/runs.csv"));
    REQUIRE(pond.frana("ensemble --join many --quiet").code == 0);  // from what the shards hold
    CHECK(text_of(pond.path("many/runs.csv")) == runs);
}
