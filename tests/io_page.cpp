// The page of a run: what it holds is unpacked again and compared with what the run left.
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "base/atomic_file.h"
#include "base/error.h"
#include "catch.h"
#include "fresh_folder.h"
#include "io/deflate.h"
#include "observe/memory_archive.h"
#include "observe/table.h"
#include "program.h"
#include "run/web/web_page.h"
#include "vtk_io/reader.h"

using namespace frana;
using Catch::Matchers::Contains;
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::json;

const char* const title = "A \"hill\" <b>that</b> slides</script> & à l'été, \xff";

/// A slope of 30 x 20 nodes, 5 m apart, on which a body slides.
class Slope {
public:
    Slope() {
        std::string dem = "ncols 30\nnrows 20\nxllcorner 1000\nyllcorner 2000\ncellsize 5\nNODATA_value -9999\n";
        for (int row = 0; row < 20; ++row)
            for (int column = 0; column < 30; ++column)
                dem += row + column == 0 ? "-9999 " : fmt::format("{} ", 200.0 - 3.0 * column + 0.1 * row * row);
        write_text(path() / "dem.asc", dem);
        write_text(path() / "release.geojson",
                   R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":{},"geometry":{"type":)"
                   R"("Polygon","coordinates":[[[1020,2030],[1050,2030],[1050,2070],[1020,2070],[1020,2030]]]}}]})");
    }
    /// Runs the case into "run", with these formats and this depth.
    Outcome run(const std::string& formats, double depth = 1.5) const {
        write_text(
            path() / "case.toml",
            fmt::format("[case]\ntitle = \"Slope\"\n[terrain]\ndem = \"dem.asc\"\n[[release]]\noutline = "
                        "\"release.geojson\"\ndepth = {}\n[material.bed]\nlaw = \"coulomb\"\nmu = 0.3\n[time]\nend = "
                        "3\n[output]\nformats = {}\n[[barrier]]\nname = \"wall\"\nline = [[1090, 2020], [1090, "
                        "2080]]\nheight = 3\n[[gauge]]\nname = \"bridge\"\npoint = [1060, 2050]\n",
                        depth, formats));
        return call_frana(path(), "run case.toml --out run --overwrite --quiet");
    }
    /// Runs a case that is given in full into "run".
    Outcome run_case(const std::string& text) const {
        write_text(path() / "other.toml", text);
        return call_frana(path(), "run other.toml --out run --quiet");
    }
    const fs::path& path() const { return folder_.path(); }
    fs::path run_dir() const { return path() / "run"; }

private:
    FreshFolder folder_;
};

Json data_of(const std::string& page) {
    const std::string begin = "id=\"data\">";
    const std::size_t first = page.find(begin) + begin.size();
    return Json::parse(page.substr(first, page.find("</script>", first) - first));
}

GridGeometry grid_of(const Json& json, const Json& origin) {
    return {json.at("nx"), json.at("ny"), origin[0].get<double>() + json.at("x").get<double>(),
            origin[1].get<double>() + json.at("y").get<double>(), json.at("cell")};
}

/// Reads a page's frame as its script does.
PackedFrame frame_of(const Json& json, const Json& origin) {
    PackedFrame frame;
    frame.time = json.at("t");
    if (!json.contains("grid")) return frame;
    frame.grid = grid_of(json.at("grid"), origin);
    frame.deepest = json.at("deepest"), frame.has_speed = json.contains("fastest");
    if (frame.has_speed) frame.fastest = json.at("fastest");
    frame.bytes = from_base64(json.at("values"));
    return frame;
}

Raster hill() {
    Raster bed = Raster::filled({7, 5, 100.0, 200.0, 2.0}, 0.0);
    for (Index n = 0; n < bed.geometry.size(); ++n)
        bed.values[static_cast<std::size_t>(n)] = 1000.0 + 30.0 * std::sin(0.7 * static_cast<double>(n));
    bed.at(3, 2) = Raster::nodata;
    return bed;
}

