// `frana stress`: what it saves is the case that failed, to the last bit, and its command line is answered.
#include <nlohmann/json.hpp>

#include "catch.h"
#include "checks/fuzz/draw.h"
#include "frana_fuzz_figure.h"
#include "frana_fuzz_save.h"
#include "fresh_folder.h"
#include "io/gdal_reader.h"
#include "program.h"
#include "scene/build_scene.h"

using namespace frana;

namespace {

/// Equal to the last bit, NaN like NaN.
bool same_values(const std::vector<double>& a, const std::vector<double>& b) {
    if (a.size() != b.size()) return false;
    for (std::size_t k = 0; k < a.size(); ++k)
        if (a[k] != b[k] && !(std::isnan(a[k]) && std::isnan(b[k]))) return false;
    return true;
}

}  // namespace

TEST_CASE("A saved draft of any model is read back as the same scene to the last bit", "[fuzz][io]") {
    Index with_velocity = 0, with_exits = 0, with_rain = 0;
    for (const fuzz::Model model : fuzz::all_models())
        for (std::uint64_t n = 0; n < (model == fuzz::Model::depth_averaged ? 60u : 15u); ++n) {
            const FreshFolder folder;
            const fuzz::Draft draft = fuzz::draw(model, 4, n);
            save_draft(folder.path(), draft, {"speed", 2.0, 7, 0.5, "as found"});
            CAPTURE(n, toml_of(draft));
            const Scene drawn = scene_of(draft);
            const Scene read = build_scene(CaseFile::read(folder.path() / "case.toml"), GdalReader());
            REQUIRE(read.bed.geometry == drawn.bed.geometry);
            REQUIRE(same_values(read.bed.values, drawn.bed.values));
            const Seeds &a = read.particles, &b = drawn.particles;
            REQUIRE(a.x == b.x);
            REQUIRE(a.y == b.y);
            REQUIRE(a.vx == b.vx);
            REQUIRE(a.vy == b.vy);
            REQUIRE(a.volume == b.volume);
            REQUIRE(a.depth == b.depth);
            REQUIRE(read.bed_law.index() == drawn.bed_law.index());
            REQUIRE(read.scheme.cfl == drawn.scheme.cfl);
            REQUIRE(read.solid.has_value() == drawn.solid.has_value());
            if (read.solid) REQUIRE(read.solid->window == drawn.solid->window);
            REQUIRE(read.water.has_value() == drawn.water.has_value());
            if (read.water) REQUIRE(same_values(read.water->rain.values, drawn.water->rain.values));
            with_rain += read.water && !read.water->rain.values.empty();
            with_velocity += draft.rasters.count("vx.tif");
            for (const double z : drawn.bed.values) with_exits += std::isnan(z);
        }
    CHECK(with_velocity > 0);
    CHECK(with_exits > 0);
    CHECK(with_rain > 0);
}

TEST_CASE("A saved case says how it is watched", "[fuzz][io]") {
    const FreshFolder folder;
    fuzz::Draft draft = fuzz::draw(4, 0);
    draft.claims = {true, fuzz::Mirror::diagonal, true, true};
    draft.steps = 9;
    CHECK(replay_options(draft) == "--steps 9 --rests --mirror diagonal --same-threads --same-resumed");
    save_draft(folder.path(), draft, {"rest", 2.0, 7, 0.5, "moved"});
    const std::string text = text_of(folder.path() / "case.toml");
    CHECK(text.find("# rest, step 7: moved\n") == 0);
    CHECK(text.find("frana stress --case case.toml " + replay_options(draft)) != std::string::npos);
    CHECK(text_of(folder.path() / "particles.csv").find("id,x,y") == 0);
}

TEST_CASE("frana stress runs scenes, counts them and writes JSON", "[fuzz][io]") {
    const FreshFolder folder;
    const Outcome outcome =
        call_frana(folder.path(), "stress --scenes 3 --seed 12 --seconds 1e6 --shrunk 0 --json s.json");
    CHECK((outcome.code == 0 || outcome.code == 1));
    CHECK(outcome.out.find("3 run") != std::string::npos);
    const auto json = nlohmann::json::parse(text_of(folder.path() / "s.json"));
    CHECK(json["seed"] == 12);
    CHECK(json["scenes"] == 3);
    CHECK(json["steps"] > 0);
    CHECK(json["worst"].size() > 0);
    CHECK((json["failures"].empty() == (outcome.code == 0)));
}

TEST_CASE("frana stress draws the models that it is told, and prints the mix", "[fuzz][io]") {
    const FreshFolder folder;
    const Outcome outcome = call_frana(
        folder.path(), "stress --model water,staged --scenes 4 --seed 12 --seconds 1e6 --shrunk 0 --json s.json");
    CHECK(outcome.out.find("4 run") != std::string::npos);
    const auto json = nlohmann::json::parse(text_of(folder.path() / "s.json"));
    Index scenes = 0;
    for (const auto& part : json["mix"]) {
        const std::string model = part["model"];
        CHECK((model == "water" || model == "staged"));
        CHECK(outcome.out.find("\n" + model) != std::string::npos);
        scenes += part["scenes"].get<Index>();
    }
    CHECK(scenes == 4);
    const Outcome wrong = call_frana(folder.path(), "stress --model ice");
    CHECK(wrong.code == 2);
    CHECK(wrong.err.find("--model: found \"ice\"; expected all, or some of depth_averaged") != std::string::npos);
}

TEST_CASE("frana stress --case watches a case, and sees a claim that does not hold", "[fuzz][io]") {
    const FreshFolder folder;
    fuzz::Draft draft;
    const GridGeometry grid{16, 16, 0.0, 0.0, 1.0};
    Raster depth = Raster::filled(grid, Raster::nodata);
    for (Index j = 6; j < 10; ++j)
        for (Index i = 6; i < 10; ++i) depth.at(i, j) = 1.0;
    draft.rasters = {{"dem.tif", Raster::filled(grid, 0.0)}, {"depth.tif", depth}};
    draft.keys = {{"terrain.dem", "\"dem.tif\""}, {"release.depth", "\"depth.tif\""}, {"time.end", "1.0"}};
    save_draft(folder.path(), draft, {"none", 0.0, 0, 0.0, "nothing"});
    const Outcome sound = call_frana(folder.path(), "stress --case case.toml --steps 10 --mirror x");
    CHECK(sound.code == 0);
    CHECK(sound.out.find("symmetry") != std::string::npos);
    const Outcome claimed = call_frana(folder.path(), "stress --case case.toml --steps 10 --rests");
    CHECK(claimed.code == 1);
    CHECK(claimed.err.find("rest at step 1") != std::string::npos);
    const Outcome wrong = call_frana(folder.path(), "stress --case case.toml --mirror z");
    CHECK(wrong.code == 2);
    CHECK(wrong.err.find("--mirror: found \"z\"; expected x, y or diagonal") != std::string::npos);
}

TEST_CASE("The map of stable steps is drawn", "[fuzz][io]") {
    const FreshFolder folder;
    std::vector<fuzz::CflRow> rows;
    for (const fuzz::Method& method : fuzz::cfl_methods()) rows.push_back({method, 0.1 * method.per_side, ""});
    draw_cfl_map(rows, folder.path() / "cfl.png");
    CHECK(std::filesystem::file_size(folder.path() / "cfl.png") > 10000);
}
