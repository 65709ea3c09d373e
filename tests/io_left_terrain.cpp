// A flow that leaves the terrain: the run, its page, a comparison and a study of cells say so.
#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "catch.h"
#include "plane_case.h"
#include "run/web/web_page.h"

using namespace frana;
namespace fs = std::filesystem;
using Catch::Contains;
using Json = nlohmann::json;

namespace {

/// A slide down a plane of 150 m that is too short for it, over ground that it takes up; or it stops on the way.
struct ShortPlane : PlaneCase {
    explicit ShortPlane(bool stops = false) {
        write(fmt::format(
            "[material]\ndensity = 1600\n[material.bed]\nlaw = \"coulomb\"\nmu = {}\n[erodible]\nlaw = "
            "\"growth\"\ngrowth = 0.05\ndepth = 2.0\n[output]\nevery = 5\nformats = [\"geotiff\", \"web\"]\n",
            stops ? 0.3 : 0.03));
    }
    Json run() const {
        const Outcome done = frana("run CASE --quiet --set time.end=40 --out run");
        INFO(done.err);
        REQUIRE(done.code == 0);
        return Json::parse(text_of(folder() / "run/run.json"));
    }
};

std::string polygon(double x1) { return fmt::format("[[[20,20],[{0},20],[{0},80],[20,80],[20,20]]]", x1); }

/// Two that overlap on 60 x 60 m, and one that crosses itself.
std::string survey() {
    const std::string form =
        R"({{"type":"Feature","properties":{{}},"geometry":{{"type":"Polygon","coordinates":{}}}}})";
    return R"({"type":"FeatureCollection","features":[)" + fmt::format(fmt::runtime(form), polygon(80)) + "," +
           fmt::format(fmt::runtime(form), polygon(110)) + "," +
           fmt::format(fmt::runtime(form), "[[[115,40],[125,60],[125,40],[115,60],[115,40]]]") + "]}";
}

std::string fact_of(const fs::path& html, const std::string& name) {
    const std::string page = text_of(html), begin = "id=\"data\">";
    const std::size_t first = page.find(begin) + begin.size();
    const Json data = Json::parse(page.substr(first, page.find("</script>", first) - first));
    for (const Json& fact : data.at("facts"))
        if (fact[0] == name) return fact[1];
    return "";
}

}  // namespace

TEST_CASE("A run whose flow left the terrain says so first, with the share of all that flowed", "[program]") {
    const ShortPlane plane;
    const Json record = plane.run(), mass = record["budgets"]["mass"];
    const double left = mass["left_domain"], given = mass["initial"], taken = record["budgets"]["bed"]["taken_of_bed"];
    REQUIRE(left > given);  // so that its share of what was given would be above one
    const double share = left / (given + taken);
    CHECK(mass["left_share"].get<double>() == Approx(share).epsilon(1e-12));
    const std::string remark =
        fmt::format("terrain: {:.6g} m3, {:.3g} % of all that flowed, left it; ", left / 1600.0, 100.0 * share);
    CHECK_THAT(record["remarks"][0].get<std::string>(), Contains(remark) && Contains("lower bounds"));
    CHECK_THAT(text_of(plane.folder() / "run/report.md"), Contains("## Remarks\n\n- " + remark));
    if (no_page_reason().empty())
        CHECK(fact_of(plane.folder() / "run/figures/view.html", "Left the terrain") ==
              fmt::format("{:.3g} % of all that flowed", 100.0 * share));
}

TEST_CASE("A run whose flow stays on the terrain has no such remark, nor has what is made of it", "[program]") {
    const ShortPlane plane(true);
    const Json record = plane.run();
    CHECK(record["budgets"]["mass"]["left_share"] == 0.0);
    CHECK(record["remarks"].dump().find("left it") == std::string::npos);
    write_text(plane.folder() / "seen.geojson", survey());
    REQUIRE(plane.frana("compare run --survey seen.geojson").code == 0);
    CHECK(text_of(plane.folder() / "run/compare.md").find("left the terrain") == std::string::npos);
}

TEST_CASE("A comparison keeps what reading the survey said, and that the flow left the terrain", "[program][compare]") {
    const ShortPlane plane;
    plane.run();
    write_text(plane.folder() / "seen.geojson", survey());
    const Outcome done = plane.frana("compare run --survey seen.geojson");
    REQUIRE(done.code == 0);
    const std::string remarks = Json::parse(text_of(plane.folder() / "run/compare.json"))["remarks"].dump(),
                      page = text_of(plane.folder() / "run/compare.md");
    for (const std::string& text : {remarks, page, done.out}) {
        CHECK_THAT(text, Contains("of all that flowed left the terrain, so simulated runout"));
        CHECK_THAT(text, Contains("its polygons overlap by 3600 m2"));  // 60 m x 60 m
        CHECK_THAT(text, Contains("repaired"));
    }
}

TEST_CASE("A study of cells says that the flow left the terrain", "[program][converge]") {
    const ShortPlane plane;
    const Outcome done =
        plane.frana("converge CASE --cells 5,4 --quiet --set time.end=20 --set erodible.law=none --out study");
    INFO(done.err);
    REQUIRE(done.code == 0);
    const Json record = Json::parse(text_of(plane.folder() / "study/converge.json"));
    CHECK(record["left_share"][0].get<double>() > 0.5);
    CHECK(record["converged"] == false);
    CHECK(record["enough"].is_null());
    CHECK_THAT(record["remarks"][0].get<std::string>(), Contains("% on 5 m, ") && Contains("lower bounds"));
    CHECK_THAT(text_of(plane.folder() / "study/converge.md"),
               Contains("give a wider elevation model or terrain.window"));
}
