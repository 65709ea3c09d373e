// What `frana ensemble` tells of gauges, arrival, indices and hazard, on ponds whose answers are known.
#include <fmt/format.h>
#include <gdal_priv.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "catch.h"
#include "ensemble/statistics.h"
#include "io/deflate.h"
#include "pond.h"
#include "run/ensemble/maps.h"
#include "run/ensemble/outcomes.h"
#include "run/web/web_page.h"

namespace fs = std::filesystem;
using Catch::Contains;
using Json = nlohmann::json;

namespace {

/// All of the pond is released with the weight 0.7, else its west, which does not come to its east in half a second.
const std::string two_outlines =
    "[ensemble]\ncase = \"case.toml\"\nmethod = \"grid\"\nquantiles = [0.5, 0.95]\n"
    "fields = [\"peak_depth\", \"arrival_time\"]\n"
    "[[ensemble.vary]]\nkey = \"release.0.outline\"\ndistribution = \"discrete\"\n"
    "values = [\"all.geojson\", \"west.geojson\"]\nweights = [0.7, 0.3]\n";

const std::string gauges =
    "[[gauge]]\nname = \"west\"\npoint = [10, 30]\n[[gauge]]\nname = \"east\"\npoint = [50, 30]\n";

std::size_t pixel_at(const frana::Raster& map, double x, double y) {
    const frana::GridGeometry& g = map.geometry;
    return static_cast<std::size_t>(std::lround((y - g.y0) / g.cell) * g.nx + std::lround((x - g.x0) / g.cell));
}

}  // namespace

TEST_CASE("Of runs of unequal weight that failed the sentence says what a probability may be", "[ensemble]") {
    frana::EnsembleSummary summary;
    summary.samples = summary.run = 6, summary.failed = 1, summary.failed_share = 0.154;
    summary.weighted = true, summary.effective = 4.0;
    CHECK(
        runs_sentence(summary) ==
        "6 of 6 runs, which tell as much as 4 of equal weight; 1 with 0.154 of the weight failed: had these exceeded a "
        "threshold nowhere, a probability p of the maps would be 0.846 p, and had they exceeded it everywhere, 0.846 p "
        "+ 0.154.");
}

TEST_CASE("Gauges are outcomes of the ensemble, and maps of arrival tell when a share of the runs has come",
          "[ensemble]") {
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
    // The maps of arrival say the same everywhere: nothing where fewer runs come.
    const frana::Raster half = pond.map("many", "quantile_arrival_time_0.5"),
                        most = pond.map("many", "quantile_arrival_time_0.95");
    CHECK(half.values[pixel_at(half, 50, 30)] == 0.0);
    CHECK(most.values[pixel_at(most, 10, 30)] == 0.0);
    CHECK(std::isnan(most.values[pixel_at(most, 50, 30)]));
    CHECK_FALSE(fs::exists(pond.path("many/rasters/mean_arrival_time.tif")));
    CHECK_THAT(pond.frana("ensemble --join many --exceed arrival_time=30").err,
               Contains("expected FIELD=VALUE of peak_depth, since a late arrival is no greater hazard"));
    pond.write("many.toml", "[ensemble]\ncase = \"case.toml\"\nexceed = { arrival_time = [3] }\n" +
                                two_outlines.substr(two_outlines.find("method")));
    CHECK_THAT(pond.frana("ensemble many.toml --out other").err, Contains("found a threshold of a time"));
}

