// A wall in loose ground by the program: what a run says of it, and what the rasters have.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "catch.h"
#include "plane_case.h"
#include "read_raster.h"

using namespace frana;
namespace fs = std::filesystem;
using Catch::Contains;
using Json = nlohmann::json;

TEST_CASE("A wall in loose ground: what was taken up, what went over, and what is taken for firm",
          "[barriers][erosion]") {
    const PlaneCase plane;
    plane.write(
        "[material]\ndensity = 2000\n[material.bed]\nlaw = \"coulomb\"\nmu = 0.05\n[erodible]\nlaw = \"growth\"\n"
        "growth = 0.01\ndepth = 0.5\n[[barrier]]\nname = \"dam\"\nline = [[80, 20], [80, 80]]\nheight = 2\n"
        "[output]\nevery = 1\nformats = [\"geotiff\"]\n");
    const fs::path dir = plane.folder() / "out";
    const Outcome run = plane.frana("run CASE --quiet --threads 1 --set time.end=12 --out " + dir.string());
    INFO(run.err);
    REQUIRE(run.code == 0);
    const Json record = Json::parse(text_of(dir / "run.json"));
    CHECK(record["budgets"]["bed"]["eroded"] > 0.0);
    CHECK(std::abs(record["budgets"]["bed"]["relative_error"].get<double>()) <= 1e-13);
    CHECK_THAT(text_of(dir / "report.md"), Contains("m3 of loose ground under barriers and a cell around them"));
    const Raster change = raster_of(dir, "bed_change.tif");
    double under = 0.0, before = 0.0;
    for (Index j = 0; j < change.geometry.ny; ++j)
        for (Index i = 0; i < change.geometry.nx; ++i) {
            const double x = change.geometry.x(i), y = change.geometry.y(j), z = change.at(i, j);
            if (std::abs(x - 80.0) < 5.1 && y > 20.0 && y < 80.0) under = std::max(under, std::abs(z));
            if (x < 74.0) before = std::max(before, -z);
        }
    CHECK(under == 0.0);
    CHECK(before > 0.05);

    // The ground at the end is that of the start and its change, without the dam: a run can begin on it.
    const Raster at_start = raster_of(dir, "elevation.tif");
    REQUIRE(at_start.geometry == change.geometry);
    CHECK(off_its_change(at_start, dir) < 1e-5);  // float32 of 100 m: half a digit is 4e-6
}
