// Zones and a raster of friction by the program: check, rasters, report, record; what a changed zone does to --resume.
#include <nlohmann/json.hpp>

#include "catch.h"
#include "io/gdal_reader.h"
#include "plane_case.h"

using namespace frana;
namespace fs = std::filesystem;
using Catch::Contains;
using Json = nlohmann::json;

namespace {

const char* const kZones = R"(
[material.bed]
law = "voellmy"
mu = 0.1
xi = "xi.asc"
[[material.zone]]
outline = "fan.geojson"
mu = 0.3
rheology.viscosity = 30
[material.rheology]
law = "newtonian"
viscosity = 10
[output]
every = 1
formats = ["geotiff", "png"]
)";

struct Zones : PlaneCase {
    Zones() {
        write(kZones);
        write_fan(100);
        std::ostringstream xi;
        xi << "ncols 4\nnrows 3\nxllcorner -10\nyllcorner -10\ncellsize 50\nNODATA_value -9999\n";
        for (int row = 0; row < 3; ++row) xi << "400 400 500 500\n";
        write_text(folder() / "xi.asc", xi.str());
    }
    void write_fan(int east) const {
        std::ostringstream ring;
        ring << "[[[50, 0], [" << east << ", 0], [" << east << ", 100], [50, 100], [50, 0]]]";
        write_text(folder() / "fan.geojson",
                   R"({"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {},
                      "geometry": {"type": "Polygon", "coordinates": )" +
                       ring.str() + "}}]}");
    }
};

Raster raster_of(const fs::path& file) {
    std::vector<std::string> log;
    return GdalReader().read_raster(file, {-1e9, -1e9, 1e9, 1e9}, "", log);
}

}  // namespace

TEST_CASE("What was used of zones and rasters is said before a run and left by it", "[program][zones]") {
    const Zones plane;
    const Outcome check = plane.frana("check CASE");
    CHECK(check.code == 0);
    CHECK_THAT(check.out, Contains("friction    material.zone.0 (fan.geojson): 5000 m2, mu 0.3, xi 400 to 500 m/s^2, "
                                   "rheology.viscosity 30 Pa s"));
    CHECK_THAT(check.out, Contains("friction    elsewhere: 10000 m2, mu 0.1, xi 400 to 500 m/s^2, "
                                   "rheology.viscosity 10 Pa s"));
    const fs::path dir = plane.folder() / "out";
    const Outcome run = plane.frana("run CASE --quiet --out " + dir.string());
    INFO(run.err);
    CHECK(run.code == 0);
    const Raster mu = raster_of(dir / "rasters" / "mu.tif"), xi = raster_of(dir / "rasters" / "xi.tif");
    CHECK(mu.geometry == raster_of(dir / "rasters" / "peak_depth.tif").geometry);
    CHECK((mu.at(9, 4) == Approx(0.1) && mu.at(10, 4) == Approx(0.3) && mu.at(19, 4) == Approx(0.3) &&
           mu.at(20, 4) == Approx(0.1)));
    const Raster viscosity = raster_of(dir / "rasters" / "rheology_viscosity.tif");
    CHECK((viscosity.at(9, 4) == 10.0 && viscosity.at(10, 4) == 30.0));
    CHECK((xi.at(17, 9) == 400.0 && xi.at(18, 9) == 500.0));  // pixels end at 90 m
    CHECK(fs::file_size(dir / "figures" / "map_mu.png") > 1000);
    const std::string report = text_of(dir / "report.md");
    for (const char* text :
         {"## Friction",
          "| material.zone.0 (fan.geojson) | 5000 m2, mu 0.3, xi 400 to 500 m/s^2, rheology.viscosity 30 Pa s |",
          "[rasters/mu.tif](rasters/mu.tif)", "figures/map_xi.png", "figures/map_rheology_viscosity.png"})
        CHECK_THAT(report, Contains(text));
    const Json json = Json::parse(text_of(dir / "run.json"));
    CHECK(json["friction"][0]["mu"]["low"] == 0.3);
    CHECK(json["friction"][0]["rheology.viscosity"]["high"] == 30.0);
    CHECK(json["friction"][1]["area"] == 10000.0);
    const std::vector<std::string> files = json["files"];
    CHECK(std::find(files.begin(), files.end(), "rasters/xi.tif") != files.end());
    fs::remove_all(dir / "figures");
    CHECK(plane.frana("figures " + dir.string()).code == 0);
    CHECK(fs::exists(dir / "figures" / "map_mu.png"));
}

TEST_CASE("A run with zones that stops goes on with the same bits, but not with another zone", "[program][zones]") {
    const Zones plane;
    const std::string whole = (plane.folder() / "whole").string(), half = (plane.folder() / "half").string();
    CHECK(plane.frana("run CASE --quiet --threads 1 --out " + whole).code == 0);
    CHECK(plane.frana("run CASE --quiet --threads 1 --until 1 --out " + half).code == 0);
    plane.write_fan(110);
    const Outcome other = plane.frana("run CASE --quiet --resume --out " + half);
    CHECK(other.code == 2);
    CHECK_THAT(other.err, Contains("found a state from before the file") && Contains("fan.geojson was changed"));
    plane.write_fan(100);
    CHECK(plane.frana("run CASE --quiet --resume --threads 1 --out " + half).code == 0);
    for (const char* name :
         {"history.csv", "rasters/final_depth.tif", "rasters/mu.tif", "rasters/rheology_viscosity.tif"})
        CHECK(text_of(fs::path(whole) / name) == text_of(fs::path(half) / name));
}

TEST_CASE("What a raster of depths holds beyond the terrain is said, all of it", "[program]") {
    const PlaneCase plane;  // x from 0 to 150 m, y from 0 to 100 m; outer nodes 2.5 m farther in
    std::ostringstream depth;
    depth << "ncols 10\nnrows 2\nxllcorner 100\nyllcorner 40\ncellsize 10\nNODATA_value -9999\n";
    for (int row = 0; row < 2; ++row) depth << "2 2 2 2 2 2 2 2 2 0\n";
    write_text(plane.folder() / "depth.asc", depth.str());
    write_text(plane.file(), "[terrain]\ndem = \"dem.asc\"\n[[release]]\ndepth = \"depth.asc\"\n[time]\nend = 2\n");
    const Outcome check = plane.frana("check CASE");
    // Of 3600 m3, those west of x = 147.5 m are taken.
    CHECK_THAT(check.out + check.err, Contains("1700 m3 (47.2 % of it) lie beyond the outer nodes"));
    write_text(
        plane.file(),
        "[terrain]\ndem = \"dem.asc\"\n[[release]]\noutline = \"release.geojson\"\ndepth = 1\n[time]\nend = 2\n");
    const Outcome inside = plane.frana("check CASE");
    CHECK_THAT(inside.out + inside.err, !Contains("beyond the outer nodes"));
}