TEST_CASE("Indices stand on every pixel, of the numbers at gauges too", "[ensemble]") {
    const Pond pond;
    pond.write("case.toml", text_of(pond.path("case.toml")) + gauges);
    const std::string keys =
        "fields = [\"peak_depth\", \"peak_pressure\"]\n"
        "[[ensemble.vary]]\nkey = \"release.0.depth\"\nrange = [1.0, 2.0]\n"
        "[[ensemble.vary]]\nkey = \"material.density\"\nrange = [1000.0, 2000.0]\n";
    pond.write("many.toml",
               "[ensemble]\ncase = \"case.toml\"\nmethod = \"saltelli\"\nsamples = 8\nquantiles = []\n" + keys);
    REQUIRE(pond.frana("ensemble many.toml --out many --quiet").code == 0);
    const auto everywhere = [&](const std::string& name, double value, double margin) {
        CAPTURE(name);
        for (const double found : pond.map("many", name).values) CHECK(found == Approx(value).margin(margin));
    };
    // The depth of a pond hangs on nothing but the depth released; float32 keeps the fields.
    everywhere("first_order_peak_depth_release.0.depth", 1.0, 1e-6);
    everywhere("total_peak_depth_material.density", 0.0, 1e-6);
    const Json json = Json::parse(text_of(pond.path("many/ensemble.json")));
    CHECK(json["sensitivity"]["gauge_east_depth_m"]["release.0.depth"]["first_order"].get<double>() ==
          Approx(1.0).margin(1e-6));
    // The pressure rho g h: its two factors have the same relative spread, and hardly act together.
    const frana::Raster depth = pond.map("many", "total_peak_pressure_release.0.depth"),
                        density = pond.map("many", "total_peak_pressure_material.density");
    CHECK(depth.values[40] > 0.3);
    CHECK(density.values[40] > 0.3);
}

TEST_CASE("Shares of a variance that cannot be are told to be of too few samples", "[ensemble]") {
    const Pond pond;
    const std::string keys =
        "[[ensemble.vary]]\nkey = \"release.0.depth\"\nrange = [1.0, 2.0]\n"
        "[[ensemble.vary]]\nkey = \"material.density\"\nrange = [1000, 2000]\n";
    for (const int samples : {4, 5, 64}) {
        CAPTURE(samples);
        const std::string out = "of_" + std::to_string(samples);
        pond.write("many.toml", "[ensemble]\ncase = \"case.toml\"\nmethod = \"saltelli\"\nquantiles = []\nsamples = " +
                                    std::to_string(samples) + "\n" + keys);
        REQUIRE(pond.frana("ensemble many.toml --quiet --out " + out).code == 0);
        bool outside = false, crossed = false;
        const Json json = Json::parse(text_of(pond.path(out + "/ensemble.json")));
        for (const Json& outcome : json["sensitivity"])
            for (const Json& key : outcome)
                for (const char* share : {"first_order", "total"}) {
                    outside = outside || key[share] < -0.005 || key[share] > 1.005;  // as the table shows them
                    crossed = crossed || key["first_order"] > key["total"].get<double>() + 0.005;
                }
        CHECK(outside == (samples == 5));
        const bool told = text_of(pond.path(out + "/report.md")).find("Shares below 0 or above 1") != std::string::npos;
        CHECK(told == outside);
        CHECK(Contains("A first order above its total").match(text_of(pond.path(out + "/report.md"))) == crossed);
        CHECK(crossed == (samples == 4));
    }
}

TEST_CASE("Morris' mean effects stand on every pixel", "[ensemble]") {
    const Pond pond;
    pond.write("many.toml",
               "[ensemble]\ncase = \"case.toml\"\nmethod = \"morris\"\nsamples = 4\nquantiles = []\nfields = "
               "[\"peak_depth\"]\n"
               "[[ensemble.vary]]\nkey = \"release.0.depth\"\nrange = [1.0, 2.0]\n");
    REQUIRE(pond.frana("ensemble many.toml --out ways --quiet").code == 0);
    for (const double effect : pond.map("ways", "mean_effect_peak_depth_release.0.depth").values)
        CHECK(effect == Approx(1.0).margin(1e-6));  // of going through 1 to 2 m
}

