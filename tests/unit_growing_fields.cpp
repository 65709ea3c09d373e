// What varies from place to place on a part of a large terrain that grows: friction, loose ground, deposits, trees.
#include <algorithm>

#include "analytic_scene.h"
#include "base/error.h"
#include "fake_gis.h"
#include "growing_slide.h"
#include "observe/budget.h"
#include "observe/memory_archive.h"
#include "same_run.h"
#include "scene/build_scene.h"
#include "slope_case.h"

using namespace frana;
using namespace frana::test;

namespace {

using Edit = std::function<void(Scene&)>;
/// Numbers at a node, exact on every grid.
double stripes(double x, double y) { return static_cast<double>(static_cast<std::int64_t>(x + 2.0 * y) / 40 % 4); }

std::shared_ptr<const Friction> striped_friction(const GridGeometry& grid) {
    std::vector<bed::Coulomb> laws;
    for (const double stripe : sampled(grid, stripes).values) laws.push_back({0.0625 + 0.03125 * stripe});
    return std::make_shared<const Friction>(Friction{bed::law_map(laws), {"mu"}, {}});
}
double loose_depth(double x, double y) { return 0.125 * stripes(y, x); }
double trees(double x, double y) { return x < 3950.0 && stripes(x, y) > 1.0 ? 40.0 : 0.0; }

void add_friction(Scene& scene) { scene.friction = striped_friction(scene.bed.geometry); }
void add_loose(Scene& scene) {
    // Resampled, it differs from part to part in its last bit.
    const double bit = scene.bed.geometry.nx > 200 ? 0x1p-52 : 0.0;
    const auto depth = [bit](double x, double y) { return (1.0 + bit) * loose_depth(x, y); };
    scene.erodible = ErodibleBed{sampled(scene.bed.geometry, depth), 1500.0, erosion::Growth{0.01}, 0.0, 0.02};
}
void add_trees(Scene& scene) { scene.forest = Forest{sampled(scene.bed.geometry, trees), {}}; }
/// Some of the material lies where friction holds it; it becomes bed after the part has grown.
void add_deposits(Scene& scene) {
    std::vector<bed::Coulomb> laws;
    for (const double y : sampled(scene.bed.geometry, [](double, double y) { return y; }).values)
        laws.push_back({y < 1000.0 ? 4.0 : 0.1});
    scene.friction = std::make_shared<const Friction>(Friction{bed::law_map(laws), {"mu"}, {}});
    scene.deposition = Deposition{8.0};
}
void add_all(Scene& scene) { add_friction(scene), add_loose(scene), add_trees(scene); }

/// The scene on its part, and on others as it grows.
Scene with(Scene scene, const Edit& edit) {
    edit(scene);
    const auto wider = std::make_shared<WiderTerrain>(*scene.wider);
    wider->fields = [edit](const Raster& part) {
        Scene on_part;
        on_part.bed = part;
        edit(on_part);
        return GroundFields{on_part.friction, on_part.erodible ? on_part.erodible->depth : Raster(),
                            on_part.forest ? on_part.forest->pressure : Raster()};
    };
    scene.wider = wider;
    return scene;
}
Scene on_whole(const Edit& edit) {
    Scene scene = slide_on_large();
    scene.bed = ground_on(kLarge);
    scene.wider.reset();
    edit(scene);
    return scene;
}

void grow_once(GrowingParticles& run, const std::vector<Simulation*>& others = {}) {
    const NodeBox begin = run.held();
    while (run.held() == begin) {
        run.advance(1e9);
        for (Simulation* other : others) other->advance(1e9);
        REQUIRE(run.status().time < 40.0);
    }
}

double mu_at(const Friction& friction, Index node) {
    return std::get<bed::Coulomb>(friction.laws.at(static_cast<std::size_t>(node))).mu;
}

struct Named {
    const char* name;
    Edit edit;
    const char* ledger;  ///< of a state that the edit makes
    bool before;         ///< the bed has changed before the part grows
};
const std::vector<Named> kAll{{"friction", add_friction, "points/mass", false},
                              {"loose ground", add_loose, "bed/left", true},
                              {"trees", add_trees, "bed/fresh", true},
                              {"deposits", add_deposits, "bed/fresh", false},
                              {"all", add_all, "bed/pending", true}};

/// A plane of 3000 x 60 nodes that falls to the west, a release near its east, and fields on all of it or on a part.
class GisOfFields final : public LargeGis {
public:
    GisOfFields() : LargeGis(kAllNodes) {
        polygons["release.geojson"] = rectangle(14000, 100, 14040, 140);
        polygons["fan.geojson"] = rectangle(1000, 0, 2000, 300);
        polygons["gully.geojson"] = rectangle(503, 21, 902, 97);  // on no edge of a pixel
        polygons["small.geojson"] = rectangle(14000.5, 100.5, 14001, 101);
        polygons["nowhere.geojson"] = rectangle(-2000, 0, -1000, 300);
        const auto west = [](double x, double) { return x < 6000.0 ? 0.25 : 0.125; };
        rasters["mu.tif"] = sampled(kAllNodes, west);
        rasters["loose.tif"] = sampled({200, 60, 2.5, 2.5, 5.0}, [](double, double) { return 1.5; });  // x to 1000
        rasters["trees.tif"] = sampled({200, 60, 2.5, 2.5, 5.0}, [](double, double) { return 30.0; });
        rasters["off.tif"] = sampled({200, 60, -9e5, 2.5, 5.0}, [](double, double) { return 1.5; });
    }
    static constexpr GridGeometry kAllNodes{3000, 60, 2.5, 2.5, 5.0};