/// A depth and a speed that grow from node to node; the first ones are dry.
struct Flow {
    std::vector<double> depth, speed;
    GridGeometry grid{40, 30, 0.0, 0.0, 5.0};
    Flow() {
        for (Index n = 0; n < grid.size(); ++n) {
            const double share = static_cast<double>(n) / static_cast<double>(grid.size());
            depth.push_back(n % grid.nx < 10 ? 0.0 : 20.0 * share * share);
            speed.push_back(30.0 * share);
        }
    }
    FlowFields fields() const { return {grid, depth.data(), speed.data()}; }
};

bool cannot_show() {
    if (!no_page_reason().empty()) WARN(no_page_reason() << "; this test is skipped");
    return !no_page_reason().empty();
}

}  // namespace

TEST_CASE("Bytes made small come back, and what is no such bytes is refused", "[page]") {
    const std::vector<std::uint8_t> bytes = {0, 1, 2, 255, 254, 0, 0, 0, 7};
    CHECK(from_base64(base64(bytes)) == bytes);
    CHECK(base64({'f', 'o', 'o', 'b'}) == "Zm9vYg==");  // RFC 4648, section 10
    CHECK(inflated(deflated(bytes), bytes.size()) == bytes);
    CHECK_THROWS_AS(inflated(deflated(bytes), bytes.size() - 1), UserError);
    CHECK_THROWS_AS(inflated(bytes, bytes.size()), UserError);
}

TEST_CASE("A packed raster comes back to half a step, without what has no value", "[page]") {
    const Raster bed = hill();
    const PackedRaster small = packed(bed, 0.01);
    CHECK(small.step == 0.01);
    const Raster back = unpacked(small);
    for (std::size_t n = 0; n < bed.values.size(); ++n) {
        REQUIRE(std::isnan(back.values[n]) == std::isnan(bed.values[n]));
        if (!std::isnan(bed.values[n])) CHECK(std::abs(back.values[n] - bed.values[n]) <= 0.5 * 0.01 + 1e-9);
    }
}

TEST_CASE("A packed frame holds each depth and speed to half of a step of its root", "[page]") {
    const Flow flow;
    const double wet = 0.001;
    const PackedFrame frame = packed(flow.fields(), wet, 1'000'000);
    CHECK(frame.grid == GridGeometry{30, 30, 50.0, 0.0, 5.0});
    const UnpackedFrame back = unpacked(frame);
    for (Index j = 0; j < 30; ++j)
        for (Index i = 0; i < 30; ++i) {
            const auto n = static_cast<std::size_t>(j * 30 + i), whole = static_cast<std::size_t>(j * 40 + i + 10);
            const double depth = flow.depth[whole], speed = flow.speed[whole];
            if (depth <= wet) {
                CHECK(back.depth[n] == 0.0);
                continue;
            }
            CHECK(back.depth[n] > 0.0);  // thin flow is not lost
            CHECK(std::abs(std::sqrt(back.depth[n]) - std::sqrt(depth)) <=
                  (0.5 / 255.0 + 1e-9) * std::sqrt(frame.deepest));
            CHECK(std::abs(std::sqrt(back.speed[n]) - std::sqrt(speed)) <=
                  (0.5 / 63.0 + 1e-9) * std::sqrt(frame.fastest));
        }
    const PackedFrame coarse = packed(flow.fields(), wet, 300);
    CHECK(coarse.grid == GridGeometry{15, 15, 52.5, 2.5, 10.0});
    CHECK(coarse.deepest == frame.deepest);
}

TEST_CASE("Frames that are too many thin out evenly, and a resumed run has the same ones", "[page]") {
    const Flow flow;
    FlowFrames frames(0.1, 5000);
    MemoryArchive kept;
    for (Index number = 0; number < 38; ++number)
        frames.add(number, 0.5 * static_cast<double>(number), flow.fields(), static_cast<double>(number));
    CHECK(frames.every() > 1);
    REQUIRE(frames.frames().size() > 3);
    CHECK(frames.frames().back().number == 37);
    for (std::size_t k = 0; k + 1 < frames.frames().size(); ++k)
        CHECK(frames.frames()[k].number == static_cast<Index>(k) * frames.every());
    frames.serialize(kept);
    FlowFrames again(0.1, 5000);
    kept.rewind();
    again.serialize(kept);
    for (FlowFrames* both : {&frames, &again}) both->add(38, 19.0, flow.fields());
    REQUIRE(again.frames().size() == frames.frames().size());
    for (std::size_t k = 0; k < frames.frames().size(); ++k) {
        const PackedFrame &a = frames.frames()[k], &b = again.frames()[k];
        CHECK(
            (a.number == b.number && a.time == b.time && a.grid == b.grid && a.bytes == b.bytes && a.lying == b.lying));
    }
}