TEST_CASE("Random samples come with Wilson's bounds of their probabilities", "[ensemble]") {
    const Pond pond;
    pond.write("many.toml",
               "[ensemble]\ncase = \"case.toml\"\nmethod = \"random\"\nsamples = 10\nquantiles = []\nfields = "
               "[\"peak_depth\"]\n"
               "exceed = { peak_depth = [1.25] }\n"
               "[[ensemble.vary]]\nkey = \"release.0.depth\"\nrange = [1.0, 2.0]\n");
    REQUIRE(pond.frana("ensemble many.toml --out many --quiet").code == 0);
    const double p = pond.map("many", "probability_peak_depth_1.25").values[40];
    const auto [low, high] = frana::wilson_bounds(p, 10.0);
    REQUIRE((p > 0.0 && p < 1.0));
    CHECK(pond.map("many", "probability_peak_depth_1.25_wilson_low").values[40] == Approx(low).epsilon(1e-6));
    CHECK(pond.map("many", "probability_peak_depth_1.25_wilson_high").values[40] == Approx(high).epsilon(1e-6));
}

TEST_CASE("Classes of hazard are a raster with colours and names, and areas in report and record",
          "[ensemble][hazard]") {
    const Pond pond;
    pond.write("many.toml",
               "[ensemble]\ncase = \"case.toml\"\nmethod = \"table\"\ntable = \"rows.csv\"\nfields = [\"peak_depth\"]\n"
               "quantiles = []\n[ensemble.hazard]\nyears = [30, 300]\n"
               "[[ensemble.hazard.class]]\nname = \"low & seldom\"\ncolour = \"#ffdd00\"\n"
               "[[ensemble.hazard.class]]\nname = \"high\"\ncolour = \"#d81e28\"\n"
               "[[ensemble.hazard.level]]\npeak_depth = 0.8\nclasses = [\"high\", \"low & seldom\", \"none\"]\n");
    // Once in 30 years the west, once in 300 all of the pond; shallower once in 10, which is no strength at all.
    pond.write("rows.csv",
               "release.0.outline,release.0.depth,return_period\n\"west.geojson\",1.5,30\n\"all.geojson\",1.5,300\n"
               "\"all.geojson\",0.5,10\n");
    REQUIRE(pond.frana("ensemble many.toml --out many --quiet").code == 0);
    const Json hazard = Json::parse(text_of(pond.path("many/ensemble.json")))["hazard"];
    const double low = hazard["classes"][0]["area_m2"], high = hazard["classes"][1]["area_m2"];
    CHECK(low + high == 3600.0);  // 12 x 12 pixels of 25 m2
    // Six columns of nodes are released; in half a second the edge stays within a cell of where it was.
    CHECK(high == Approx(6 * 12 * 25.0).margin(12 * 25.0));
    CHECK_THAT(text_of(pond.path("many/report.md")),
               Contains("| low & seldom |") && Contains("at least 50 % of its runs reach (`share`)"));
    GDALAllRegister();  // the run was another process
    const std::unique_ptr<GDALDataset, decltype(&GDALClose)> file(
        static_cast<GDALDataset*>(GDALOpen(pond.path("many/rasters/hazard_class.tif").c_str(), GA_ReadOnly)),
        GDALClose);
    REQUIRE(file);
    GDALRasterBand& band = *file->GetRasterBand(1);
    std::vector<std::uint8_t> row(12);
    REQUIRE(band.RasterIO(GF_Read, 0, 6, 12, 1, row.data(), 12, 1, GDT_Byte, 0, 0, nullptr) == CE_None);
    CHECK(row.front() == 2);
    CHECK(row.back() == 1);
    REQUIRE(band.GetColorTable() != nullptr);
    const GDALColorEntry& red = *band.GetColorTable()->GetColorEntry(2);
    CHECK((red.c1 == 0xd8 && red.c2 == 0x1e && red.c3 == 0x28));
    char** names = band.GetCategoryNames();
    REQUIRE(CSLCount(names) == 3);
    CHECK(std::string(names[1]) == "low & seldom");
    CHECK(band.GetNoDataValue() == 0.0);
    pond.write("event.toml", two_outlines +
                                 "[ensemble.hazard]\nyears = [30]\nreturn_period = 20\n"
                                 "[[ensemble.hazard.class]]\nname = \"high\"\ncolour = \"#d81e28\"\n"
                                 "[[ensemble.hazard.level]]\nclasses = [\"high\", \"none\"]\n");
    REQUIRE(pond.frana("ensemble event.toml --out event --quiet").code == 0);
    CHECK_THAT(text_of(pond.path("event/report.md")), Contains("comes back in 20 years (`return_period`)"));
}

