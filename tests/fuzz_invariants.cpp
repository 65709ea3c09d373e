// The stress run itself: cases are the same for the same seed, a broken state is seen, what fails is made small.
#include <algorithm>
#include <cmath>
#include <limits>

#include "catch.h"
#include "checks/fuzz/campaign.h"
#include "checks/fuzz/cfl_map.h"
#include "checks/fuzz/draw.h"
#include "scene/parameters.h"
#include "shallow/depth_averaged.h"

using namespace frana;
using namespace frana::fuzz;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A mound on level ground in the middle of 20 x 20 pixels of 1 m, mirror-symmetric in every way.
Draft mound() {
    const GridGeometry grid{20, 20, 0.0, 0.0, 1.0};
    Draft draft;
    Raster dem = Raster::filled(grid, 0.0), depth = Raster::filled(grid, Raster::nodata);
    for (Index j = 7; j < 13; ++j)
        for (Index i = 7; i < 13; ++i) depth.at(i, j) = 1.5;
    draft.rasters = {{"dem.tif", dem}, {"depth.tif", depth}};
    draft.keys = {{"terrain.dem", "\"dem.tif\""},
                  {"release.depth", "\"depth.tif\""},
                  {"time.end", "1.0"},
                  {"material.bed.law", "\"coulomb\""},
                  {"material.bed.mu", "0.3"}};
    draft.steps = 12;
    return draft;
}

/// The mound as a draft that may not move: its friction holds a slope of 3.
Draft resting_mound() {
    Draft draft = mound();
    draft.keys["material.bed.mu"] = "3.0";
    draft.claims.rests = true;
    return draft;
}

/// What is found broken when a run's state is falsified at step 5.
std::string broken_by(const Draft& draft, const Falsify& change) {
    const Verdict verdict = examine(draft, [&](Snapshot& state) {
        if (state.now.step == 5) change(state);
    });
    REQUIRE_FALSE(verdict.refused);
    if (!verdict.broken) return "";
    CHECK(verdict.broken->step == 5);
    return verdict.broken->invariant;
}

std::string broken_by(const Falsify& change) {
    Draft draft = mound();
    draft.keys["scheme.cfl"] = "0.5";  // in longer steps more energy turns over, and more may be missing
    return broken_by(draft, change);
}

}  // namespace

TEST_CASE("A bed law that random scenes do not have gets the keys that it needs, within their ranges", "[fuzz]") {
    for (const std::string& law : find_parameter("material.bed.law")->choices)
        for (std::uint64_t n = 0; n < 20; ++n) {
            Dice dice(7, n);
            Draft draft;
            draw_bed_keys(dice, draft, law);
            CAPTURE(law, n, draft.keys);
            for (const Parameter& key : parameters()) {
                const auto& by = key.required_by;
                if (key.switch_key != "material.bed.law" || std::find(by.begin(), by.end(), law) == by.end()) continue;
                CHECK(draft.has(key.key) + (draft.has(key.instead_of) ? 1 : 0) == 1);
                if (draft.has(key.key)) CHECK(key.range.holds(std::stod(draft.keys.at(key.key))));
            }
        }
}

TEST_CASE("A seed draws the same cases again, another seed other ones", "[fuzz]") {
    for (std::uint64_t n = 0; n < 50; ++n) {
        CHECK(same(draw(7, n), draw(7, n)));
        CHECK_FALSE(same(draw(7, n), draw(8, n)));
        CHECK_FALSE(same(draw(7, n), draw(7, n + 1)));
    }
}

TEST_CASE("Drawn rasters hold what a float32 GeoTIFF holds", "[fuzz]") {
    for (std::uint64_t n = 0; n < 100; ++n)
        for (const auto& [name, raster] : draw(3, n).rasters)
            for (const double value : raster.values) REQUIRE((std::isnan(value) || single(value) == value));
}

TEST_CASE("Every drawn case is one that the program takes", "[fuzz]") {
    for (std::uint64_t n = 0; n < 150; ++n) {
        CAPTURE(n, toml_of(draw(5, n)));
        REQUIRE_NOTHROW(scene_of(draw(5, n)));
    }
    CHECK_NOTHROW(scene_of(draw(20261130, 741)));  // a release that comes later lay beside a hole
}

// The fit divided nothing by nothing once all that it could change had changed.
TEST_CASE("Masses fitted to a lake of few points at their limits are numbers", "[fuzz][lake]") {
    const DepthAveraged run(scene_of(draw(20261134, 3209)));
    CHECK(std::isfinite(run.status().mass));
    CHECK(run.status().mass > 0.0);
}

