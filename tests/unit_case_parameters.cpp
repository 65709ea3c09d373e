// The parameter table as a whole, and the texts made from it.
#include <fstream>
#include <set>
#include <sstream>

#include "base/error.h"
#include "catch.h"
#include "scene/case_file.h"

using namespace frana;

TEST_CASE("describe mentions every key of the table with unit, default and meaning", "[case][describe]") {
    const std::string text = describe("");
    for (const Parameter& parameter : parameters()) {
        CAPTURE(parameter.key);
        const std::size_t begin = text.find("\n" + parameter.key);
        REQUIRE(begin != std::string::npos);
        const std::string entry = text.substr(begin, text.find("\n\n", begin) - begin);
        CHECK(entry.find(parameter.meaning) != std::string::npos);
        if (!parameter.unit.empty() && parameter.unit != "1")
            CHECK(entry.find("[" + parameter.unit + "]") == parameter.key.size() + 2);
        if (parameter.required) CHECK(entry.find("default: required") != std::string::npos);
    }
}

TEST_CASE("describe selects by key, by table and by beginning", "[case][describe]") {
    CHECK(describe("grid.cell") ==
          "[grid]\ngrid.cell [m]\n    node distance of the grid\n    value:   a number above 0 [m]\n    "
          "default: the pixel of "
          "the elevation model\n");
    CHECK(describe("release.0.depth") == describe("release.depth"));
    CHECK(describe("material").find("material.rheology.viscosity [Pa s]") != std::string::npos);
    CHECK(describe("material").find("scheme.cfl") == std::string::npos);
    CHECK(describe("xi").find("only with material.bed.law = voellmy") != std::string::npos);
    CHECK(describe("scheme.cfl")
              .find("default: 1.0; 0.25 with scheme.preset = \"paper\"; 0.5 with scheme.shape = \"linear\"") !=
          std::string::npos);
    CHECK(describe("barrier").find("height above the bed") != std::string::npos);
    CHECK_THROWS_WITH(describe("grid.cel2"), Catch::Contains("did you mean grid.cell?"));
}

TEST_CASE("cases/KEYS.md is what describe --markdown writes", "[case][describe]") {
    std::ifstream file(FRANA_SOURCE_DIR "/cases/KEYS.md");
    std::stringstream kept;
    kept << file.rdbuf();
    INFO("frana describe --markdown > cases/KEYS.md");
    CHECK(kept.str() == describe_in_markdown());
}

TEST_CASE("Every key is a row of four cells in Markdown", "[case][describe]") {
    std::istringstream page(describe_in_markdown());
    std::size_t rows = 0;
    for (std::string line; std::getline(page, line);) {
        if (line.compare(0, 3, "| `") != 0) continue;
        rows += 1;
        std::size_t bars = 0;
        for (std::size_t k = 0; k < line.size(); ++k) bars += line[k] == '|' && (k == 0 || line[k - 1] != '\\');
        CAPTURE(line);
        CHECK(bars == 5);
    }
    CHECK(rows == parameters().size());
}

TEST_CASE("Every entry of the table is sound", "[case][parameters]") {
    std::set<std::string> keys;
    for (const Parameter& parameter : parameters()) {
        CAPTURE(parameter.key);
        CHECK(keys.insert(parameter.key).second);
        CHECK_FALSE(parameter.meaning.empty());
        const bool conditional = !parameter.required_by.empty();
        CHECK((parameter.required || parameter.fallback || !parameter.absent.empty() || conditional ||
               !parameter.switch_key.empty()));
        if (!parameter.switch_key.empty()) REQUIRE(find_parameter(parameter.switch_key) != nullptr);
        for (const std::string& user : parameter.used_by) {
            const auto& choices = find_parameter(parameter.switch_key)->choices;
            CHECK(std::count(choices.begin(), choices.end(), user) == 1);
        }
        if (!parameter.instead_of.empty()) CHECK(find_parameter(parameter.instead_of)->instead_of == parameter.key);
        const auto* number = parameter.fallback ? std::get_if<double>(&*parameter.fallback) : nullptr;
        if (number) CHECK(parameter.range.holds(*number));
        const bool has_choices = parameter.kind == Kind::choice || parameter.kind == Kind::words;
        if (has_choices) CHECK_FALSE(parameter.choices.empty());
    }
}

TEST_CASE("The closest word is found through slips of the finger, not at random", "[case][parameters]") {
    const std::vector<std::string> words = {"coulomb", "voellmy", "manning"};
    CHECK(closest("colomb", words) == "coulomb");
    CHECK(closest("voelmly", words) == "voellmy");
    CHECK(closest("xyz", words).empty());
    CHECK(closest("", words).empty());
}

TEST_CASE("Values are written so that the same number is read back", "[case][parameters]") {
    CHECK(toml_text(5.0) == "5.0");
    CHECK(toml_text(0.1) == "0.1");
    CHECK(toml_text(1e-300) == "1e-300");
    CHECK(toml_text(std::string("a \"b\" \\ \n")) == "\"a \\\"b\\\" \\\\ \\u000A\"");
    CHECK(toml_text(std::vector<Vec2>{{1, 2}, {3, 4.5}}) == "[[1.0, 2.0], [3.0, 4.5]]");
}

TEST_CASE("resolved.toml says every key and reads back to itself", "[case][resolved]") {
    const std::string text = R"([case]
title = "A \"slide\""
[terrain]
dem = "dem.tif"
window = [0, 0, 100, 50]
[[release]]
outline = "r.geojson"
depth = 1.5
velocity = [1, 0.1]
[[release]]
surface = "pre.tif"
[particles]
count = 700
[material.bed]
law = "voellmy"
mu = 0.1
xi = 1e3
[scheme]
preset = "paper"
[time]
end = 20
[output]
fields = ["depth"]
[[profile]]
name = "axis"
line = [[0, 0], [100, 50]]
)";
    const CaseFile file = CaseFile::parse(text, "/data/slide/case.toml");
    const std::string resolved = resolved_toml(file);
    CAPTURE(resolved);
    CHECK(resolved.find("dem = \"/data/slide/dem.tif\"\n") != std::string::npos);
    CHECK(resolved.find("model = \"shallow\"  # default\n") != std::string::npos);
    CHECK(resolved.find("cfl = 0.25  # default\n") != std::string::npos);
    CHECK(resolved.find("mu = 0.1\n") != std::string::npos);
    CHECK(resolved.find("# cell: not given; the pixel of the elevation model\n") != std::string::npos);
    CHECK(resolved.find("per_cell") == std::string::npos);
    CHECK(resolved.find("manning_n") == std::string::npos);

    const CaseFile again = CaseFile::parse(resolved, "/elsewhere/resolved.toml");
    for (const Parameter& parameter : parameters()) {
        for (const std::string number : {"", "0.", "1."}) {
            const std::string key = parameter.table() + "." + number + parameter.name();
            const bool path = parameter.kind == Kind::path || parameter.kind == Kind::number_or_path;
            if (path || !file.given(key)) continue;
            CAPTURE(key);
            CHECK(*again.find(key) == *file.find(key));
        }
    }
    // A second time everything is given, so that only the marks of the defaults are gone.
    std::string without_marks = resolved;
    const std::string mark = "  # default";
    for (std::size_t at = without_marks.find(mark); at != std::string::npos; at = without_marks.find(mark, at))
        without_marks.erase(at, mark.size());
    const auto body = [](const std::string& whole) { return whole.substr(whole.find('\n')); };
    CHECK(body(resolved_toml(again)) == body(without_marks));
}
