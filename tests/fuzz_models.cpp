// Scenes of every model that `frana stress` draws: the same again, accepted, sound, and seen where they are falsified.
#include <cmath>
#include <limits>
#include <set>

#include "base/error.h"
#include "catch.h"
#include "checks/fuzz/campaign.h"
#include "checks/fuzz/draw.h"

using namespace frana;
using namespace frana::fuzz;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A mound on level ground in the middle of 16 x 16 pixels of 1 m, between walls, that `model` carries.
Draft mound(Model model) {
    const GridGeometry grid{16, 16, 0.0, 0.0, 1.0};
    Draft draft;
    draft.model = model;
    Raster dem = Raster::filled(grid, 0.0), depth = Raster::filled(grid, Raster::nodata);
    for (Index j = 6; j < 10; ++j)
        for (Index i = 6; i < 10; ++i) depth.at(i, j) = 1.5;
    draft.rasters = {{"dem.tif", dem}, {"depth.tif", depth}};
    draft.keys = {{"terrain.dem", "\"dem.tif\""},
                  {"release.depth", "\"depth.tif\""},
                  {"time.end", "1000.0"},
                  {"boundary.sides", "\"wall\""}};
    draft.steps = 14;
    if (model == Model::mpm3d || model == Model::staged) {
        draft.keys["stage#0.model"] = "\"mpm3d\"";
        draft.keys["stage#0.cell"] = "1.0";
    }
    if (model == Model::staged) {
        draft.keys["stage#0.model"] = "\"depth_averaged\"";
        draft.keys["stage#0.until"] = "0.2";
        draft.keys.erase("stage#0.cell");
        draft.keys["stage#1.model"] = "\"mpm3d\"";
        draft.keys["stage#1.window"] = "[2.7, 2.7, 8.3, 12.3]";
    }
    if (model == Model::structured || model == Model::water || model == Model::mixture) {
        for (const auto& [key, value] : {std::pair{"law", "\"mohr_coulomb\""},
                                         {"cohesion", "0.0"},
                                         {"fraction", "0.0"},
                                         {"friction_angle_deg", "20.0"},
                                         {"young_modulus", "1.0e5"}})
            draft.keys[std::string("material.structure.") + key] = value;
        draft.keys["material.density"] = "2000.0";
    }
    if (model == Model::water || model == Model::mixture || model == Model::flood)
        draft.keys["water.model"] = "\"free\"";
    if (model == Model::water) draft.keys["water.level"] = "0.5";
    if (model == Model::mixture) draft.keys["water.share"] = "0.4";
    return draft;
}

/// What is found broken when a state is falsified: that at step 9, or the next where one of water takes several.
std::string broken_by(Model model, const Falsify& change) {
    Index falsified = 0;
    const Verdict verdict = examine(mound(model), [&](Snapshot& state) {
        if (falsified > 0 || state.now.step < 9) return;
        falsified = state.now.step;
        change(state);
    });
    CAPTURE(verdict.text);
    REQUIRE_FALSE(verdict.refused);
    if (!verdict.broken) return "";
    CHECK(verdict.broken->step == falsified);
    return verdict.broken->invariant;
}

}  // namespace

TEST_CASE("Every model draws its scenes again, and others from another seed or number", "[fuzz]") {
    for (const Model model : all_models())
        for (std::uint64_t n = 0; n < 30; ++n) {
            CAPTURE(word_of(model), n);
            CHECK(same(draw(model, 7, n), draw(model, 7, n)));
            CHECK_FALSE(same(draw(model, 7, n), draw(model, 8, n)));
            CHECK_FALSE(same(draw(model, 7, n), draw(model, 7, n + 1)));
            CHECK(draw(model, 7, n).model == model);
        }
    CHECK(same(draw(Model::depth_averaged, 7, 3), draw(7, 3)));
}

TEST_CASE("Scenes of every model are ones that the program takes, and what their model says", "[fuzz]") {
    for (const Model model : all_models())
        for (std::uint64_t n = 0; n < 60; ++n) {
            const Draft draft = draw(model, 5, n);
            CAPTURE(word_of(model), n, toml_of(draft));
            const Scene scene = scene_of(draft);
            const bool stages = model == Model::mpm3d || model == Model::staged, wet = model == Model::water;
            CHECK(scene.solid.has_value() == stages);
            CHECK(scene.water.has_value() == (wet || model == Model::mixture || model == Model::flood));
            CHECK(scene.structure.has_value() == (wet || model == Model::mixture || model == Model::structured));
            for (const auto& [name, raster] : draft.rasters)
                for (const double value : raster.values) REQUIRE((std::isnan(value) || single(value) == value));
        }
}