TEST_CASE("The share of runs that have come goes on to the end of the runs", "[ensemble]") {
    const double never = std::numeric_limits<double>::infinity();
    const std::vector<frana::Vec2> corners = frana::growing_share({{2.0, 1.0}, {5.0, 1.0}, {never, 2.0}}, 4.0, 10.0);
    const std::vector<frana::Vec2> steps = {{2.0, 0.0}, {2.0, 0.25}, {5.0, 0.25}, {5.0, 0.5}, {10.0, 0.5}};
    CHECK(corners == steps);
    CHECK(frana::growing_share({{never, 1.0}}, 1.0, 10.0).empty());
}

TEST_CASE("A scenario without an answer is told with the classes of hazard, and classes not requested any more go",
          "[ensemble][hazard]") {
    const Pond pond;
    const std::string many =
        "[ensemble]\ncase = \"case.toml\"\nmethod = \"table\"\ntable = \"rows.csv\"\nfields = [\"peak_depth\"]\n"
        "quantiles = []\n";
    pond.write("many.toml", many +
                                "[ensemble.hazard]\nyears = [30]\n"
                                "[[ensemble.hazard.class]]\nname = \"high\"\ncolour = \"#d81e28\"\n"
                                "[[ensemble.hazard.level]]\nclasses = [\"high\", \"none\"]\n");
    pond.write("rows.csv",
               "release.0.outline,release.0.depth,return_period\n\"west.geojson\",1.5,30\n\"lost.geojson\",1.5,300\n");
    CHECK(pond.frana("ensemble many.toml --out many --quiet").code == 3);  // more than a twentieth failed
    const std::string told = "No run of the scenario of 300 years has an answer";
    CHECK_THAT(text_of(pond.path("many/report.md")), Contains(told));
    CHECK_THAT(text_of(pond.path("many/ensemble.json")), Contains(told));
    // The lost scenario is later than the table's years: no class, whatever it was. The other one has all its answers.
    const auto high = [&] { return Json::parse(text_of(pond.path("many/ensemble.json")))["hazard"]["classes"][0]; };
    CHECK(high()["area_m2"] > 0.0);
    CHECK(high()["area_if_unanswered_came_nowhere_m2"] == high()["area_m2"]);
    CHECK(high()["area_if_unanswered_came_everywhere_m2"] == high()["area_m2"]);
    CHECK(fs::exists(pond.path("many/rasters/hazard_class_at_least.tif")));
    CHECK(fs::exists(pond.path("many/rasters/hazard_class_at_most.tif")));
    CHECK(fs::exists(pond.path("many/rasters/hazard_class.tif")));
    // Once in 30 years the west floods, and two more runs of that scenario are lost: a third of them comes at least.
    pond.write("rows.csv",
               "release.0.outline,release.0.depth,return_period\n\"west.geojson\",1.5,30\n\"lost.geojson\",1.5,30\n"
               "\"lost.geojson\",1.6,30\n");
    CHECK(pond.frana("ensemble many.toml --out more --quiet").code == 3);
    const Json bounded = Json::parse(text_of(pond.path("more/ensemble.json")))["hazard"]["classes"][0];
    CHECK(bounded["area_m2"] > 0.0);
    CHECK(bounded["area_if_unanswered_came_nowhere_m2"] == 0.0);
    CHECK(bounded["area_if_unanswered_came_everywhere_m2"] == bounded["area_m2"]);
    CHECK_THAT(text_of(pond.path("more/report.md")),
               Contains("2 of 3 runs of the scenario of 30 years have no answer"));
    pond.write("many.toml", many);
    pond.write("rows.csv",
               "release.0.outline,release.0.depth,return_period\n\"west.geojson\",1.5,30\n\"lost.geojson\",1.5,300\n");
    CHECK(pond.frana("ensemble --join many --quiet").code == 3);
    CHECK_FALSE(fs::exists(pond.path("many/rasters/hazard_class.tif")));
    CHECK_FALSE(fs::exists(pond.path("many/rasters/hazard_class.tif.aux.xml")));
    CHECK_FALSE(fs::exists(pond.path("many/rasters/hazard_class_at_most.tif")));
    CHECK(fs::exists(pond.path("many/rasters/probability_reached.tif")));
}

