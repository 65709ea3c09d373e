// Terrains that are much larger than the flow: what a run takes of memory, what it shows, and what it refuses.
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "base/atomic_file.h"
#include "base/free_memory.h"
#include "catch.h"
#include "io_gdal_make.h"
#include "plane_case.h"
#include "program.h"

namespace fs = std::filesystem;
using Catch::Contains;

namespace {

constexpr int kPixels = 6000;
constexpr double kCell = 5.0, kWest = 600000.0, kSouth = 5200000.0;

/// Down to the south-east at 14 degrees, with bumps and a roughness of eighths of a metre.
double ground(double x, double y) {
    return 9000.0 - 0.25 * (x - kWest) - 0.1 * (kSouth - y) +
           std::round(8.0 * (4.0 * std::sin(0.01 * x) * std::cos(0.013 * y))) / 8.0;
}

/// A terrain of 6000 x 6000 pixels of 5 m, made once, with a release of 50 m x 50 m in its middle.
class LargeTerrain {
public:
    LargeTerrain() {
        RasterSpec spec;
        spec.columns = spec.rows = kPixels;
        spec.transform = {kWest, kCell, 0.0, kSouth + kPixels * kCell, 0.0, -kCell};
        spec.options = {"TILED=YES", "COMPRESS=DEFLATE", "ZLEVEL=1"};
        spec.value = [](int column, int row) {
            return ground(kWest + (column + 0.5) * kCell, kSouth + (kPixels - row - 0.5) * kCell);
        };
        make_raster(folder_.path() / "dem.tif", spec);
        std::ostringstream outline;
        const double x = kWest + 15000.0, y = kSouth + 15000.0;
        outline.precision(12);
        outline << R"({"type": "FeatureCollection", "crs": {"type": "name", "properties": {"name":
                   "urn:ogc:def:crs:EPSG::32632"}}, "features": [{"type": "Feature", "properties": {}, "geometry":
                   {"type": "Polygon", "coordinates": [[)"
                << "[" << x << "," << y << "],[" << x + 50 << "," << y << "],[" << x + 50 << "," << y + 50 << "],[" << x
                << "," << y + 50 << "],[" << x << "," << y << "]]]}}]}";
        frana::write_text(folder_.path() / "release.geojson", outline.str());
        frana::write_text(folder_.path() / "case.toml",
                          "[terrain]\ndem = \"dem.tif\"\n[[release]]\noutline = \"release.geojson\"\ndepth = 2\n"
                          "[material.bed]\nlaw = \"coulomb\"\nmu = 0.1\n[time]\nend = 4\n[output]\nevery = 2\n"
                          "formats = [\"vtk\", \"geotiff\", \"xdmf\"]\n");
        // The same with friction that varies, loose ground and trees, on rasters of 100 m and 20 m.
        spec.columns = spec.rows = 300;
        spec.transform = {kWest, 100.0, 0.0, kSouth + kPixels * kCell, 0.0, -100.0};
        spec.value = [](int column, int row) { return 0.0625 * (1 + (column + 2 * row) % 4); };
        make_raster(folder_.path() / "mu.tif", spec);
        spec.columns = spec.rows = 100;
        spec.transform = {kWest + 14000.0, 20.0, 0.0, kSouth + 16000.0, 0.0, -20.0};
        spec.value = [](int column, int row) { return 0.25 * ((column + row) % 3); };
        make_raster(folder_.path() / "loose.tif", spec);
        std::string text = text_of(folder_.path() / "case.toml");
        text.replace(text.find("mu = 0.1"), 8, "mu = \"mu.tif\"");
        frana::write_text(folder_.path() / "fields.toml",
                          text +
                              "[[material.zone]]\nbelow = 6000\nmu = 0.5\n[erodible]\nlaw = \"growth\"\n"
                              "growth = 0.05\ndepth = \"loose.tif\"\n[forest]\ndetrainment = 20\n");
        make_release_by_raster();
    }
    const fs::path& path() const { return folder_.path(); }

private:
    /// The same place by depths on pixels of 10 m of all the terrain, all but 25 of them 0.
    void make_release_by_raster() {
        RasterSpec spec;
        spec.columns = spec.rows = kPixels / 2;
        spec.transform = {kWest, 10.0, 0.0, kSouth + kPixels * kCell, 0.0, -10.0};
        spec.options = {"TILED=YES", "COMPRESS=DEFLATE", "ZLEVEL=1"};
        spec.value = [](int column, int row) {
            return column >= 1500 && column < 1505 && row >= 1495 && row < 1500 ? 1.0 + 0.25 * (column % 2) : 0.0;
        };
        make_raster(folder_.path() / "depth.tif", spec);
        std::string text = text_of(folder_.path() / "case.toml");
        text.replace(text.find("outline"), text.find("[material") - text.find("outline"), "depth = \"depth.tif\"\n");
        frana::write_text(folder_.path() / "raster.toml", text);
    }
    FreshFolder folder_;
};

const LargeTerrain& large_terrain() {
    static const LargeTerrain terrain;
    return terrain;
}

bool executes(pid_t process, const fs::path& program) {
    std::error_code gone;
    return fs::read_symlink("/proc/" + std::to_string(process) + "/exe", gone) == program;
}

/// Largest memory that `frana ARGUMENTS` had in the folder [bytes]; fails the test when it does not leave with 0.
double peak_memory(const fs::path& folder, const std::vector<std::string>& arguments) {
    const fs::path program = fs::canonical(fs::read_symlink("/proc/self/exe").parent_path() / "frana");
    const pid_t child = fork();
    if (child == 0) {
        std::vector<char*> argv{const_cast<char*>(program.c_str())};
        for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
        argv.push_back(nullptr);
        if (chdir(folder.c_str()) == 0) execv(program.c_str(), argv.data());
        _exit(127);
    }
    // Not wait4's ru_maxrss: it has what the tests' own process had at the fork.
    int status = 0;
    double most = 0.0;
    while (waitpid(child, &status, WNOHANG) == 0) {
        if (executes(child, program)) {
            std::ifstream file("/proc/" + std::to_string(child) + "/status");
            std::string line;
            while (std::getline(file, line))
                if (line.rfind("VmHWM:", 0) == 0) most = std::stod(line.substr(6));
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    REQUIRE(WIFEXITED(status));
    REQUIRE(WEXITSTATUS(status) == 0);
    return 1024.0 * most;
}

}  // namespace

TEST_CASE("A run on a large terrain takes memory by what the flow reaches", "[terrain]") {
    const fs::path folder = large_terrain().path();
    const std::string file = GENERATE("case.toml", "fields.toml", "raster.toml");
    INFO(file);
    const double bytes = peak_memory(folder, {"run", file, "--quiet", "--out", "large", "--overwrite"});
    // The elevations of all of the terrain, as doubles, with their slopes alone would be 36e6 x 24 bytes. The part that
    // the flow needs has 1250 x 1250 nodes of 160 bytes; the program itself takes 85 MB, before it draws anything.
    CHECK(bytes < 24.0 * kPixels * kPixels);
    CHECK(bytes < 0.5e9);
    const auto record = nlohmann::json::parse(std::ifstream(folder / "large" / "run.json"));
    CHECK(record["grid"]["nx"] == kPixels);
    const Outcome check = call_frana(folder, "check " + file);
    CHECK(check.code == 0);
    CHECK_THAT(check.out, Contains("6000 x 6000 nodes, 5 m apart") && Contains("around the releases to begin with") &&
                              Contains("ready to run"));
}

// With pictures it was told to take up to half more than it does.
TEST_CASE("A run takes the memory that check predicts, with pictures and without", "[memory][figures]") {
    const PlaneCase scene;
    const std::string formats = GENERATE("[\"vtk\",\"geotiff\"]", "[\"vtk\",\"geotiff\",\"png\"]");
    scene.write("[output]\nformats = " + formats + "\n");
    const Outcome check = scene.frana("check CASE");
    const std::string before = "memory      about ";
    const std::size_t at = check.out.find(before);
    REQUIRE(at != std::string::npos);
    const double told = 1e6 * std::stod(check.out.substr(at + before.size()));
    const double taken = peak_memory(scene.folder(), {"run", "case.toml", "--quiet", "--out", "taken"});
    CAPTURE(formats, told, taken);
    CHECK(told == Approx(taken).epsilon(0.2));  // apps/README.md
}

TEST_CASE("A run on a large terrain has the bits of a run on a window of it", "[terrain]") {
    const fs::path folder = large_terrain().path();
    const std::string file = GENERATE("case.toml", "fields.toml", "raster.toml");
    INFO(file);
    REQUIRE(call_frana(folder, "run " + file + " --quiet --out whole --overwrite").code == 0);
    // 2001 pixels from the west, 1903 from the south: no multiple of a tile.
    std::ostringstream window;
    window.precision(12);
    window << "[" << kWest + 2001 * kCell << "," << kSouth + 1903 * kCell << "," << kWest + 4000 * kCell << ","
           << kSouth + 4100 * kCell << "]";
    REQUIRE(call_frana(folder, "run " + file + " --quiet --out window --overwrite --set terrain.window=" + window.str())
                .code == 0);
    CHECK(text_of(folder / "whole" / "history.csv") == text_of(folder / "window" / "history.csv"));
    std::vector<std::string> files{"rasters/peak_depth.tif", "rasters/peak_speed.tif", "rasters/arrival_time.tif",
                                   "grid/grid_000002.vti", "particles/particles_000002.vtp"};
    if (file == std::string("fields.toml"))
        for (const char* name : {"mu", "eroded_depth", "deposited_depth"})
            files.push_back(fmt::format("rasters/{}.tif", name));
    for (const std::string& product : files) {
        INFO(product);
        REQUIRE(fs::exists(folder / "whole" / product));
        CHECK(text_of(folder / "whole" / product) == text_of(folder / "window" / product));
    }
}

TEST_CASE("Rasters of a large terrain show where the flow was, on the terrain's pixels", "[terrain]") {
    const fs::path folder = large_terrain().path();
    REQUIRE(call_frana(folder, "run case.toml --quiet --out shown --overwrite").code == 0);
    std::unique_ptr<GDALDataset> raster(GDALDataset::Open((folder / "shown/rasters/peak_depth.tif").c_str()));
    REQUIRE(raster);
    double transform[6];
    raster->GetGeoTransform(transform);
    CHECK(raster->GetRasterXSize() < 200);
    CHECK(raster->GetRasterYSize() < 200);
    CHECK(transform[1] == kCell);
    CHECK(std::fmod(transform[0] - kWest, kCell) == 0.0);
    CHECK(std::fmod(transform[3] - kSouth, kCell) == 0.0);
    CHECK(transform[0] < kWest + 15000.0);
    CHECK(transform[0] + kCell * raster->GetRasterXSize() > kWest + 15050.0);
    // What is made after the run finds its way: pictures, points, a state that goes on.
    CHECK(call_frana(folder, "figures shown").code == 0);
    CHECK(call_frana(folder, "convert shown --spacing 1 --time 2 --out points.vtp").code == 0);
    const Outcome on = call_frana(folder, "run case.toml --quiet --out shown --resume");
    CHECK(on.code == 0);
}

// Rasters end near the flow. What lay beyond counted as outside of the terrain, and paths ended there.
TEST_CASE("A survey beyond the rasters of a run on a part of the terrain is compared as on all of it",
          "[terrain][compare]") {
    const fs::path folder = large_terrain().path();
    const auto geometry = [&](const std::string& name, const std::string& type, std::vector<std::array<double, 2>> way,
                              const char* open, const char* close) {
        std::string points;
        for (const auto& [x, y] : way)
            points +=
                fmt::format("{}[{:.2f}, {:.2f}]", points.empty() ? "" : ", ", kWest + 15000 + x, kSouth + 15000 + y);
        frana::write_text(folder / name,
                          fmt::format(R"({{"type": "FeatureCollection", "crs": {{"type": "name", "properties": {{"name":
                   "urn:ogc:def:crs:EPSG::32632"}}}}, "features": [{{"type": "Feature", "properties": {{}}, "geometry":
                   {{"type": "{}", "coordinates": {}{}{}}}}}]}})",
                                      type, open, points, close));
    };
    geometry("long.geojson", "Polygon", {{0, 0}, {40, 60}, {1800, -600}, {1700, -800}, {0, 0}}, "[[", "]]");
    geometry("uphill.geojson", "LineString", {{1750, -700}, {25, 25}}, "[", "]");
    // So large that a part of it is held: 512 nodes and more around the release are.
    const std::string run = "run case.toml --quiet --overwrite --set terrain.window=[614500,5209000,623000,5215500] ";
    REQUIRE(call_frana(folder, run + "--out near").code == 0);
    REQUIRE(call_frana(folder, run + "--out all --set output.extent=terrain").code == 0);
    const auto compared = [&](const std::string& name, const std::string& more) {
        const Outcome done = call_frana(folder, "compare " + name + " --survey long.geojson" + more);
        INFO(done.err);
        REQUIRE(done.code == 0);
        return nlohmann::json::parse(text_of(folder / name / "compare.json"));
    };
    for (const std::string path : {"", " --path uphill.geojson"}) {
        CAPTURE(path);
        const nlohmann::json near = compared("near", path), all = compared("all", path);
        CHECK(all["survey_area_outside"] == 0.0);
        for (const char* key : {"survey_area_outside", "runout_survey", "runout_simulated", "iou", "survey_area"}) {
            CAPTURE(key);
            CHECK(near[key].get<double>() == Approx(all[key].get<double>()).epsilon(1e-9));
        }
        CHECK_THAT(near["remarks"].dump(), !Contains("outside"));
        if (!path.empty()) CHECK_THAT(near["remarks"].dump(), Contains("drawn uphill"));
    }
    std::string keys = text_of(folder / "near" / "resolved.toml");
    frana::write_text(folder / "near" / "resolved.toml", keys.replace(keys.find("dem.tif"), 7, "gone.tif"));
    const nlohmann::json near = compared("near", "");
    CHECK(near["survey_area_outside"] > 0.0);
    CHECK_THAT(near["remarks"].dump(), Contains("since the survey reaches beyond the run's rasters"));
}

