// Units of speed that files have, and a release whose velocity is a raster in one of them.
#include <algorithm>

#include "catch.h"
#include "scene/build_scene.h"
#include "scene/speed_unit.h"
#include "slope_case.h"

using namespace frana;
using namespace frana::test;

namespace {

/// A slope whose rasters of velocity declare a unit.
struct SlopeWithSpeeds : FakeGis {
    SlopeWithSpeeds(std::string of, double speed) : FakeGis(slope_gis()), unit(std::move(of)) {
        rasters["v.tif"] = sampled(rasters["dem.tif"].geometry, [speed](double, double) { return speed; });
    }
    std::string unit_of(const std::filesystem::path&) const override { return unit; }
    std::string unit;
};

CaseFile case_with_speeds() {
    return CaseFile::parse(
        "[terrain]\ndem = \"dem.tif\"\n[[release]]\noutline = \"release.geojson\"\ndepth = 2\n"
        "velocity = [\"v.tif\", \"v.tif\"]\n[time]\nend = 20\n[material]\ndensity = 1500\nbed.law = \"none\"\n",
        "case.toml");
}

}  // namespace

TEST_CASE("Units of speed are known by their names, and what is none is not guessed", "[scene][units]") {
    for (const char* unit : {"", "m/s", "m s-1", "M/S"}) CHECK(metres_per_second(unit) == 1.0);
    for (const char* unit : {"km/h", "km h-1", "KPH"}) CHECK(metres_per_second(unit).value() == Approx(1.0 / 3.6));
    CHECK(metres_per_second("mph").value() == Approx(0.44704));  // by their definitions
    CHECK(metres_per_second("knots").value() == Approx(0.514444).epsilon(1e-6));
    CHECK(metres_per_second("ft/s").value() == Approx(0.3048));
    for (const char* unit : {"m", "degree", "km", "furlong/fortnight"}) CHECK_FALSE(metres_per_second(unit));
}

// Its numbers were taken as m/s.
TEST_CASE("A release's velocity in km/h is converted with a remark, one in metres is refused", "[scene][units]") {
    const auto fastest = [](const Scene& scene) {
        return *std::max_element(scene.particles.vx.begin(), scene.particles.vx.end());
    };
    const auto said = [](const Scene& scene) {
        return std::count(scene.log.begin(), scene.log.end(), "v.tif: values in km/h, converted to m/s");
    };
    const Scene by_hour = build_scene(case_with_speeds(), SlopeWithSpeeds("km/h", 36.0)),
                by_second = build_scene(case_with_speeds(), SlopeWithSpeeds("m/s", 10.0));
    CHECK(fastest(by_hour) == Approx(10.0).epsilon(1e-15));
    CHECK(fastest(by_second) == 10.0);
    CHECK((said(by_hour) == 1 && said(by_second) == 0));
    const std::string refused = only_problem([] { build_scene(case_with_speeds(), SlopeWithSpeeds("m", 10.0)); });
    CHECK_THAT(refused, Catch::Contains("velocity") && Catch::Contains("v.tif: found values in m; expected m/s"));
}