TEST_CASE("Runs without weight count nowhere in classes of hazard", "[ensemble][hazard]") {
    const Pond pond;
    pond.write("many.toml",
               "[ensemble]\ncase = \"case.toml\"\nmethod = \"table\"\ntable = \"rows.csv\"\nfields = [\"peak_depth\"]\n"
               "quantiles = []\n[ensemble.hazard]\nyears = [30]\n"
               "[[ensemble.hazard.class]]\nname = \"high\"\ncolour = \"#d81e28\"\n"
               "[[ensemble.hazard.level]]\nclasses = [\"high\", \"none\"]\n");
    // Of each scenario a run is lost. Those that flood all of the pond have no weight.
    pond.write("rows.csv",
               "release.0.outline,release.0.depth,weight,return_period\n\"west.geojson\",1.5,1,30\n"
               "\"lost.geojson\",1.5,1,30\n\"all.geojson\",1.5,0,30\n\"lost.geojson\",1.5,1,300\n"
               "\"all.geojson\",1.6,0,300\n");
    CHECK(pond.frana("ensemble many.toml --out many --quiet").code == 3);  // more than a twentieth failed
    const Json hazard = Json::parse(text_of(pond.path("many/ensemble.json")))["hazard"], high = hazard["classes"][0];
    CHECK(hazard["remark"] ==
          "1 of 2 runs of the scenario of 30 years have no answer: classes may be wrong either way, within the bounds "
          "told. No run of the scenario of 300 years has an answer: its classes are missing. ");
    CHECK(high["area_m2"].get<double>() < 3600.0);  // of the pond
    CHECK(high["area_if_unanswered_came_everywhere_m2"] == high["area_m2"]);
}

TEST_CASE("The page of an ensemble holds the shares of its runs above each threshold, and their quantiles",
          "[ensemble][page]") {
    if (!frana::no_page_reason().empty()) {
        WARN(frana::no_page_reason() << "; this test is skipped");
        return;
    }
    const Pond pond;
    pond.write("many.toml",
               "[ensemble]\ncase = \"case.toml\"\nmethod = \"lhs\"\nsamples = 20\nquantiles = [0.5]\n"
               "fields = [\"peak_depth\"]\nexceed = { peak_depth = [1.234] }\n"
               "[[ensemble.vary]]\nkey = \"release.0.depth\"\nrange = [1.0, 2.0]\n");
    REQUIRE(pond.frana("ensemble many.toml --out many --quiet").code == 0);
    const std::string html = text_of(pond.path("many/figures/view.html")), begin = "id=\"data\">";
    const std::size_t first = html.find(begin) + begin.size();
    const Json runs = Json::parse(html.substr(first, html.find("</script>", first) - first)).at("runs");
    const Json ladder = runs.at("ladders").at(0);
    const auto table = [](const Json& json) {
        const frana::GridGeometry grid{json.at("nx"), json.at("ny"), 0.0, 0.0, 1.0};
        return frana::unpacked({grid, json.at("low"), json.at("step"), frana::from_base64(json.at("values"))});
    };
    const std::vector<double> thresholds = ladder.at("thresholds");
    const frana::Raster shares = table(ladder.at("probabilities")), median = table(ladder.at("quantiles"));
    REQUIRE(shares.geometry.ny == 144);  // all of the pond
    REQUIRE(shares.geometry.nx == static_cast<frana::Index>(thresholds.size()));
    CHECK(thresholds.front() == 0.1);  // below, nothing is kept
    CHECK(thresholds.at(ladder.at("first")) == 1.234);
    CHECK(std::is_sorted(thresholds.begin(), thresholds.end()));
    const frana::Raster map = pond.map("many", "probability_peak_depth_1.234"),
                        half = pond.map("many", "quantile_peak_depth_0.5");
    for (frana::Index row = 0; row < 144; ++row) {
        CHECK(shares.at(ladder.at("first"), row) == Approx(map.values[static_cast<std::size_t>(row)]).margin(1e-7));
        CHECK(median.at(0, row) == Approx(half.values[static_cast<std::size_t>(row)]).margin(1e-4));
        CHECK(shares.at(0, row) == Approx(1.0));
        CHECK(shares.at(shares.geometry.nx - 1, row) == 0.0);
    }
    // A depth between 1 and 2 m exceeds a threshold there with the share of the range above it, to one of 20 slices.
    for (std::size_t k = 0; k < thresholds.size(); ++k)
        if (thresholds[k] >= 1.0 && thresholds[k] <= 2.0)
            CHECK(shares.at(static_cast<frana::Index>(k), 70) == Approx(2.0 - thresholds[k]).margin(0.05 + 1e-6));
}