TEST_CASE("Scenes are on level and on rough ground, some with threads and resumption to compare", "[fuzz]") {
    for (const Model model : all_models()) {
        Index threads = 0, resumes = 0, steep = 0;
        for (std::uint64_t n = 0; n < 200; ++n) {
            const Draft draft = draw(model, 3, n);
            threads += draft.claims.threads, resumes += draft.claims.resumes;
            const Raster& dem = draft.dem();
            double rise = 0.0;
            for (Index i = 0; i + 1 < dem.geometry.nx; ++i)
                rise = std::fmax(rise, std::abs(dem.at(i + 1, 2) - dem.at(i, 2)));
            steep += rise > 0.7 * dem.geometry.cell;
        }
        CAPTURE(word_of(model), threads, resumes, steep);
        CHECK(threads > 0);
        CHECK(resumes > 5);
        CHECK(steep > 20);
        CHECK(steep < 180);
    }
}

TEST_CASE("Where several models are drawn each comes as often as the others", "[fuzz]") {
    std::map<Model, Index> counts;
    for (std::uint64_t n = 0; n < 6000; ++n) counts[model_of(all_models(), 1, n)] += 1;
    REQUIRE(counts.size() == all_models().size());
    const double each = 6000.0 / static_cast<double>(all_models().size());
    for (const auto& [model, count] : counts) CHECK(std::abs(static_cast<double>(count) - each) < 5 * std::sqrt(each));
    for (std::uint64_t n = 0; n < 20; ++n) CHECK(model_of({Model::water}, 1, n) == Model::water);
}

TEST_CASE("Models are named on the command line", "[fuzz]") {
    CHECK(models_of("all").size() == 7);
    CHECK(models_of("water,staged") == std::vector<Model>{Model::water, Model::staged});
    CHECK(models_of("mpm3d,solid_flow") == std::vector<Model>{Model::mpm3d, Model::mpm3d});  // its former word
    CHECK_THROWS_WITH(models_of("water,ice"), Catch::Contains("--model: found \"ice\"") && Catch::Contains("mpm3d"));
    CHECK_THROWS_AS(models_of(""), UserError);
}

TEST_CASE("A sound run of every model breaks nothing, and is checked for all that can break", "[fuzz]") {
    for (const Model model : all_models()) {
        Draft draft = mound(model);
        draft.claims.threads = draft.claims.resumes = true;
        const Verdict verdict = examine(draft);
        CAPTURE(word_of(model), verdict.text, verdict.broken ? verdict.broken->text : "");
        REQUIRE_FALSE(verdict.refused);
        REQUIRE_FALSE(verdict.broken);
        CHECK(verdict.steps >= 14);  // one of water may take several of the particles
        for (const char* checked : {"finite", "positive", "mass", "momentum", "energy", "speed", "threads", "resume"}) {
            CAPTURE(checked);
            CHECK(verdict.worst.count(checked) == 1);
        }
        CHECK(verdict.worst.count("head") == (model == Model::mpm3d || model == Model::staged ? 1 : 0));
    }
}

TEST_CASE("A falsified state of every model is seen, by the invariant that it breaks", "[fuzz]") {
    for (const Model model : all_models()) {
        CAPTURE(word_of(model));
        const auto broken = [&](const Falsify& change) { return broken_by(model, change); };
        CHECK(broken([](Snapshot& s) { s.not_finite = 1; }) == "finite");
        const bool points = model != Model::flood;  // which has cells alone
        if (points) CHECK(broken([](Snapshot& s) { s.points.z[0] = kNaN; }) == "finite");
        CHECK(broken([](Snapshot& s) { s.now.stored = kNaN; }) == "finite");
        if (points) CHECK(broken([](Snapshot& s) { s.points.mass[1] = 0.0; }) == "positive");
        CHECK(broken([](Snapshot& s) { s.nodes[0].depth = -1.0; }) == "positive");
        CHECK(broken([](Snapshot& s) { s.between.mass_left += 1e-9 * s.between.mass; }) == "mass");
        CHECK(broken([](Snapshot& s) { s.now.impulse[1] += 1e-6 * s.now.mass; }) == "momentum");
        CHECK(broken([](Snapshot& s) { s.now.kinetic += 10.0 * s.now.mass; }) == "energy");
        CHECK(broken([](Snapshot& s) { s.now.stored += 10.0 * s.now.mass; }) == "energy");
        CHECK(broken([](Snapshot& s) { s.now.energy_left += 10.0 * s.now.mass; }) == "energy");
        // 2 sqrt(9.81 * 1.5) and a fall of 1.5 m: 9.4 m/s; a quarter and what its depth grows besides
        CHECK(broken([](Snapshot& s) { s.max_speed = 25.0; }) == "speed");
    }
}

