// Real terrain: running on after rest leaves deposit and toe where they are (data read where it lies, or skipped).
#include <fmt/core.h>

#include <fstream>

#include "catch.h"
#include "fresh_folder.h"
#include "io/gdal_reader.h"
#include "run_on.h"
#include "scene/build_scene.h"
#include "shared_data.h"

using namespace frana;
using namespace frana::test;

namespace {

Scene scene_of(const std::string& text, const std::filesystem::path& folder) {
    return build_scene(CaseFile::parse(text, folder / "case.toml", {}), GdalReader());
}

/// What the rule promises: in as much time again less than a hundredth of the volume goes a cell or more, and no node
/// is covered that has no covered neighbour.
void check_rests(const Scene& scene, double latest) {
    const RunOn on = run_on(scene, latest);
    CAPTURE(on.rested, on.moved, on.known, on.toe);
    REQUIRE(on.rested > 0.0);
    CHECK(on.known > 0.9);
    CHECK(on.moved < 0.01);
    CHECK(on.toe < 1.5);
}

}  // namespace

TEST_CASE("Ryggfonn's avalanche is at rest when the rule says so", "[real][run_on]") {
    const auto folder = shared_data("ryggfonn_2021");
    if (!folder) return;
    check_rests(scene_of(fmt::format(R"(
        terrain.dem = "{0}/dem.tif"
        material.density = 250.0
        material.bed = {{ law = "voellmy", mu = 0.4, xi = 9810.0 }}
        time.end = 1.0
        [[release]]
        outline = "{0}/release.geojson"
        depth = 1.0
    )", folder->string()), *folder), 800.0);
}

TEST_CASE("Frank's rock avalanche is at rest when the rule says so", "[real][run_on]") {
    const auto folder = shared_data("frank_1903");
    if (!folder) return;
    check_rests(scene_of(fmt::format(R"(
        terrain.dem = "{0}/dem.tif"
        material.density = 2200.0
        material.bed = {{ law = "coulomb", mu = 0.268 }}  # 15 degrees: the reference runs' second
        time.end = 1.0
        [[release]]
        outline = "{0}/release.geojson"
        depth = "{0}/release.tif"
    )", folder->string()), *folder), 400.0);
}

// Debris in gullies of two to four cells: a disc of 40 m and 4 m at each mapped source but that at the terrain's edge.
TEST_CASE("Debris flows of Olivares are at rest when the rule says so", "[real][run_on]") {
    const auto folder = shared_data("olivares_east");
    if (!folder) return;
    const FreshFolder own;
    std::string discs;
    for (const auto& [x, y] : {std::pair{397138.16, 6306817.61}, {397575.72, 6306418.83}, {396512.29, 6305665.56}}) {
        std::string ring;
        for (int n = 0; n <= 48; ++n)
            ring += fmt::format("{}[{:.3f}, {:.3f}]", n > 0 ? ", " : "", x + 40.0 * std::cos(n % 48 * M_PI / 24.0),
                                y + 40.0 * std::sin(n % 48 * M_PI / 24.0));
        discs += fmt::format(R"({}{{"type": "Feature", "properties": {{}}, "geometry": {{"type": "Polygon",
            "coordinates": [[{}]]}}}})", discs.empty() ? "" : ", ", ring);
    }
    const std::filesystem::path outline = own.path() / "sources.geojson";
    std::ofstream(outline) << R"({"type": "FeatureCollection", "crs": {"type": "name",
        "properties": {"name": "urn:ogc:def:crs:EPSG::32719"}}, "features": [)" << discs << "]}";
    check_rests(scene_of(fmt::format(R"(
        terrain.dem = "{0}/dem.tif"
        material.density = 2000.0
        material.bed = {{ law = "voellmy", mu = 0.4, xi = 500.0 }}
        time.end = 1.0
        [[release]]
        outline = "{1}"
        depth = 4.0
    )", folder->string(), outline.string()), *folder), 1500.0);
}
