// A bed that gains and loses, by the program: rasters, record, report, resume.
#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "catch.h"
#include "io_figures_scene.h"
#include "plane_case.h"
#include "read_layer.h"
#include "read_raster.h"

using namespace frana;
namespace fs = std::filesystem;
using Catch::Contains;
using Json = nlohmann::json;

namespace {

constexpr double kPixel = 25.0, kDensity = 1600.0, kReleased = 1.5 * 30.0 * 40.0;  // [m2], [kg/m3], [m3]

/// Ground that it takes up, and a second slide over what the first has left.
constexpr const char *kLoose = "[erodible]\ndepth = 0.4\nlaw = \"growth\"\ngrowth = 0.02\n",
                     *kSecondSlide = "[[release]]\noutline = \"release.geojson\"\ndepth = 1.5\nat = 8\n";

/// A slide that stops on the plane; `more` says what the bed is made of.
struct Slide : PlaneCase {
    explicit Slide(const std::string& more = "") {
        write(
            "[material]\ndensity = 1600\n[material.bed]\nlaw = \"coulomb\"\nmu = 0.2\n[output]\nevery = 5\n"
            "formats = [\"geotiff\"]\n[deposition]\nlaw = \"rest\"\ntime = 1\n" +
            more);
    }
    fs::path run(const std::string& name, const std::string& more = "") const {
        const fs::path dir = folder() / name;
        const Outcome done = frana("run CASE --quiet --set time.end=20 " + more + " --out " + dir.string());
        INFO(done.err);
        REQUIRE(done.code == 0);
        return dir;
    }
};

Json bed_of(const fs::path& run_dir) { return Json::parse(text_of(run_dir / "run.json"))["budgets"]["bed"]; }

double volume(const Raster& depth) {
    double sum = 0.0;
    for (const double value : depth.values) sum += value * kPixel;
    return sum;
}

/// float32 of elevations up to 100 m and of what their change sums to.
constexpr double kRounding = 1e-5;

void check_ground(const Slide& slide, const fs::path& run_dir) {
    const Raster before = raster_in(slide.folder() / "dem.asc"), after = raster_of(run_dir, "final_elevation.tif"),
                 change = raster_of(run_dir, "bed_change.tif"), left = raster_of(run_dir, "deposited_depth.tif"),
                 taken = raster_of(run_dir, "eroded_depth.tif");
    REQUIRE(after.geometry == before.geometry);
    double sums = 0.0;
    for (std::size_t k = 0; k < before.values.size(); ++k)
        sums = std::max(sums, std::abs(left.values[k] - taken.values[k] - change.values[k]));
    CHECK(off_its_change(before, run_dir) < kRounding);
    CHECK(sums < kRounding);
    CHECK(*std::min_element(left.values.begin(), left.values.end()) >= 0.0);
    CHECK(*std::min_element(taken.values.begin(), taken.values.end()) >= 0.0);
}

}  // namespace

TEST_CASE("What a slide leaves on rock is in the rasters, the record and the report", "[program][deposition]") {
    const Slide slide;
    const fs::path dir = slide.run("run");
    check_ground(slide, dir);
    const Json bed = bed_of(dir);
    const double deposited = bed["deposited"].get<double>();
    CHECK((bed["initial"] == 0.0 && bed["eroded"] == 0.0));
    CHECK(deposited > 0.5 * kReleased * kDensity);
    CHECK(bed["final"].get<double>() == Approx(deposited).epsilon(1e-13));
    CHECK(std::abs(bed["relative_error"].get<double>()) < 1e-13);
    // Rasters have seven digits.
    const double lies = volume(raster_of(dir, "deposited_depth.tif"));
    CHECK(kDensity * lies == Approx(deposited).epsilon(1e-6));
    CHECK(volume(raster_of(dir, "eroded_depth.tif")) == 0.0);
    CHECK(lies + volume(raster_of(dir, "final_depth.tif")) == Approx(kReleased).epsilon(1e-6));
    CHECK_THAT(text_of(dir / "report.md"), Contains("| became bed |"));
}

