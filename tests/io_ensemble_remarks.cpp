// Remarks that runs of ensembles and calibrations make must be those of a run of its own, told once.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/atomic_file.h"
#include "catch.h"
#include "plane_case.h"
#include "run/ensemble/kept_rows.h"

namespace fs = std::filesystem;
using Catch::Contains;
using Json = nlohmann::json;

namespace {

/// A square of 30 m along the slope, `wide` across it.
void write_square(const fs::path& file, double west, double wide) {
    frana::write_text(file, fmt::format(R"({{"type": "Polygon", "coordinates":
                                            [[[{0}, {2}], [{1}, {2}], [{1}, {3}], [{0}, {3}], [{0}, {2}]]]}})",
                                        west, west + 30.0, 50.0 - 0.5 * wide, 50.0 + 0.5 * wide));
}

/// Below its release nothing is reached by what is released when hit, far below.
class RemarkedSlide {
public:
    RemarkedSlide() {
        write_square(path("narrow.geojson"), 20.0, 8.0);
        write_square(path("far.geojson"), 115.0, 20.0);
        plane_.write(
            "[material.bed]\nlaw = \"coulomb\"\nmu = 0.05\n"
            "[[release]]\noutline = \"far.geojson\"\ndepth = 1.5\nwhen_hit = true\n"
            "[survey]\nfootprint = \"narrow.geojson\"\n");
        write("rows.csv",
              "release.0.outline,release.0.depth\nrelease.geojson,1.5\nnarrow.geojson,1.5\nnarrow.geojson,0.4\n"
              "gone.geojson,1.5\n");
        write("many.toml", "[ensemble]\ncase = \"case.toml\"\nmethod = \"table\"\ntable = \"rows.csv\"\n");
    }
    fs::path path(const std::string& name) const { return plane_.folder() / name; }
    void write(const std::string& name, const std::string& text) const { frana::write_text(path(name), text); }
    auto frana(const std::string& arguments) const { return plane_.frana(arguments); }
    Json json(const std::string& name) const { return Json::parse(text_of(path(name))); }

private:
    PlaneCase plane_;
};

/// Those of `all` that say this.
std::vector<Json> that_say(const Json& all, const std::string& words) {
    std::vector<Json> found;
    for (const Json& one : all)
        if (one.dump().find(words) != std::string::npos) found.push_back(one);
    return found;
}

}  // namespace

TEST_CASE("An ensemble tells each remark of its runs once, with their number and as the worst run has it",
          "[ensemble]") {
    const RemarkedSlide slide;
    const auto done = slide.frana("ensemble many.toml --out many");
    CHECK(done.code == 3);  // a run of four is refused
    std::size_t narrow = 0;
    std::string worst;
    for (const auto& [name, keys] :
         {std::pair{"wide", "--set release.0.outline=release.geojson"},
          std::pair{"narrow", "--set release.0.outline=narrow.geojson"},
          std::pair{"thin", "--set release.0.outline=narrow.geojson --set release.0.depth=0.4"}}) {
        REQUIRE(slide.frana(fmt::format("run CASE --quiet --set 'output.formats=[]' {} --out {}", keys, name)).code ==
                0);
        const auto found = that_say(slide.json(fmt::format("{}/run.json", name))["warnings"], "cells wide");
        narrow += found.size();
        if (!found.empty()) worst = found.front();
    }
    REQUIRE(narrow >= 2);  // of the last one there is most to say
    const Json remarks = slide.json("many/ensemble.json")["remarks_on_runs"];
    const auto wide = that_say(remarks, "cells wide"), late = that_say(remarks, "did not enter");
    REQUIRE(wide.size() == 1);
    CHECK(wide.front()["runs"] == narrow);
    CHECK(wide.front()["sample"] == 2);
    CHECK(wide.front()["remark"] == worst);
    REQUIRE(late.size() == 1);
    CHECK(late.front()["runs"] == 3);
    const std::string line = fmt::format("in {} of 4 runs, worst in sample 2: {}", narrow, worst);
    CHECK_THAT(text_of(slide.path("many/report.md")), Contains("\nRemarks on the runs:\n\n- ") && Contains(line));
    CHECK_THAT(done.out, Contains("remark      " + line));
    // Of what was stored the same is told.
    CHECK(slide.frana("ensemble --join many --quiet").code == 3);
    CHECK(slide.json("many/ensemble.json")["remarks_on_runs"] == remarks);
}

TEST_CASE("A calibration tells remarks of its runs by event, also where it goes on", "[ensemble]") {
    const RemarkedSlide slide;
    slide.write("find.toml",
                "[calibrate]\nsamples = 4\nrounds = 1\n"
                "[[calibrate.vary]]\nkey = \"material.bed.mu\"\nrange = [0.04, 0.06]\n"
                "[[event]]\ncase = \"case.toml\"\nname = \"slide\"\n");
    REQUIRE(slide.frana("calibrate find.toml --out found --quiet").code == 0);
    const Json remarks = slide.json("found/calibrate.json")["events"][0]["remarks_on_runs"];
    const auto late = that_say(remarks, "did not enter");
    REQUIRE(late.size() == 1);
    CHECK(late.front()["runs"] == 4);
    const std::string page = text_of(slide.path("found/report.md"));
    CHECK_THAT(page, Contains("slide: in 4 of 4 runs, such as sample 0: ") && Contains("did not enter"));
    fs::remove(slide.path("found/calibrate.json"));
    REQUIRE(slide.frana("calibrate find.toml --out found --resume --quiet").code == 0);
    CHECK(text_of(slide.path("found/report.md")) == page);
}

TEST_CASE("Rows with other columns, as of a build that stored no remarks, are refused with what to do", "[ensemble]") {
    const RemarkedSlide slide;
    CHECK(slide.frana("ensemble many.toml --out many --quiet").code == 3);
    const fs::path rows = slide.path("many/shards/0_of_1/runs.csv");
    std::string text = text_of(rows);
    REQUIRE(text.find(",remarks\n") != std::string::npos);
    frana::write_text(rows, text.replace(text.find(",remarks\n"), 8, ""));
    for (const char* how : {"ensemble --join many", "ensemble many.toml --out many --resume"}) {
        const auto old = slide.frana(how);
        CHECK(old.code == 2);
        CHECK_THAT(old.err, Contains("found rows of another build of frana") &&
                                Contains("choose another folder with --out and run the ensemble anew"));
    }
}

TEST_CASE("Remarks keep all of their letters in a row", "[ensemble]") {
    const std::vector<frana::EndRemark> remarks = {{"a, b | 100 %2C;\nc", -1.25}, {"none: 4,9,16", 0.0}};
    const std::string field = frana::remarks_field(remarks);
    CHECK(field.find_first_of(",\n\r") == std::string::npos);
    const std::vector<frana::EndRemark> back = frana::remarks_of_field(field);
    REQUIRE(back.size() == 2);
    for (std::size_t k = 0; k < 2; ++k) {
        CHECK(back[k].text == remarks[k].text);
        CHECK(back[k].worse == remarks[k].worse);
    }
    CHECK(frana::remarks_of_field("").empty());
    for (const char* broken : {"0", "x text", "0 text %2", "0 text %"})
        CHECK_THROWS_AS(frana::remarks_of_field(broken), std::logic_error);
}