TEST_CASE("A 3D point that is too high, or too fast where it is, is seen", "[fuzz]") {
    for (const Model model : {Model::mpm3d, Model::staged}) {
        const auto first_in_3d = [](const Snapshot& s) {
            std::size_t p = 0;
            while (!s.points.in_3d[p]) ++p;
            return p;
        };
        CAPTURE(word_of(model));
        CHECK(broken_by(model, [&](Snapshot& s) { s.points.z[first_in_3d(s)] = 25.0; }) == "head");
        CHECK(broken_by(model, [&](Snapshot& s) { s.points.speed[first_in_3d(s)] = 20.0; }) == "head");
        CHECK(broken_by(model, [&](Snapshot& s) { s.points.speed[first_in_3d(s)] = 2.0; }) == "");
    }
}

TEST_CASE("Scenes of other models that once broke an invariant break none", "[fuzz]") {
    struct Past {
        Model model;
        std::uint64_t seed, n;
        const char* key;
        const char* value;
    };  // still that scene
    const std::vector<Past> past = {
        // The spread of grains over the depth drove thin, thick water at hundreds of m/s.
        {Model::water, 1, 224, "water.profile_factor", "3.0"},
        {Model::water, 2, 364, "water.share", "0.8200577434555706"},
        {Model::water, 2, 470, "water.viscosity", "0.19193959929416746"},
        {Model::water, 2, 1271, "water.mud_alpha", "0.04977025032683622"},
        {Model::mixture, 2, 362, "water.profile_factor", "3.0"},
        // Affine transfers where streams of particles meet.
        {Model::structured, 2, 97, "material.structure.young_modulus", "165676880.48915252"},
        // Points that began inside a barrier were pushed onto it.
        {Model::mpm3d, 2, 156, "stage#0.transfer", "\"flip\""},
        {Model::mpm3d, 2, 523, "barrier#0.height", "43.16820509186893"},
        {Model::staged, 2, 400, "barrier#0.height", "36.71209067597749"},
        // A block that goes under a lake.
        {Model::water, 2, 623, "water.level", "270.26186061017535"},
        {Model::water, 2, 1169, "water.level", "250.85933892752848"},
        // Grains that climb, whose velocities are half a step behind.
        {Model::structured, 20261201, 2504, "material.structure.young_modulus", "513720.09241498896"},
        // Blocks of a pixel, which nodes have lower than they are.
        {Model::structured, 20261302, 3245, "material.structure.cohesion", "1078.8574511427819"},
        {Model::structured, 20261126, 8791, "material.structure.young_modulus", "10177142.087880127"},
        {Model::structured, 20261153, 79, "material.structure.young_modulus", "3777925.4076730236"},
    };
    for (const auto& [model, seed, n, key, value] : past) {
        const Draft draft = draw(model, seed, n);
        CAPTURE(word_of(model), seed, n);
        REQUIRE(draft.has(key));
        CHECK(draft.keys.at(key) == value);
        const Verdict verdict = examine(draft);
        CAPTURE(verdict.broken ? verdict.broken->text : "");
        CHECK_FALSE(verdict.broken);
    }
}

TEST_CASE("A campaign draws of the given models, and tells the mix", "[fuzz]") {
    Plan plan;
    plan.models = {Model::structured, Model::water};
    plan.seed = 3, plan.scenes = 12, plan.seconds = 1e9, plan.most_shrunk = 0;
    const Campaign campaign = run(plan, [](const Failure&) {});
    REQUIRE(campaign.mix.size() == 2);
    CHECK(campaign.mix.at(Model::structured).scenes + campaign.mix.at(Model::water).scenes == 12);
    CHECK(table_of(campaign).find("structured") != std::string::npos);
    CHECK(json_of(campaign).find("\"mix\": [\n  {\"model\": \"structured\"") != std::string::npos);
}
