// Releases that enter later, of a case: what they become, and what is refused.
#include "catch.h"
#include "scene/build_scene.h"
#include "scene/flow_start.h"
#include "slope_case.h"

using namespace frana;
using namespace frana::test;

namespace {

const std::string kHead = "[terrain]\ndem = \"dem.tif\"\n[time]\nend = 20\n";
const std::string kFirst = "[[release]]\noutline = \"release.geojson\"\ndepth = 2\n";
const std::string kSecond = "[[release]]\noutline = \"second.geojson\"\ndepth = 1\n";

FakeGis two_outlines() {
    FakeGis gis = slope_gis();
    gis.polygons["second.geojson"] = rectangle(1020, 2050, 1040, 2080);
    return gis;
}

Scene built(const std::string& text) {
    return build_scene(CaseFile::parse(kHead + text, "slide/case.toml"), two_outlines());
}

bool says(const std::string& text, const std::string& end) {
    const std::string problem = only_problem([&] { built(text); });
    CAPTURE(problem);
    return problem.find(end) != std::string::npos && problem.find("; expected") != std::string::npos;
}

}  // namespace

TEST_CASE("A release with a time has the particles that it would have at the start", "[scene][late]") {
    const Scene now = built(kSecond + kFirst), later = built(kSecond + "at = 7.5\n" + kFirst),
                hit = built(kSecond + "when_hit = true\n" + kFirst);
    REQUIRE(later.late.size() == 1);
    REQUIRE(hit.late.size() == 1);
    CHECK(now.late.empty());
    CHECK(later.late[0].name == "release.0 (second.geojson)");
    CHECK(later.late[0].at == 7.5);
    CHECK_FALSE(hit.late[0].at.has_value());
    const Index count = later.late[0].seeds.count();
    CHECK(count == 20 * 30 * 4 / 25);
    CHECK(later.late[0].volume() == Approx(600.0).epsilon(1e-12));
    CHECK(later.late[0].first_id == later.particles.count());
    CHECK(now.particles.count() == later.particles.count() + count);
    for (Index p = 0; p < count; ++p) {
        CHECK(later.late[0].seeds.x[p] == now.particles.x[p]);
        CHECK(hit.late[0].seeds.volume[p] == now.particles.volume[p]);
    }
    CHECK(later.particles.x.front() == now.particles.x[static_cast<std::size_t>(count)]);
    CHECK(later.particles.depth.back() == now.particles.depth.back());
}

TEST_CASE("at = 0 is a release at the start, and so is one whose defaults were written out", "[scene][late]") {
    CHECK(built(kFirst + "at = 0.0\nwhen_hit = false\n").late.empty());
    CHECK(built(kSecond + "at = 0.0\nwhen_hit = true\n" + kFirst).late.size() == 1);
    const CaseFile file = CaseFile::parse(kHead + kSecond + "when_hit = true\n" + kFirst, "slide/case.toml");
    CHECK_NOTHROW(CaseFile::parse(resolved_toml(file), "slide/resolved.toml"));
}

TEST_CASE("All releases may enter later, and their features' depths are one release", "[scene][late]") {
    FakeGis gis = two_outlines();
    gis.polygons["release.geojson"].parts.push_back(rectangle(1110, 2050, 1120, 2080).parts[0]);
    gis.attributes["h"] = {2.0, 1.0};
    const std::string text =
        kHead + "[[release]]\noutline = \"release.geojson\"\ndepth = \"field:h\"\nat = 3\n" + kSecond + "at = 1\n";
    const Scene scene = build_scene(CaseFile::parse(text, "slide/case.toml"), gis);
    CHECK(scene.particles.count() == 0);
    REQUIRE(scene.late.size() == 2);
    CHECK(scene.late[0].volume() == Approx(2.0 * 1500.0 + 300.0).epsilon(1e-12));
    CHECK(scene.late[0].at == 3.0);
    CHECK(scene.late[1].at == 1.0);
    CHECK(scene.late[1].first_id == scene.late[0].seeds.count());
}

TEST_CASE("A flow begins with what lies there at the start, else with what comes first", "[scene][late][inflow]") {
    const auto start = [](const std::string& text) { return flow_start(built(text)).value(); };
    const auto in_first = [](const Vec2& at) { return at.x() > 1045.0; };  // the second ends at 1040
    CHECK(in_first(start(kFirst)));
    // Late releases pull no middle to themselves, whether they enter or not.
    CHECK(start(kFirst + kSecond + "at = 7.5\n") == start(kFirst));
    CHECK(start(kFirst + kSecond + "when_hit = true\n") == start(kFirst));
    CHECK_FALSE(in_first(start(kFirst + "at = 7.5\n" + kSecond + "at = 3\n")));
    CHECK(in_first(start(kFirst + "at = 2.5\n" + kSecond + "at = 3\n")));
    const std::string inflow =
        "[[inflow]]\nname = \"torrent\"\nline = [[1150, 2060], [1150, 2080]]\nvolume = 500\nvelocity = 3\n";
    CHECK(start(inflow + kFirst + "at = 5\n").x() == Approx(1150.0));
    CHECK(start(inflow + kFirst + "when_hit = true\n").x() == Approx(1150.0));
}