TEST_CASE("A page holds any title, loads nothing, and says that nothing flowed", "[page]") {
    WebPage page;
    page.title = title;
    page.bed = hill();
    page.depth = {3.0, true};
    const std::string html = web_page(page);
    CHECK_THAT(
        html,
        Contains(
            "<title>A &quot;hill&quot; &lt;b&gt;that&lt;/b&gt; slides&lt;/script&gt; &amp; à l'été, \uFFFD</title>"));
    const Json data = data_of(html);
    CHECK(data.at("title") == "A \"hill\" <b>that</b> slides</script> & à l'été, \uFFFD");
    for (const char* from : {" src=", "<link", "url(", "fetch(", "import "})
        CHECK(html.find(from) == std::string::npos);
    CHECK(data.at("frames").empty());
    CHECK(data.at("drapes").empty());
    CHECK(data.at("runs").is_null());
    CHECK(data.at("depth").at("above") == true);
    CHECK(data.at("speed").at("above") == false);  // no sign of larger values where there are none
    PackedRaster terrain;
    const Json& json = data.at("terrain");
    terrain.grid = grid_of(json, data.at("origin"));
    terrain.low = json.at("low"), terrain.step = json.at("step"), terrain.bytes = from_base64(json.at("values"));
    CHECK(terrain.grid == page.bed.geometry);
    CHECK(std::abs(unpacked(terrain).at(6, 4) - page.bed.at(6, 4)) <= 0.5 * terrain.step);
}

TEST_CASE("The page of a run holds its frames, as its files for ParaView have them", "[page]") {
    if (cannot_show()) return;
    const Slope slope;
    REQUIRE(slope.run("[\"vtk\", \"geotiff\", \"web\"]").code == 0);
    const fs::path html = slope.run_dir() / "figures" / "view.html";
    const Json data = data_of(text_of(html)), record = Json::parse(text_of(slope.run_dir() / "run.json"));
    const auto& files = record.at("files");
    CHECK(std::find(files.begin(), files.end(), "figures/view.html") != files.end());
    const std::vector<double> times = frame_times(slope.run_dir());
    REQUIRE(data.at("frames").size() == times.size());
    for (std::size_t k = 0; k < times.size(); ++k) {
        const PackedFrame frame = frame_of(data.at("frames")[k], data.at("origin"));
        CHECK(frame.time == times[k]);
        const UnpackedFrame flow = unpacked(frame);
        const LoadedFrame written = read_frame(slope.run_dir(), static_cast<Index>(k));
        const auto shift_x = static_cast<Index>(std::lround((frame.grid.x0 - written.grid.x0) / frame.grid.cell));
        const auto shift_y = static_cast<Index>(std::lround((frame.grid.y0 - written.grid.y0) / frame.grid.cell));
        for (Index j = 0; j < frame.grid.ny; ++j)
            for (Index i = 0; i < frame.grid.nx; ++i) {
                const auto there = static_cast<std::size_t>((j + shift_y) * written.grid.nx + i + shift_x);
                const double depth = written.nodes.at("depth")[there];
                const double found = flow.depth[static_cast<std::size_t>(j * frame.grid.nx + i)];
                if (depth > 0.0011)  // a hundredth of the footprint depth, and round-off of float32
                    REQUIRE(std::abs(std::sqrt(found) - std::sqrt(depth)) <= 0.51 / 255.0 * std::sqrt(frame.deepest));
            }
    }
    CHECK(data.at("barriers")[0].at("name") == "wall");
    CHECK(data.at("gauges")[0].at("name") == "bridge");
    const Table history = read_table(slope.run_dir() / "history.csv");
    CHECK(data.at("curves").at("runout").back().get<double>() == Approx(history.column("front").back()).epsilon(1e-6));
    CHECK(data.at("curves").at("volume").front().get<double>() == Approx(record.at("release_volume")).epsilon(1e-6));

    // Drawn again it is the same page, but for numbers that come back from files in float32.
    fs::remove(html);
    REQUIRE(call_frana(slope.path(), "figures run --web").code == 0);
    const Json again = data_of(text_of(html));
    for (const char* part : {"terrain", "curves", "facts", "barriers", "gauges", "title", "notes"})
        CHECK(again.at(part) == data.at(part));
    REQUIRE(again.at("drapes").size() == data.at("drapes").size());
    for (std::size_t n = 0; n < data.at("drapes").size(); ++n)
        for (const char* key : {"name", "nx", "ny", "x", "y", "from", "to"})
            CHECK(again.at("drapes")[n].at(key) == data.at("drapes")[n].at(key));
    REQUIRE(again.at("frames").size() == times.size());
    for (std::size_t n = 0; n < times.size(); ++n) CHECK(again.at("frames")[n].at("t") == data.at("frames")[n].at("t"));
}