TEST_CASE("What lies at the end, as flow or bed, is one raster, and numbers say which depth", "[program][deposition]") {
    const Slide slide;
    const fs::path dir = slide.run("run", "--set 'output.formats=[\"vtk\",\"geotiff\",\"png\"]'");
    const Raster lying = raster_of(dir, "lying_depth.tif"), flow = raster_of(dir, "final_depth.tif"),
                 left = raster_of(dir, "deposited_depth.tif");
    double apart = 0.0;
    for (std::size_t k = 0; k < lying.values.size(); ++k)
        apart = std::max(apart, std::abs(lying.values[k] - flow.values[k] - left.values[k]));
    CHECK(apart < 1e-6);  // single precision of depths of about a metre
    CHECK(volume(lying) == Approx(kReleased).epsilon(1e-6));
    const auto deepest = [](const Raster& depth) {
        return *std::max_element(depth.values.begin(), depth.values.end());
    };
    const Json results = Json::parse(text_of(dir / "run.json"))["results"];
    CHECK(results["final_max_depth"].get<double>() == Approx(deepest(lying)).epsilon(1e-6));
    CHECK(results["final_max_flow_depth"].get<double>() == Approx(deepest(flow)).epsilon(1e-6));
    CHECK(deepest(flow) < deepest(lying));
    const std::string report = text_of(dir / "report.md");
    CHECK_THAT(report, Contains("| deepest at the end, with what has become bed |") &&
                           Contains("| deepest flow at the end |") && Contains("figures/map_lying_depth.png"));
    CHECK_THAT(report, !Contains("map_final_depth.png"));
    CHECK_FALSE(fs::exists(Slide("[erodible]\nlaw = \"none\"\n").run("rock", "--set deposition.law=none") / "rasters" /
                           "lying_depth.tif"));
}

TEST_CASE("Maps of a moment show what has become bed by then, and charts say that they do not",
          "[program][deposition][figures]") {
    if (figures::cannot_draw()) return;
    const Slide slide(
        "[[gauge]]\nname = \"g\"\npoint = [60, 50]\n[[profile]]\nname = \"p\"\nline = [[20, 50], [140, 50]]\n");
    const fs::path dir = slide.run("run", "--set 'output.formats=[\"vtk\",\"geotiff\",\"png\"]'");
    CHECK_THAT(text_of(dir / "report.md"),
               Contains("depth and speed at the gauges, of the flow without what has become bed") &&
                   Contains("profile p, of the flow without what has become bed"));
    const double end = Json::parse(text_of(dir / "run.json"))["simulated_time"].get<double>();  // all has become bed
    const Outcome drawn = slide.frana(fmt::format("figures run --time {}", end));
    INFO(drawn.err);
    REQUIRE(drawn.code == 0);
    const auto coloured = [&](const std::string& name) {
        const frana::Pixels picture = read_png(dir / "figures" / name);
        int count = 0;
        for (int y = 0; y < picture.height; ++y)
            for (int x = 0; x < picture.width; ++x) count += figures::saturation(picture.at(x, y)) > 60 ? 1 : 0;
        return count;
    };
    // Labels of other lengths leave the maps other sizes. Of the flow alone only the bar would have colours.
    CHECK(coloured(fmt::format("map_depth_t{:.6g}s.png", end)) > 0.5 * coloured("map_lying_depth.png"));
}

TEST_CASE("Ground that thin layers bury was covered, as deep as they lie", "[program][deposition]") {
    const Slide slide(std::string(kSecondSlide) + kLoose);
    const fs::path dir = slide.run("run");
    const Raster lying = raster_of(dir, "lying_depth.tif"), peak = raster_of(dir, "peak_depth.tif"),
                 arrival = raster_of(dir, "arrival_time.tif");
    double covered = 0.0;
    REQUIRE(volume(raster_of(dir, "deposited_depth.tif")) > 0.0);
    for (std::size_t k = 0; k < lying.values.size(); ++k) {
        if (lying.values[k] > 0.0) CHECK(peak.values[k] >= lying.values[k]);  // what lies there has been there
        const bool here = peak.values[k] > 0.1;
        covered += here ? kPixel : 0.0;
        if (here) CHECK(arrival.values[k] >= 0.0);  // no data is less than nothing
    }
    CHECK(Json::parse(text_of(dir / "run.json"))["results"]["footprint_area"].get<double>() == covered);
    const Layer footprint(dir / "results.gpkg", "footprint");
    double outlined = 0.0;
    for (const OGRFeatureUniquePtr& part : footprint.get()) outlined += part->GetGeometryRef()->toPolygon()->get_Area();
    CHECK(outlined == Approx(covered).epsilon(1e-9));
}

