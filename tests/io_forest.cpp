// A forest by the program: what is said of it, what a run leaves, how it ends, and going on with the same bits.
#include <nlohmann/json.hpp>

#include "catch.h"
#include "io/gdal_reader.h"
#include "plane_case.h"

using namespace frana;
namespace fs = std::filesystem;
using Catch::Contains;
using Json = nlohmann::json;

namespace {

/// Trees on the lower part of the plane, in two stands of squares of 50 m.
struct Wood : PlaneCase {
    explicit Wood(double detrainment, double depth = 1.5) {
        write(
            "[material]\ndensity = 300\n[material.bed]\nlaw = \"coulomb\"\nmu = 0.05\n[forest]\n"
            "detrainment = \"stands.asc\"\n[output]\nevery = 1\nformats = [\"geotiff\"]\n");
        const std::string text = text_of(file()), was = "depth = 1.5", end = "end = 2";
        std::string other = text;
        other.replace(other.find(was), was.size(), "depth = " + std::to_string(depth));
        other.replace(other.find(end), end.size(), "end = 20");
        write_text(file(), other);
        std::ostringstream stands;
        stands << "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 50\nNODATA_value -9999\n";
        for (int row = 0; row < 2; ++row) stands << "-9999 " << detrainment << ' ' << 0.5 * detrainment << '\n';
        write_text(folder() / "stands.asc", stands.str());
    }
};

}  // namespace

TEST_CASE("What trees take is said before a run and left by it", "[program][forest]") {
    const Wood plane(80.0);
    const Outcome check = plane.frana("check CASE");
    CHECK(check.code == 0);
    CHECK_THAT(check.out, Contains("forest: 1 ha, with a detrainment of 40 to 80 Pa"));
    CHECK_THAT(check.out, Contains("33.3 % of the terrain's nodes have no data there and no forest"));
    const fs::path dir = plane.folder() / "out";
    const Outcome run = plane.frana("run CASE --quiet --threads 1 --until 6 --out " + dir.string());
    INFO(run.err);
    CHECK(run.code == 0);
    const Json bed = Json::parse(text_of(dir / "run.json"))["budgets"]["bed"];
    CHECK(bed["deposited"] > 0.0);
    CHECK(std::abs(bed["relative_error"].get<double>()) <= 1e-13);
    std::vector<std::string> log;
    const Raster left = GdalReader().read_raster(dir / "rasters" / "deposited_depth.tif", {0, 0, 150, 100}, "", log);
    double mass = 0.0;
    for (const double depth : left.values) mass += depth > 0.0 ? 25.0 * 300.0 * depth : 0.0;
    CHECK(mass == Approx(bed["deposited"].get<double>()).epsilon(1e-6));  // single precision
    CHECK_THAT(text_of(dir / "report.md"),
               Contains("| held back by trees |") && Contains("| GeoTIFF of the detrainment K of the forest |"));
    // What was used, node by node: none in the stand without data.
    const Raster used = GdalReader().read_raster(dir / "rasters" / "forest_pressure.tif", {0, 0, 150, 100}, "", log);
    REQUIRE(used.geometry.size() > 0);
    for (Index i = 0; i < used.geometry.nx; ++i) {
        const double x = used.geometry.x(i), expected = x < 50.0 ? 0.0 : x < 100.0 ? 80.0 : 40.0;
        CAPTURE(x);
        CHECK(used.at(i, 0) == expected);
    }
    REQUIRE(plane.frana("figures " + dir.string()).code == 0);
    CHECK(fs::exists(dir / "figures" / "map_forest_pressure.png"));
    CHECK_THAT(text_of(dir / "report.md"), !Contains("forest_pressure under the flow"));
    // The same everywhere: no map of it, as of friction.
    const std::string even = (plane.folder() / "even").string();
    REQUIRE(plane.frana("run CASE --quiet --threads 1 --until 1 --set forest.detrainment=50 --out " + even).code == 0);
    CHECK_FALSE(fs::exists(fs::path(even) / "rasters" / "forest_pressure.tif"));
}

TEST_CASE("A run ends when trees have taken all of it, and says that it has become bed", "[program][forest]") {
    const Wood plane(10000.0, 0.02);
    const fs::path dir = plane.folder() / "out";
    CHECK(plane.frana("run CASE --quiet --threads 1 --out " + dir.string()).code == 0);
    const Json json = Json::parse(text_of(dir / "run.json"));
    const Json bed = json["budgets"]["bed"];
    CHECK(bed["final"].get<double>() == Approx(1200.0 * 0.02 * 300.0).epsilon(1e-6));
    CHECK_THAT(text_of(dir / "report.md"), Contains("no flow is left: it has become bed"));
}

TEST_CASE("A run among trees that stops goes on with the same bits", "[program][forest]") {
    const Wood plane(80.0);
    const std::string whole = (plane.folder() / "whole").string(), half = (plane.folder() / "half").string();
    CHECK(plane.frana("run CASE --quiet --threads 1 --out " + whole).code == 0);
    CHECK(plane.frana("run CASE --quiet --threads 1 --until 3 --out " + half).code == 0);
    CHECK(plane.frana("run CASE --quiet --resume --threads 1 --out " + half).code == 0);
    for (const char* name : {"history.csv", "rasters/final_depth.tif", "rasters/deposited_depth.tif"})
        CHECK(text_of(fs::path(whole) / name) == text_of(fs::path(half) / name));
}