TEST_CASE("The page of a flood tells what came in, where its front is measured from, and what has become bed",
          "[page]") {
    if (cannot_show()) return;
    const Slope slope;
    const Outcome done = slope.run_case(
        "[case]\ntitle = \"Flood\"\n[terrain]\ndem = \"dem.asc\"\n[[inflow]]\nname = \"torrent\"\nline = [[1050, "
        "2035], [1050, 2065]]\nvolume = 400\npeak = 80\nvelocity = 4\n[material]\ndensity = "
        "1600\n[material.bed]\nlaw = \"coulomb\"\nmu = 0.7\n[deposition]\nlaw = \"rest\"\ntime = 1\n[time]\nend = "
        "20\n[output]\nevery = 5\nformats = [\"vtk\", \"web\"]\n");
    INFO(done.err);
    REQUIRE(done.code == 0);
    const Json record = Json::parse(text_of(slope.run_dir() / "run.json")), &budgets = record.at("budgets");
    const double lies = budgets.at("bed").at("lies_behind").get<double>() / 1600.0,
                 flows = budgets.at("mass").at("final").get<double>() / 1600.0;
    REQUIRE(lies > 10.0);
    const auto check = [&](const Json& data) {
        std::map<std::string, std::string> facts;
        for (const Json& fact : data.at("facts")) facts[fact[0]] = fact[1];
        CHECK(facts.count("Released") == 0);  // nothing was
        CHECK(facts["Came in"] == "400\u2009m\u00b3");
        CHECK(std::stod(facts["Became bed"]) == Approx(lies).epsilon(1e-2));  // three digits
        const Json& curves = data.at("curves");
        CHECK(curves.at("runout_name") == "Farthest front from the middle of inflow torrent");
        CHECK(curves.at("volume_name") == "Volume, with what has become bed");
        CHECK(curves.at("volume").back().get<double>() == Approx(flows + lies).epsilon(1e-6));  // float32 of frames
        // Between frames it went straight, though much comes to lie in few steps.
        const Table history = read_table(slope.run_dir() / "history.csv");
        const std::vector<double>&in = history.column("mass_in"), &left = history.column("mass_left");
        REQUIRE(curves.at("volume").size() == history.rows());
        for (std::size_t k = 0; k < history.rows(); ++k)
            REQUIRE(std::abs(curves.at("volume")[k].get<double>() - (in[k] - left[k]) / 1600.0) <= 1e-3);  // of 400 m3
    };
    check(data_of(text_of(slope.run_dir() / "figures" / "view.html")));
    REQUIRE(call_frana(slope.path(), "figures run --web").code == 0);
    check(data_of(text_of(slope.run_dir() / "figures" / "view.html")));
}