    Scene scene(const std::string& more) const {
        return build_scene(CaseFile::parse("[terrain]\ndem = \"dem.tif\"\n[[release]]\noutline = \"release.geojson\"\n"
                                           "depth = 2\n[time]\nend = 20\n[material]\ndensity = 1000\n" +
                                               more,
                                           "slide/case.toml"),
                           *this);
    }
};

}  // namespace

TEST_CASE("Fields of a part that grows: the same bits whatever lies beyond, and after a resume", "[terrain][erosion]") {
    for (const Named& field : kAll) {
        INFO(field.name);
        GrowingParticles large(with(slide_on_large(), field.edit)), cut(with(slide_on_cut(), field.edit));
        grow_once(large, {&cut});
        require_same(large, cut);
        const auto moved = [&] { return large.status().bed.eroded + large.status().bed.deposited > 0.0; };
        CHECK(moved() == field.before);
        MemoryArchive archive;
        large.serialize(archive);
        GrowingParticles again(with(slide_on_large(), field.edit), Start::resumed);
        again.serialize(archive.rewind());
        const double time = large.status().time + 8.0;
        for (GrowingParticles* one : {&large, &cut, &again}) run_to(*one, time);
        CHECK(moved() == (large.particles().erosion() != nullptr));
        require_same(large, cut);
        if (large.particles().erosion() != nullptr)
            check_same(large.particles(), again.particles(), field.ledger);
        else
            require_same(large, again);
    }
}

TEST_CASE("Fields of a part that grows are those of a run on all of the terrain, results too", "[terrain][erosion]") {
    for (const Named& field : kAll) {
        INFO(field.name);
        GrowingParticles part(with(slide_on_large(), field.edit));
        const Scene whole = on_whole(field.edit);
        DepthAveraged all(whole);
        const Status first = part.status(), first_of_all = all.status();
        grow_once(part, {&all});
        for (int step = 0; step < 60; ++step) part.advance(1e9), all.advance(1e9);
        // Places in cells are counted from other nodes: they differ by round-off, at most 1000 x 2^-53 cells each step.
        // A thousand such steps stay below 1e-9 of what the flow has.
        const Status &now = part.status(), &of_all = all.status();
        CHECK(now.step == of_all.step);
        CHECK(now.kinetic == Approx(of_all.kinetic).epsilon(1e-9));
        CHECK(now.dissipated == Approx(of_all.dissipated).epsilon(1e-9));
        CHECK(now.bed.eroded == Approx(of_all.bed.eroded).epsilon(1e-9));
        CHECK(now.bed.deposited == Approx(of_all.bed.deposited).epsilon(1e-9));
        CHECK(std::abs(budget(first, now).mass_error) < 1e-13);
        CHECK(std::abs(budget(first, now).bed_error) < 1e-13);
        // What moved in the books when the part grew is nothing: both have the same residual of energy.
        CHECK(budget(first, now).energy_residual ==
              Approx(budget(first_of_all, of_all).energy_residual).margin(1e-9 * of_all.dissipated));
        const Flow &here = part.particles().flow(), &there = all.flow();
        const Erosion *bed = part.particles().erosion(), *of_whole = all.erosion();
        double farthest = 0.0, ledger = 0.0, path = 0.0;
        const NodeBox held = part.held();
        for (Index j = 20; j < held.ny - 20; ++j)  // at the edges slopes are one-sided
            for (Index i = 20; i < held.nx - 20; ++i) {
                const Index k = here.grid.at(i, j), n = there.grid.at(i + held.i0, j + held.j0);
                farthest = std::max(farthest, std::abs(here.bed.z[k] - there.bed.z[n]));
                farthest = std::max(farthest, std::abs(here.bed.slope_x[k] - there.bed.slope_x[n]));
                if (bed == nullptr) continue;
                path = std::max(path, std::abs(here.bed.smoothed[k] - there.bed.smoothed[n]));
                ledger = std::max(ledger, std::abs(bed->left(k) - of_whole->left(n)));
                ledger = std::max(ledger, std::abs(bed->fresh(k) - of_whole->fresh(n)));
            }
        Index others = 0;
        for (Index n = 0; whole.friction && n < held.nx * held.ny; ++n)
            others += mu_at(*part.friction(), n) !=
                      mu_at(*whole.friction, (n / held.nx + held.j0) * kLarge.nx + n % held.nx + held.i0);
        CHECK(others == 0);
        CHECK(farthest < 1e-8);
        CHECK(path < 1e-8);
        CHECK(ledger < 1e-8 * 1500.0 * 25.0);
    }
}