TEST_CASE("A sound run breaks no invariant", "[fuzz]") {
    const Verdict verdict = examine(mound());
    REQUIRE_FALSE(verdict.broken);
    CHECK(verdict.steps == 12);
    for (const char* checked : {"mass", "momentum", "energy", "speed"}) CHECK(verdict.worst.count(checked) == 1);
    CHECK_FALSE(examine(resting_mound()).broken);
    for (const Mirror way : {Mirror::x, Mirror::y, Mirror::diagonal}) {
        Draft draft = mound();
        draft.claims.mirror = way;
        const Verdict image = examine(draft);
        REQUIRE_FALSE(image.broken);
        CHECK(image.worst.at("symmetry") > 0.0);
    }
}

TEST_CASE("A state holds the nodes that points touch, and none that they have left", "[fuzz]") {
    Draft draft = mound();
    Raster& depth = draft.rasters["depth.tif"];
    std::fill(depth.values.begin(), depth.values.end(), Raster::nodata);
    depth.at(1, 10) = depth.at(17, 10) = 1.5;  // the one leaves, the other goes on
    draft.keys["release.velocity"] = "[-20.0, 0.0]";
    const Scene scene = scene_of(draft);
    DepthAveraged simulation(scene);
    for (int step = 0; step < 12; ++step) simulation.advance(1e300);
    const Snapshot state = snapshot_of(simulation, true);
    REQUIRE(simulation.status().mass_left > 0.0);
    REQUIRE_FALSE(state.nodes.empty());
    for (const NodeState& node : state.nodes) CHECK(simulation.flow().is_in_reach(node.i, node.j));
}

TEST_CASE("A column hundreds of cells high on a bent bed falls no faster than gravity has it", "[fuzz]") {
    // Smallest of those found; the bed bends by more than its slope within a hundredth of the column's height.
    Draft draft = mound();
    draft.keys.erase("material.bed.law"), draft.keys.erase("material.bed.mu");
    draft.keys["scheme.curvature_length"] = "0.0";
    Raster dem = Raster::filled({4, 4, 0.0, 0.0, 0.013671875}, 0.0);
    Raster depth = Raster::filled(dem.geometry, Raster::nodata);
    for (Index j = 0; j < 4; ++j) dem.at(0, j) = 0.02808, dem.at(1, j) = 0.01001, dem.at(3, j) = 0.008789;
    depth.at(3, 1) = 0.7902;
    draft.keys["boundary.sides"] = "\"wall\"";
    draft.rasters = {{"dem.tif", dem}, {"depth.tif", depth}};
    const Verdict verdict = examine(draft);
    REQUIRE_FALSE(verdict.broken);
    CHECK(verdict.worst.count("speed") == 1);
}

// Two particles whose support just reaches a row of nodes: those have 1e-31 kg, which stress drove to 1e12 m/s. The
// bend of the bed there took that for the particles' speed.
TEST_CASE("A node's last bit of mass, which stress throws, does not feel a bend by its speed", "[fuzz]") {
    Draft draft;
    draft.model = Model::mixture;
    draft.keys = {{"material.density", "1984.8201334798123"},
                  {"material.structure.law", "\"drucker_prager\""},
                  {"material.structure.cohesion", "472.6408564083918"},
                  {"material.structure.friction_angle_deg", "2.970774705391566"},
                  {"material.structure.young_modulus", "1053538.488999948"},
                  {"particles.per_cell", "1"},
                  {"release.depth", "\"depth.tif\""},
                  {"terrain.dem", "\"dem.tif\""},
                  {"water.model", "\"free\""},
                  {"output.every", "0.17748867078149982"},
                  {"time.end", "0.17748867078149982"}};
    Raster dem = Raster::filled({8, 4, 0.0, 0.0, 1.0}, 0.800048828125);
    Raster depth = Raster::filled(dem.geometry, Raster::nodata);
    dem.at(7, 0) = 0.0, depth.at(1, 0) = 0.39643329381942749;
    draft.rasters = {{"dem.tif", dem}, {"depth.tif", depth}};
    const Verdict verdict = examine(draft);
    REQUIRE_FALSE(verdict.broken);
    CHECK(verdict.steps > 10);
    CHECK(verdict.worst.count("momentum") == 1);
}