// It was divided by the density of the flow, while studies and rasters have the bed's own.
TEST_CASE("The page tells how much of the bed was taken as the bed had it", "[page][erosion]") {
    if (cannot_show()) return;
    const Slope slope;
    const Outcome done = slope.run_case(
        "[terrain]\ndem = \"dem.asc\"\n[[inflow]]\nname = \"torrent\"\nline = [[1050, 2035], [1050, 2065]]\nvolume = "
        "400\npeak = 80\nvelocity = 4\n[material]\ndensity = 1600\n[material.bed]\nlaw = \"coulomb\"\nmu = "
        "0.2\n[erodible]\ndepth = 0.5\ndensity = 2000\nlaw = \"growth\"\ngrowth = 0.005\n[time]\nend = "
        "10\n[output]\nevery = 5\nformats = [\"vtk\", \"geotiff\", \"web\"]\n");
    INFO(done.err);
    REQUIRE(done.code == 0);
    const Json record = Json::parse(text_of(slope.run_dir() / "run.json"));
    const double taken = record.at("budgets").at("bed").at("taken_of_bed").get<double>() / 2000.0;
    REQUIRE((taken > 10.0 && taken < 1000.0));
    const auto shown = [&] {
        std::map<std::string, std::string> facts;
        const Json data = data_of(text_of(slope.run_dir() / "figures" / "view.html"));
        for (const Json& fact : data.at("facts")) facts[fact[0]] = fact[1];
        return std::stod(facts["Taken of the bed"]);
    };
    CHECK(shown() == Approx(taken).epsilon(1e-2));  // three digits
    REQUIRE(call_frana(slope.path(), "figures run --web").code == 0);
    CHECK(shown() == Approx(taken).epsilon(1e-2));
}

TEST_CASE("The page of water has its volumes, drawn again too", "[page]") {
    if (cannot_show()) return;
    const Slope slope;
    const Outcome done = slope.run_case(
        "[case]\ntitle = \"Flood\"\n[terrain]\ndem = \"dem.asc\"\nwindow = [1005, 2000, 1150, "
        "2100]\n[[inflow]]\nname = \"torrent\"\nline = [[1050, "
        "2035], [1050, 2065]]\nvolume = 400\npeak = 80\n[water]\nmodel = "
        "\"free\"\nfriction = \"manning\"\nmanning_n = 0.05\ndensity = 1100\n[time]\nend = 5\n[output]\nformats "
        "= [\"vtk\", "
        "\"web\"]\n");
    INFO(done.err);
    REQUIRE(done.code == 0);
    const Json record = Json::parse(text_of(slope.run_dir() / "run.json"));
    CHECK(record.at("density") == 1100.0);
    const double flows = record.at("budgets").at("mass").at("final").get<double>() / 1100.0;
    const auto last_volume = [&] {
        return data_of(text_of(slope.run_dir() / "figures" / "view.html"))
            .at("curves")
            .at("volume")
            .back()
            .get<double>();
    };
    CHECK(last_volume() == Approx(flows).epsilon(1e-6));  // float32 of frames
    REQUIRE(call_frana(slope.path(), "figures run --web").code == 0);
    CHECK(last_volume() == Approx(flows).epsilon(1e-6));
}

TEST_CASE("A run without frames for ParaView has them on its page, and without the format there is no page", "[page]") {
    if (cannot_show()) return;
    const Slope slope;
    REQUIRE(slope.run("[\"web\"]").code == 0);
    CHECK(data_of(text_of(slope.run_dir() / "figures" / "view.html")).at("frames").size() > 2);
    REQUIRE(slope.run("[\"vtk\"]").code == 0);
    CHECK_FALSE(fs::exists(slope.run_dir() / "figures" / "view.html"));
}

TEST_CASE("A page of a large terrain shows it in blocks and says so", "[page]") {
    WebPage page;
    page.title = "large";
    page.bed = Raster::filled({801, 700, 0.0, 0.0, 5.0}, 3.0);
    const Json data = data_of(web_page(page));
    CHECK(data.at("terrain").at("nx") == 401);
    CHECK(data.at("terrain").at("cell") == 10.0);
    CHECK(data.at("terrain").at("x") == 2.5);
    CHECK_THAT(data.at("notes")[0].get<std::string>(), Contains("blocks of 2 x 2 cells"));
}