TEST_CASE("The growth that check tells is that of the path over all of the terrain", "[terrain][erosion]") {
    // Held in part, and held in whole, on the same window: the path goes on for kilometres beyond the part.
    const std::string check =
        "check fields.toml --set terrain.window=[612000,5209000,624000,5218000] --set erodible.depth=0.5 "
        "--set erodible.growth=0.002";
    const auto remark = [&](const std::string& arguments) {
        const Outcome told = call_frana(large_terrain().path(), arguments);
        INFO(told.err);
        REQUIRE(told.code == 0);
        const std::size_t from = told.out.find("remark      erodible.growth: found ");
        REQUIRE(from != std::string::npos);
        return told.out.substr(from, told.out.find('\n', from) - from);
    };
    const std::string whole = remark(check + " --set output.extent=terrain");
    CHECK(remark(check) == whole);
}

TEST_CASE("A terrain that does not fit into memory is refused by all commands before it is read", "[terrain]") {
    const FreshFolder folder;
    RasterSpec spec;
    spec.columns = spec.rows = 22000;  // 4.8e8 nodes of 315 bytes and more
    spec.transform = {kWest, 1.0, 0.0, kSouth + 22000.0, 0.0, -1.0};
    constexpr double kNeeded = 315.0 * 22000.0 * 22000.0;
    if (frana::free_memory() > kNeeded) {
        WARN("skipped: this system has more than 150 GB of free memory");
        return;
    }
    fs::copy(large_terrain().path() / "release.geojson", folder.path() / "release.geojson");
    CPLStringList options;
    options.SetNameValue("SPARSE_OK", "TRUE");
    options.SetNameValue("TILED", "YES");
    std::unique_ptr<GDALDataset> file(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
        (folder.path() / "dem.tif").c_str(), spec.columns, spec.rows, 1, GDT_Float32, options));
    REQUIRE(file);
    file->SetGeoTransform(spec.transform.data());
    file->SetProjection(wkt_of("EPSG:32632").c_str());
    file.reset();
    frana::write_text(folder.path() / "case.toml",
                      "[terrain]\ndem = \"dem.tif\"\n[[release]]\noutline = \"release.geojson\"\ndepth = 2\n"
                      "[material.bed]\nlaw = \"coulomb\"\nmu = 0.1\n[time]\nend = 4\n[output]\nextent = \"terrain\"\n");
    for (const char* command :
         {"check case.toml", "run case.toml --out run", "converge case.toml --cells 1,2 --out study"}) {
        INFO(command);
        const Outcome outcome = call_frana(folder.path(), command);
        CHECK(outcome.code == 2);
        CHECK_THAT(outcome.err,
                   Contains("terrain.window: found ") && Contains(" nodes of ") && Contains(" GB that are free"));
        CHECK_THAT(outcome.out, !Contains("ready to run"));
        CHECK_FALSE(fs::exists(folder.path() / "run"));
    }
}