TEST_CASE("Scenes that once broke an invariant break none", "[fuzz]") {
    struct Past {
        std::uint64_t seed, n;
        const char* key;
        const char* value;
    };  // the key tells that it is still that scene
    const std::vector<Past> past = {
        // The flank of a pile at rest was extrapolated under its bed, steeper than friction holds.
        {41, 715, "material.bed.mu", "1.3021982360178923"},
        {31415, 2289, "material.bed.mu", "0.4520774548054708"},
        {8080, 2901, "material.bed.mu", "0.8507146687312253"},
        {8080, 3362, "material.bed.mu", "1.1607901464157264"},
        // Where that flank ended on the bed itself, round-off chose whether a dry neighbour was a shore.
        {60601, 1522, "terrain.curvature", "\"none\""},
        // A column that fell apart in three steps was drawn in again before it was split.
        {31415, 1037, "scheme.cfl", "0.2512512270738828"},
        // The flank of a heap a hundred cells high runs up a plane of 80 degrees.
        {8080, 2468, "material.bed.xi", "2807.6518414394786"},
        // A film that only round-off moves; round-off that streams make grow.
        {8080, 1473, "scheme.cfl", "0.03842298365322716"},
        {8080, 4496, "material.rheology.viscosity", "0.008512986065753394"},
        {20261, 622, "scheme.curvature_length", "0.625"},
        // A first step as long as a film at rest asks for, on a cliff of many cells.
        {4711, 5113, "material.bed.manning_n", "0.01029686055612272"},
        {4711, 7846, "material.bed.mu_2", "1.2467439864863565"},
        {4711, 10028, "scheme.cfl", "0.3481556009880239"},
        // Friction's change, taken from a heavy stream, drove a light point of flip the other way.
        {4711, 907, "scheme.cfl", "0.16744233626069174"},
        // A margin's surface ended on the ground beside it, and round-off chose whether that was a shore.
        {4711, 2417, "scheme.curvature_length", "40.0"},
        // Halves that linear shapes held on the first node, but just off the last.
        {161803, 1071, "material.rheology.viscosity", "0.6866850603511693"},
        // One pixel's energy, which nodes do not see at first.
        {4711, 4763, "scheme.cfl", "0.27902058934855273"},
        // Affine transfers where velocity changes from cell to cell.
        {4711, 1475, "material.rheology.viscosity", "2.397281873451208"},
        {31415, 1275, "material.rheology.yield_stress", "10096.483538082297"},
        // Points of the paper preset that carry a depth of tens of metres where nodes have half a metre.
        {4711, 6515, "material.rheology.yield_stress", "614.124606380038"},
        {60601, 1062, "material.bed.xi", "569332.5874043602"},
        // Viscosity that linear shapes could not take in one step.
        {161803, 8811, "material.rheology.viscosity", "43759.95271282277"},
        // Bends that turn a velocity by almost half within a cell.
        {161803, 3519, "material.rheology.viscosity", "11331.807323507024"},
        {161803, 8685, "material.rheology.viscosity", "0.6226696922744507"},
        // Linear shapes have no energy law.
        {77003, 1805, "scheme.cfl", "0.2813935057952504"},
        // Artificial viscosity gave more than a velocity jump in one step.
        {20261130, 23534, "material.rheology.viscosity", "182874.9513840854"},
        {20261130, 41772, "inflow#0.velocity", "59.65731288008794"},
        {20261130, 43104, "scheme.viscosity_quadratic", "2.0"},
        // A climb that stops left the round-off of heights of 1650 m, and friction took that for a direction.
        {20261130, 23176, "material.bed.grain_diameter", "1.2882987306199064e-05"},
        // Points too light to split, alone: their own pressure stretched them again after each cut of their domains.
        {20261130, 9718, "scheme.strain_rate_floor", "0.03918799188243738"},
        // Linear shapes took more viscosity than plain points can have.
        {20261130, 9566, "material.rheology.yield_stress", "8.256769522429586"},
        {20261125, 251, "scheme.preset", "\"paper\""},
        // A pit a cell beyond the material, which its surface slopes to.
        {20261130, 5559, "material.bed.xi", "5366119.22106256"},
        // Points of flip with a velocity of their own.
        {20261130, 7645, "deposition.time", "0.007449285668167268"},
        {20261140, 334, "scheme.flip_ratio", "1.0"},
    };
    for (const auto& [seed, n, key, value] : past) {
        const Draft draft = draw(seed, n);
        CAPTURE(seed, n);
        REQUIRE(draft.has(key));
        CHECK(draft.keys.at(key) == value);
        const Verdict verdict = examine(draft);
        CAPTURE(verdict.broken ? verdict.broken->text : "");
        CHECK_FALSE(verdict.broken);
    }
}