TEST_CASE("What the front is measured from has a name", "[scene][late][inflow]") {
    const auto origin = [](const std::string& text) { return front_origin(built(text)); };
    const std::string inflow =
        "[[inflow]]\nname = \"torrent\"\nline = [[1150, 2060], [1150, 2080]]\nvolume = 500\nvelocity = 3\n";
    CHECK(origin(kFirst) == "the release's centre");
    CHECK(origin(inflow) == "the middle of inflow torrent");
    CHECK(origin(kFirst + "at = 5\n") == "the centre of what is released later");
    // What comes in elsewhere is a front as well, as far off as that place is.
    CHECK(origin(kFirst + inflow) == "the release's centre, of all that comes in anywhere");
    CHECK(origin(inflow + kFirst + "at = 5\n") == "the middle of inflow torrent, of all that comes in anywhere");
}

TEST_CASE("Each inflow and late release begins a flow, in the order in which they come", "[scene][late][inflow]") {
    const auto starts = [](const std::string& text) { return starts_of_what_comes_in(built(text)); };
    CHECK(starts(kFirst + kSecond).empty());
    CHECK(starts(kFirst + kSecond + "when_hit = true\n").empty());
    CHECK(starts(kFirst + kSecond + "at = 7.5\n").size() == 1);
    const std::string inflow =
        "[[inflow]]\nname = \"torrent\"\nline = [[1150, 2060], [1150, 2080]]\n"
        "volume = 500\nvelocity = 3\n";
    const std::vector<Vec2> all = starts(inflow + kFirst + "at = 5\n" + kSecond + "at = 1\n");
    REQUIRE(all.size() == 3);
    CHECK(all[0].x() == Approx(1150.0));  // from the start on
    CHECK(all[1].x() < 1045.0);
    CHECK(all[2].x() > 1045.0);
}

TEST_CASE("A later release that stands in the elevation model leaves it when it enters", "[scene][late][scar]") {
    const std::string included = "included_in_dem = true\n";
    const Scene bare = built(kFirst + kSecond + "at = 7.5\n"), now = built(kFirst + kSecond + included);
    CHECK(bare.late[0].scar.empty());
    CHECK_FALSE(bare.bed_changes());
    for (const char* when : {"at = 7.5\n", "when_hit = true\n"}) {
        const Scene later = built(kFirst + kSecond + when + included);
        REQUIRE(later.late.size() == 1);
        CHECK(later.bed_changes());
        CHECK(later.bed_evolves());
        CHECK(later.bed.values == bare.bed.values);  // not yet
        CHECK(later.late[0].seeds.x == bare.late[0].seeds.x);
        CHECK(later.log.back() == "release.1: its 600 m3 are cut out of the bed when it enters (included_in_dem)");
        const GridGeometry& g = later.bed.geometry;
        Raster cut = later.bed;
        double volume = 0.0;
        for (const ScarNode& node : later.late[0].scar) {
            CHECK(node.depth > 0.0);
            cut.at(std::lround((node.at.x() - g.x0) / g.cell), std::lround((node.at.y() - g.y0) / g.cell)) -=
                node.depth;
            volume += node.depth * g.cell * g.cell;
        }
        CHECK(volume == Approx(600.0).epsilon(1e-14));
        for (std::size_t k = 0; k < cut.values.size(); ++k)
            CHECK(cut.values[k] == Approx(now.bed.values[k]).epsilon(1e-14));
    }
    // Of two, the one that is cut at the start does not stay for later; features of other depths are one release.
    FakeGis gis = two_outlines();
    gis.polygons["release.geojson"].parts.push_back(rectangle(1110, 2050, 1120, 2080).parts[0]);
    gis.attributes["h"] = {2.0, 1.0};
    const Scene both = build_scene(
        CaseFile::parse(kHead + "[[release]]\noutline = \"release.geojson\"\ndepth = \"field:h\"\nat = 3\n" + included +
                            kSecond + included,
                        "slide/case.toml"),
        gis);
    REQUIRE(both.late.size() == 1);
    double volume = 0.0;
    for (const ScarNode& node : both.late[0].scar)
        volume += node.depth * both.bed.geometry.cell * both.bed.geometry.cell;
    CHECK(volume == Approx(3300.0).epsilon(1e-14));
    CHECK(both.bed.values == now.bed.values);
}

TEST_CASE("What a late release cannot be is said in a sentence", "[scene][late]") {
    CHECK(says(kFirst + kSecond + "at = 20\n", "release.1.at: found 20 s; expected a time before time.end = 20 s"));
    CHECK(says(kFirst + kSecond + "at = -1\n", "release.1.at: found -1"));
    CHECK(says(kFirst + kSecond + "at = 2\nwhen_hit = true\n", "release.1.at: found 2 with release.when_hit = true"));
    CHECK(says(kFirst + "when_hit = true\n" + kSecond + "when_hit = true\n",
               "release.0.when_hit: found true for every release, and no [[inflow]]"));
    const std::string cut = kFirst + kSecond + "at = 2\nincluded_in_dem = true\n";
    CHECK(says(cut + "[scheme]\nshape = \"cubic\"\n",
               "release.1.included_in_dem: found true with scheme.shape = \"cubic\""));
    CHECK(says(cut + "[erodible]\nlaw = \"growth\"\ndepth = 1\ngrowth = 0.01\nbed_evolves = false\n",
               "release.1.included_in_dem: found true with erodible.bed_evolves = false"));
    const std::string stage = "[[stage]]\nmodel = \"mpm3d\"\n";
    CHECK(says(kFirst + kSecond + "at = 2\n" + stage, "release.1.at: found 2 with a stage"));
    CHECK(says(kFirst + kSecond + "at = 2\n[scheme]\npreset = \"paper\"\n",
               "release.1.at: found 2 with scheme.preset = \"paper\""));
}