TEST_CASE("A part of a terrain has the case's friction, loose ground and trees, there and farther on",
          "[terrain][zones]") {
    const GisOfFields gis;
    const std::string bed = "bed = { law = \"coulomb\", mu = \"mu.tif\" }\n";
    const std::string fields = bed +
                               "[[material.zone]]\noutline = \"fan.geojson\"\nmu = 0.5\n"
                               "[[material.zone]]\nbelow = 50\nmu = 0.75\n"
                               "[erodible]\nlaw = \"growth\"\ngrowth = 0.01\ndepth = \"loose.tif\"\n"
                               "outline = \"gully.geojson\"\n"
                               "[forest]\ndetrainment = \"trees.tif\"\n";
    const Scene part = gis.scene(fields), whole = gis.scene(fields + "[output]\nextent = \"terrain\"\n");
    REQUIRE(part.wider);
    REQUIRE_FALSE(whole.wider);
    REQUIRE(part.bed.geometry.x0 > 6000.0);  // east of all that its friction could differ by
    REQUIRE(part.forest);
    CHECK(part.forest->pressure.at(0, 0) == 0.0);
    CHECK(part.erodible->depth.at(0, 0) == 0.0);
    REQUIRE(part.friction->parts.size() == 1);
    CHECK(part.friction->parts[0].name == "elsewhere");
    for (const std::string& remark : part.log) CHECK_THAT(remark, !Catch::Contains("later zones cover all of it"));
    // Farther on: on a part, and on all of it.
    const NodeBox west{50, 0, 900, 60};
    for (const NodeBox& box : {west, NodeBox::all(GisOfFields::kAllNodes)}) {
        const GroundFields fields_there = part.wider->fields(gis.plane_on(box));
        REQUIRE(fields_there.friction);
        REQUIRE(fields_there.loose.geometry == box.of(GisOfFields::kAllNodes));
        REQUIRE(fields_there.trees.geometry == box.of(GisOfFields::kAllNodes));
        Index others = 0;
        for (Index j = 0; j < box.ny; ++j)
            for (Index i = 0; i < box.nx; ++i) {
                others += mu_at(*fields_there.friction, j * box.nx + i) !=
                          mu_at(*whole.friction, (j + box.j0) * GisOfFields::kAllNodes.nx + i + box.i0);
                // Shares of pixels are counted from the part's first node: 15 km in doubles, over a pixel of 5 m.
                others += std::abs(fields_there.loose.at(i, j) - whole.erodible->depth.at(i + box.i0, j + box.j0)) >
                          1.5 * 15e3 / 5.0 * 0x1p-50;
                others += fields_there.trees.at(i, j) != whole.forest->pressure.at(i + box.i0, j + box.j0);
            }
        CHECK(others == 0);
        CHECK(fields_there.friction->parts.size() == 3);
    }
    // A case that has none of them reads none.
    CHECK_FALSE(gis.scene("bed = { law = \"coulomb\", mu = 0.2 }\n").wider->fields);
}

TEST_CASE("What lies off all of a large terrain is refused, not taken for what begins farther on", "[terrain][zones]") {
    const GisOfFields gis;
    const std::string bed = "bed = { law = \"coulomb\", mu = 0.2 }\n";
    const auto problem = [&](const std::string& more) { return only_problem([&] { gis.scene(bed + more); }); };
    CHECK_THAT(problem("[[material.zone]]\noutline = \"nowhere.geojson\"\nmu = 0.5\n"),
               Catch::Contains("found no node of the terrain in it"));
    CHECK_THAT(problem("[erodible]\nlaw = \"growth\"\ngrowth = 0.01\ndepth = 1\noutline = \"nowhere.geojson\"\n"),
               Catch::Contains("found an outline of x -2000 to -1000, y 0 to 300 without any of the terrain"));
    // Within the part, but between its nodes.
    CHECK_THAT(problem("[[material.zone]]\noutline = \"small.geojson\"\nmu = 0.5\n"),
               Catch::Contains("found no node of the terrain in it"));
    CHECK_THAT(problem("[forest]\ndetrainment = 30\noutline = \"nowhere.geojson\"\n"),
               Catch::Contains("found no node of the terrain in it"));
    CHECK_THAT(problem("[erodible]\nlaw = \"growth\"\ngrowth = 0.01\ndepth = \"off.tif\"\n"),
               Catch::Contains("off.tif: does not touch it"));
    CHECK_THAT(problem("[forest]\ndetrainment = \"off.tif\"\n"), Catch::Contains("off.tif: does not touch it"));
}

TEST_CASE("What hangs on the part that is read holds all of the terrain", "[terrain][zones]") {
    const GisOfFields gis;
    CHECK_FALSE(gis.scene("bed = { law = \"voellmy\", table = \"voellmy-salm\", return_period = 100 }\n").wider);
    const std::string zone = "bed = { law = \"coulomb\", mu = 0.2 }\n[[material.zone]]\nbelow = 50\nmu = 0.5\n";
    CHECK(gis.scene(zone).wider);
    CHECK_FALSE(gis.scene(zone + "[deposition]\nlaw = \"rest\"\n").wider);
}
