// What resolved.toml says of the cases that come with the program is accepted again.
#include <filesystem>
#include <fstream>
#include <sstream>

#include "catch.h"
#include "scene/case_file.h"

using namespace frana;
namespace fs = std::filesystem;

namespace {

const std::string kHead = "[terrain]\ndem = \"dem.tif\"\n[time]\nend = 20\n[material.bed]\nlaw = \"voellmy\"\n";
const std::string kRelease = "[[release]]\noutline = \"r.geojson\"\ndepth = 1.0\n";
const std::string kSize = "mu = 0.1\nxi = 400\n";
const std::string kInflow = "[[inflow]]\nname = \"spring\"\n";

void check_again(const CaseFile& file) {
    CAPTURE(file.file().string(), resolved_toml(file));
    CHECK_NOTHROW(CaseFile::parse(resolved_toml(file), file.file().parent_path() / "resolved.toml"));
}

}  // namespace

TEST_CASE("What resolved.toml says of a shipped case is a case", "[case][resolved]") {
    int found = 0;
    for (const auto& entry : fs::directory_iterator(fs::path(FRANA_SOURCE_DIR) / "cases")) {
        const fs::path file = entry.path() / "case.toml";
        if (!fs::exists(file)) continue;
        std::ostringstream text;
        text << std::ifstream(file).rdbuf();
        check_again(CaseFile::parse(text.str(), file));
        ++found;
    }
    CHECK(found >= 15);
}

TEST_CASE("What resolved.toml says of inflows, late releases, tables, forests and walls is a case",
          "[case][resolved]") {
    const auto again = [](const std::string& text) { check_again(CaseFile::parse(text, "/slide/case.toml")); };
    const std::string corners = "area = [[0, 0], [9, 0], [9, 9]]\n", line = "line = [[0, 0], [9, 0]]\n";
    again(kHead + kSize + kInflow + corners + "table = \"q.csv\"\n");
    again(kHead + kSize + kInflow + "area = \"spring.geojson\"\nvolume = 900\n");
    again(kHead + kSize + kInflow + line + "table = \"q.csv\"\nvelocity = \"column\"\n");
    again(kHead + kSize + kInflow + line + "volume = 900\npeak = \"rickenmann\"\ntowards = [3, 9]\n");
    again(kHead + kSize + kRelease + kRelease + "at = 3\n" + kRelease + "when_hit = true\n");
    again(kHead + "table = \"voellmy-salm\"\nreturn_period = 100\n" + kRelease);
    again(kHead + kSize + kRelease + "[forest]\ndetrainment = 20\n[deposition]\nlaw = \"rest\"\n");
    again(kHead + kSize + kRelease + "[erodible]\nlaw = \"shear\"\ndepth = 1\n[[barrier]]\nname = \"wall\"\n" + line +
          "height = 2\n[[barrier]]\nname = \"house\"\noutline = \"h.geojson\"\neach = true\nheight_field = \"h\"\n");
    again(kHead + kSize + kRelease +
          "[[section]]\nname = \"low\"\nline = \"low.geojson\"\n[[material.zone]]\nbelow = 9\nmu = 0.2\n");
}