TEST_CASE("Mirror images that part by growing round-off are told from those that the code parts", "[fuzz]") {
    const Draft streams = draw(20261, 622);
    const Verdict grown = examine(streams);
    CHECK_FALSE(grown.broken);
    CHECK(grown.parted);
    CHECK(grown.steps == streams.steps);  // the others are watched on

    // The same flow, one of whose images is off from the start: in its twin too.
    Scene scene = scene_of(streams);
    scene.particles.volume[0] *= 1.0 + 1e-5;
    const Verdict planted = examine(scene, streams.claims, streams.steps);
    REQUIRE(planted.broken);
    CHECK(planted.broken->invariant == "symmetry");
    CHECK_FALSE(planted.parted);
}

TEST_CASE("Where only round-off moves, mirror images may differ by round-off and by no more", "[fuzz]") {
    const Draft film = draw(8080, 1473);
    CHECK_FALSE(examine(film).broken);
    // Its waves run at some 0.05 m/s, its round-off is below 1e-14 m/s.
    CHECK(broken_by(film, [](Snapshot& s) { s.nodes[2].vx += 1e-11; }) == "symmetry");
}

TEST_CASE("What runs uphill on steep ground is still held to a speed and an energy", "[fuzz]") {
    Draft heap = draw(8080, 2468);
    for (auto key = heap.keys.begin(); key != heap.keys.end();)  // loose ground may become steeper, and allows more
        key = key->first.rfind("erodible.", 0) == 0 ? heap.keys.erase(key) : std::next(key);
    heap.keys.erase("release#0.included_in_dem");  // and so does ground that a release is cut out of
    CHECK(broken_by(heap, [](Snapshot& s) { s.max_speed = 500.0; }) == "speed");
    CHECK(broken_by(heap, [](Snapshot& s) { s.now.potential += 3.0 * s.now.kinetic; }) == "energy");
}

TEST_CASE("A falsified state is seen, by the invariant that it breaks", "[fuzz]") {
    CHECK(broken_by([](Snapshot&) {}) == "");
    CHECK(broken_by([](Snapshot& s) { s.points.change[3] = kNaN; }) == "finite");
    CHECK(broken_by([](Snapshot& s) { s.now.dissipated = kNaN; }) == "finite");
    CHECK(broken_by([](Snapshot& s) { s.now.in_3d.numerical = kNaN; }) == "finite");
    CHECK(broken_by([](Snapshot& s) { s.nodes[4].vx = kNaN; }) == "finite");
    CHECK(broken_by([](Snapshot& s) { s.points.mass[2] = -s.points.mass[2]; }) == "positive");
    CHECK(broken_by([](Snapshot& s) { s.nodes[4].depth = -1e-9; }) == "positive");
    CHECK(broken_by([](Snapshot& s) { s.points.mass[2] *= 1.0 + 1e-9; }) == "mass");
    CHECK(broken_by([](Snapshot& s) { s.between.mass_left = 1e-6; }) == "mass");
    CHECK(broken_by([](Snapshot& s) { s.between.impulse[1] += 1e-3; }) == "momentum");
    CHECK(broken_by([](Snapshot& s) { s.now.momentum[0] += 1e-3; }) == "momentum");
    CHECK(broken_by([](Snapshot& s) { s.now.kinetic += 2e5; }) == "energy");
    CHECK(broken_by([](Snapshot& s) { s.now.potential *= 1.8; }) == "energy");
    // 2 sqrt(9.81 * 1.5) and a fall of 1.5 m: 9.4 m/s, and a quarter: 11.8
    CHECK(broken_by([](Snapshot& s) { s.max_speed = 13.0; }) == "speed");
}

TEST_CASE("Energy is judged with linear shapes only where a scene is claimed to be resolved", "[fuzz]") {
    Draft draft = mound();
    draft.keys["scheme.shape"] = "\"linear\"";
    const auto heat = [](Snapshot& s) { s.now.kinetic += 1e6; };
    CHECK(broken_by(draft, heat) == "");
    draft.claims.resolved = true;
    CHECK(broken_by(draft, [](Snapshot&) {}) == "");
    CHECK(broken_by(draft, heat) == "energy");
}