TEST_CASE("A run without weight reaches no place of an ensemble's page", "[ensemble][page]") {
    if (!frana::no_page_reason().empty()) {
        WARN(frana::no_page_reason() << "; this test is skipped");
        return;
    }
    const Pond pond;
    std::string weights = two_outlines;
    weights.replace(weights.find("[0.7, 0.3]"), 10, "[0.0, 1.0]");  // the run of all of the pond goes farthest
    pond.write("many.toml", weights);
    const auto done = pond.frana("ensemble many.toml --out many --quiet");
    INFO(done.err);
    REQUIRE(done.code == 0);
    const std::string html = text_of(pond.path("many/figures/view.html")), begin = "id=\"data\">";
    const std::size_t first = html.find(begin) + begin.size();
    const Json runs = Json::parse(html.substr(first, html.find("</script>", first) - first)).at("runs");
    const frana::Raster map = pond.map("many", "probability_reached");
    const auto reached = std::count_if(map.values.begin(), map.values.end(), [](double share) { return share > 0.0; });
    CHECK(reached > 0);
    CHECK(reached < 144);
    CHECK_THAT(html, Contains("1 choices") && !Contains("2 choices"));
    CHECK(runs.at("ladders").at(0).at("probabilities").at("ny") == reached);
}

TEST_CASE("The page of an ensemble gives a range of both ends alike", "[ensemble][page]") {
    if (!frana::no_page_reason().empty()) {
        WARN(frana::no_page_reason() << "; this test is skipped");
        return;
    }
    const Pond pond;
    const std::string cut = GENERATE("", "range = [1.0, 2.0]\n");
    CAPTURE(cut);
    pond.write("many.toml",
               "[ensemble]\ncase = \"case.toml\"\nmethod = \"lhs\"\nsamples = 6\nquantiles = [0.5]\n"
               "fields = [\"peak_depth\"]\n[[ensemble.vary]]\nkey = \"release.0.depth\"\n"
               "distribution = \"lognormal\"\nmedian = 1.5\nfactor = 1.2\n" +
                   cut);
    const auto done = pond.frana("ensemble many.toml --out many --quiet");
    INFO(done.err);
    REQUIRE(done.code == 0);
    std::vector<double> drawn;
    for (const std::string& depth : pond.column("many", "release.0.depth")) drawn.push_back(std::stod(depth));
    const auto [least, most] = std::minmax_element(drawn.begin(), drawn.end());
    CHECK_THAT(text_of(pond.path("many/figures/view.html")),
               Contains(cut.empty() ? fmt::format("{:.6g} to {:.6g}", *least, *most) : "1 to 2"));
}