TEST_CASE("A bed that is taken up and left again closes its budget in the record and in the rasters",
          "[program][deposition]") {
    const Slide slide(std::string(kSecondSlide) + kLoose);
    const fs::path dir = slide.run("run");
    check_ground(slide, dir);
    const Json bed = bed_of(dir);
    const auto mass = [&](const char* name) { return bed[name].get<double>(); };
    REQUIRE((mass("eroded") > 0.0 && mass("deposited") > 0.0));
    CHECK(mass("final") == Approx(mass("initial") - mass("eroded") + mass("deposited")).epsilon(1e-13));
    CHECK(std::abs(mass("relative_error")) < 1e-13);
    // What was left may have been taken again: the rasters, of single precision, have what lies there at the end.
    const double lies = kDensity * volume(raster_of(dir, "deposited_depth.tif"));
    REQUIRE(mass("deposited") > 1.01 * lies);
    CHECK(mass("lies_behind") == Approx(lies).epsilon(1e-5));
    CHECK(mass("taken_of_bed") == Approx(kDensity * volume(raster_of(dir, "eroded_depth.tif"))).epsilon(1e-5));
    CHECK(mass("taken_again") == Approx(mass("eroded") - mass("taken_of_bed")).epsilon(1e-12));
    CHECK(mass("final") == Approx(mass("initial") - mass("taken_of_bed") + mass("lies_behind")).epsilon(1e-12));
    CHECK_THAT(text_of(dir / "report.md"),
               Contains(fmt::format("the flow took {:.6g} m3 of it", mass("taken_of_bed") / kDensity)) &&
                   Contains(fmt::format("of which it took {:.6g} m3 again and {:.6g} m3 lie there at the end",
                                        mass("taken_again") / kDensity, mass("lies_behind") / kDensity)));
    const double changed = volume(raster_of(dir, "bed_change.tif"));
    CHECK(kDensity * changed == Approx(mass("deposited") - mass("eroded")).epsilon(1e-5));
    CHECK(changed + volume(raster_of(dir, "final_depth.tif")) == Approx(2.0 * kReleased).epsilon(1e-6));
    CHECK_THAT(text_of(dir / "report.md"), Contains("| erodible bed |"));
}

TEST_CASE("A run that stops while it takes up its bed goes on to the same rasters and budget",
          "[program][deposition]") {
    const Slide slide("[erodible]\ndepth = 0.4\nlaw = \"growth\"\ngrowth = 0.02\n");
    const fs::path straight = slide.run("straight", "--threads 1");
    const fs::path parts = slide.run("parts", "--threads 2 --until 7");
    slide.run("parts", "--threads 1 --resume");
    CHECK(bed_of(parts) == bed_of(straight));
    CHECK(text_of(parts / "history.csv") == text_of(straight / "history.csv"));
    for (const char* name : {"deposited_depth.tif", "eroded_depth.tif", "bed_change.tif", "final_elevation.tif",
                             "final_depth.tif", "peak_depth.tif"}) {
        CAPTURE(name);
        CHECK(text_of(parts / "rasters" / name) == text_of(straight / "rasters" / name));
    }
}

TEST_CASE("On rough ground the final bed is terrain and change, and the terrain where it does not follow",
          "[program][deposition]") {
    const Slide slide("[erodible]\ndepth = 0.4\nlaw = \"growth\"\ngrowth = 0.02\n");
    std::ostringstream rough;
    rough << "ncols 30\nnrows 20\nxllcorner 0\nyllcorner 0\ncellsize 5\nNODATA_value -9999\n";
    for (int row = 0; row < 20; ++row)
        for (int column = 0; column < 30; ++column)
            rough << 100.0 - 0.5 * column + 0.125 * ((7 * row + 11 * column) % 5) << (column < 29 ? ' ' : '\n');
    write_text(slide.folder() / "dem.asc", rough.str());
    check_ground(slide, slide.run("follows"));
    const fs::path stays = slide.run("stays", "--set erodible.bed_evolves=false --set deposition.law=none");
    REQUIRE(volume(raster_of(stays, "eroded_depth.tif")) > 0.0);
    CHECK(raster_of(stays, "final_elevation.tif").values == raster_of(stays, "elevation.tif").values);
    const auto described = [](const fs::path& run_dir) {
        GDALAllRegister();
        const fs::path file = run_dir / "rasters" / "final_elevation.tif";
        const GDALDatasetUniquePtr raster(GDALDataset::Open(file.c_str(), GDAL_OF_RASTER));
        REQUIRE(raster);
        return std::string(raster->GetRasterBand(1)->GetDescription());
    };
    CHECK_THAT(described(stays), Contains("that of the start, since erodible.bed_evolves is false"));
    CHECK_THAT(described(slide.folder() / "follows"), !Contains("that of the start"));
}