TEST_CASE("A speed beyond the line is allowed by what velocity changes across a cell, and no more", "[fuzz]") {
    // The mound's line is 2 sqrt(g h) and a fall of h, 9.4 m/s at 1.5 m; its own gradients stay below a quarter of that.
    const auto fast = [](double speed, double change) {
        return broken_by([=](Snapshot& s) { s.max_speed = speed, s.points.change[3] = change; });
    };
    CHECK(fast(13.0, 0.0) == "speed");
    CHECK(fast(13.0, 6.0) == "");
    CHECK(fast(16.0, 6.0) == "speed");
    CHECK(fast(20.0, 1e3) == "speed");
}

TEST_CASE("A speed beyond the line is allowed by what points of flip have beyond their nodes", "[fuzz]") {
    Draft draft = mound();
    draft.keys["scheme.transfer"] = "\"flip\"";
    const auto fast = [&](double speed, double own) {
        return broken_by(draft, [=](Snapshot& s) { s.max_speed = speed, s.points.own[3] = own; });
    };
    CHECK(fast(13.0, 0.0) == "speed");
    CHECK(fast(13.0, 6.0) == "");
    CHECK(fast(16.0, 6.0) == "speed");
    CHECK(fast(20.0, 1e3) == "speed");
}

TEST_CASE("What points of flip have beyond their nodes is none where all have one velocity", "[fuzz]") {
    Draft draft = mound();
    draft.keys["scheme.transfer"] = "\"flip\"", draft.keys["release.velocity"] = "[3.0, -2.0]";
    const Scene scene = scene_of(draft);
    DepthAveraged simulation(scene);
    for (const double own : snapshot_of(simulation, true).points.own) CHECK(own < 1e-13);
    Scene two = scene;
    for (std::size_t p = 0; p < two.particles.vx.size(); p += 2) two.particles.vx[p] = -3.0;
    DepthAveraged mixed(two);
    double most = 0.0;
    for (const double own : snapshot_of(mixed, true).points.own) most = std::max(most, own);
    CHECK(most > 1.0);
    CHECK(most < 6.0);
}

TEST_CASE("The fall to a node beside the material counts as one of a point", "[fuzz]") {
    const auto fast = [](double speed, double pit) {
        return broken_by([=](Snapshot& s) { s.max_speed = speed, s.nodes[0].foot = -pit; });
    };
    CHECK(fast(20.0, 0.0) == "speed");
    CHECK(fast(20.0, 30.0) == "");  // 24 m/s
    CHECK(fast(40.0, 30.0) == "speed");

    Draft draft = mound();  // pixels 7 to 12
    draft.rasters["dem.tif"].at(3, 9) = -30.0;
    const Scene scene = scene_of(draft);
    DepthAveraged simulation(scene);
    double lowest = 0.0, foot = 0.0;
    for (const NodeState& node : snapshot_of(simulation, true).nodes)
        lowest = std::min(lowest, node.bed), foot = std::min(foot, node.foot);
    CHECK(foot < lowest);
    CHECK(foot >= -30.0);
}

TEST_CASE("A point of a resting pile that moves by one bit is seen", "[fuzz]") {
    const auto nudge = [](Snapshot& s) { s.points.x[0] = std::nextafter(s.points.x[0], 1e9); };
    CHECK(broken_by(resting_mound(), nudge) == "rest");
    CHECK(broken_by(resting_mound(), [](Snapshot& s) { s.points.vy[1] = 1e-300; }) == "rest");
}

TEST_CASE("A mirror image that is none is seen", "[fuzz]") {
    for (const Mirror way : {Mirror::x, Mirror::y, Mirror::diagonal}) {
        Draft draft = mound();
        draft.claims.mirror = way;
        CHECK(broken_by(draft, [](Snapshot& s) { s.nodes[2].depth += 1e-6; }) == "symmetry");
        draft.rasters["depth.tif"].at(9, 7) += 0.125;
        CHECK(examine(draft).broken->invariant == "symmetry");
    }
}

TEST_CASE("A run that fails in the solver is a finding, a case that is none is refused", "[fuzz]") {
    Draft draft = mound();
    Scene scene = scene_of(draft);
    scene.scheme.cfl = 50.0;  // far beyond what a case may ask for
    const Verdict verdict = examine(scene, {}, 20);
    REQUIRE(verdict.broken);
    CHECK(verdict.broken->invariant == "numerics");
    CHECK(verdict.broken->text.find("four cells") != std::string::npos);
    draft.keys["release.velocity"] = "[1.0]";
    CHECK(examine(draft).refused);
}

TEST_CASE("A failing case is shrunk to what makes it fail", "[fuzz]") {
    // Planted: pits of more than 5 m count as a failure, where there is material, at step 2.
    Draft draft = mound();
    draft.steps = 40;
    draft.keys["scheme.cfl"] = "0.3";
    draft.keys["material.rheology.law"] = "\"newtonian\"";
    draft.keys["material.rheology.viscosity"] = "10.0";
    draft.rasters["dem.tif"].at(9, 9) = -8.0;
    const auto judge = [](const Draft& d) {
        Verdict verdict;
        bool pit = false;
        for (const double z : d.dem().values) pit = pit || std::isless(z, -5.0);
        double volume = 0.0;
        for (const double h : d.rasters.at("depth.tif").values) volume += h > 0.0 ? h : 0.0;
        if (pit && volume > 0.0 && d.steps > 2) verdict.broken = Violation{"planted", 1.0, 2, 0.0, ""};
        return verdict;
    };
    const Shrunk shrunk = shrink(draft, judge);
    REQUIRE(shrunk.verdict.broken);
    CHECK(shrunk.verdict.broken->invariant == "planted");
    CHECK(shrunk.draft.steps == 3);
    CHECK(shrunk.draft.dem().geometry.size() <= 25);
    CHECK_FALSE(shrunk.draft.has("scheme.cfl"));
    CHECK_FALSE(shrunk.draft.has("material.rheology.law"));
    CHECK_FALSE(shrunk.draft.has("material.bed.law"));
    Index pixels = 0;
    for (const double h : shrunk.draft.rasters.at("depth.tif").values) pixels += h > 0.0;
    CHECK(pixels == 1);
    CHECK(judge(shrunk.draft).broken);
}

TEST_CASE("A pile that is shrunk keeps what it rests by, an image its symmetry", "[fuzz]") {
    const auto always = [](const Draft&) {
        Verdict verdict;
        verdict.broken = Violation{"planted", 1.0, 0, 0.0, ""};
        return verdict;
    };
    Draft pile = resting_mound();
    pile.keys["scheme.cfl"] = "0.3";
    const Draft small = shrink(pile, always).draft;
    CHECK(small.keys.at("material.bed.mu") == "3.0");
    CHECK_FALSE(small.has("scheme.cfl"));
    pile.keys = small.keys;
    pile.steps = small.steps;
    CHECK(same(small, pile));

    Draft image = draw(1, 0);
    for (std::uint64_t n = 1; image.claims.mirror != Mirror::diagonal; ++n) image = draw(1, n);
    const Draft shrunk = shrink(image, always).draft;
    const Raster& dem = shrunk.dem();
    for (Index j = 0; j < dem.geometry.ny; ++j)
        for (Index i = 0; i < dem.geometry.nx; ++i) REQUIRE(dem.at(i, j) == dem.at(j, i));
}

TEST_CASE("A campaign says what it ran, the same again", "[fuzz]") {
    Plan plan;
    plan.models = {Model::depth_averaged};
    plan.seed = 11;
    plan.scenes = 6;
    plan.seconds = 1e9;
    plan.most_shrunk = 0;
    const auto ignore = [](const Failure&) {};
    const Campaign campaign = run(plan, ignore), again = run(plan, ignore);
    CHECK(campaign.scenes == 6);
    CHECK(campaign.steps == again.steps);
    REQUIRE(campaign.worst.count("mass") == 1);
    CHECK(campaign.worst.at("momentum").value == again.worst.at("momentum").value);
    CHECK(json_of(campaign).find("\"seed\": 11, \"first\": 0, \"scenes\": 6") != std::string::npos);
}

TEST_CASE("The map of stable steps rises until something breaks", "[fuzz]") {
    const CflRow row = cfl_row({"default", Shape::quadratic, Transfer::tpic, 1}, 25);
    CAPTURE(row.largest, row.first_broken);
    CHECK(row.largest >= 0.5);  // the default scheme.cfl
    CHECK((row.largest == cfl_ladder().back()) == row.first_broken.empty());
    const std::string table = cfl_table({row});
    CHECK(table.find("quadratic tpic") != std::string::npos);
}

TEST_CASE("The scenes of that map all have an energy law", "[fuzz]") {
    for (const SuiteScene& entry : cfl_suite({})) {
        const DepthAveraged simulation(entry.scene);
        CAPTURE(entry.name);
        CHECK(facts_of(entry.scene, simulation, {}).energy_law);
    }
}
