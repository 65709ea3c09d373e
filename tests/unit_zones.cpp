// Friction that varies from place to place: the same bits where all nodes have the same, and what zones and rasters of a case mean.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "analytic_scene.h"
#include "base/constants.h"
#include "catch.h"
#include "checks/verify/placement.h"
#include "friction_in_space.h"
#include "law/bed/law_map.h"
#include "observe/budget.h"
#include "same_run.h"
#include "scene/build_scene.h"
#include "shallow/depth_averaged.h"
#include "slope_case.h"

using namespace frana;
using namespace frana::test;

namespace {

/// A slide over a bump.
Scene slide(const std::function<void(Scene&)>& edit = {}) {
    Scene scene = scene_on(80, 60, 2.0, [](double x, double y) {
        return 90 - 0.5 * x + 0.01 * (y - 59) * (y - 59) +
               3 * std::exp(-((x - 90) * (x - 90) + (y - 59) * (y - 59)) / 60);
    });
    scene.bed_law = bed::Voellmy{0.2, 400};
    verify::place(
        scene, [](double x, double y) { return std::hypot(x - 35, y - 59) < 20 ? 3.0 : 0.0; }, verify::Placement::r2,
        2);
    if (edit) edit(scene);
    return scene;
}

std::shared_ptr<const Friction> rough_beyond(const Scene& scene, double x0) {
    return by_place<bed::Voellmy>(scene, [x0](double x, double y) {
        return bed::Voellmy{x < x0 ? 0.15 + 1e-4 * y : 0.6, x < x0 ? 500.0 : 300.0};
    });
}

}  // namespace

TEST_CASE("Nodes that all have the law of the scene change no bit of it", "[zones]") {
    const BedLaw laws[] = {bed::Coulomb{0.25}, bed::Voellmy{0.2, 400}, bed::Manning{0.05, 0.1},
                           bed::Bingham{50, 300, 0.05}, bed::Pouliquen{0.3, 0.6, 0.3, 0.05, 0.6}};
    for (const BedLaw& law : laws)
        for (const TerrainModel terrain : {TerrainModel::steep, TerrainModel::shallow, TerrainModel::linearised})
            for (const bool table_of_one : {true, false}) {
                INFO("law " << law.index() << ", terrain " << static_cast<int>(terrain) << ", one " << table_of_one);
                const auto edit = [&](Scene& s) {
                    s.bed_law = law, s.terrain = terrain;
                    if (terrain == TerrainModel::shallow) s.curvature = Curvature::none;
                };
                DepthAveraged plain(slide(edit));
                Scene scene = slide(edit);
                scene.friction = twice(scene);
                if (table_of_one)
                    std::visit(
                        [&](const auto& of) {
                            scene.friction =
                                by_place<std::decay_t<decltype(of)>>(scene, [of](double, double) { return of; });
                        },
                        law);
                scene.bed_law = bed::None{};  // is not asked for
                DepthAveraged of_nodes(scene);
                run_to(plain, 4.0), run_to(of_nodes, 4.0);
                check_same(of_nodes, plain);
            }
}

TEST_CASE("A flow that takes up its bed feels the friction of the nodes below it", "[zones][erosion]") {
    const auto edit = [](Scene& s) {
        s.erodible = ErodibleBed{};
        s.erodible->law = erosion::Shear{0.2, 500.0, 1e-4};
        s.erodible->depth = Raster::filled(s.bed.geometry, 0.5);
        s.erodible->momentum = 0.5;
    };
    DepthAveraged plain(slide(edit));
    Scene scene = slide(edit);
    scene.friction = twice(scene);
    DepthAveraged same(scene);
    scene.friction = rough_beyond(scene, 60.0);
    DepthAveraged rough(scene);
    const Status first = rough.frame().status;
    run_to(plain, 6.0), run_to(same, 6.0), run_to(rough, 6.0);
    check_same(same, plain);
    REQUIRE(plain.status().bed.eroded > 0.0);
    CHECK(rough.status().bed.eroded != plain.status().bed.eroded);
    CHECK(std::abs(budget(first, rough.frame().status).mass_error) <= 1e-13);
}

TEST_CASE("Zones have the same bits on any number of threads, and when a run goes on", "[zones][threads]") {
    Scene scene = slide();
    scene.friction = rough_beyond(scene, 70.0);
    check_threads_and_resume(scene, 8.0);
}

TEST_CASE("Zones on a terrain with x and y exchanged give the flow with x and y exchanged", "[zones]") {
    const auto height = [](double x, double y) {
        return 90 - 0.5 * x + 0.01 * (y - 59) * (y - 59) +
               3 * std::exp(-((x - 90) * (x - 90) + (y - 55) * (y - 55)) / 60);
    };
    const auto law = [](double x, double y) { return bed::Voellmy{x < 70 ? 0.1 + 1e-3 * y : 0.5, 300.0 + x}; };
    Scene along = slide(), across = scene_on(60, 80, 2.0, [&](double x, double y) { return height(y, x); });
    along.bed = scene_on(80, 60, 2.0, height).bed;
    across.bed_law = along.bed_law, across.particles = along.particles;
    std::swap(across.particles.x, across.particles.y), std::swap(across.particles.vx, across.particles.vy);
    along.friction = by_place<bed::Voellmy>(along, law);
    across.friction = by_place<bed::Voellmy>(across, [&](double x, double y) { return law(y, x); });
    DepthAveraged a(along), b(across);
    run_to(a, 6.0), run_to(b, 6.0);
    const Frame of_a = a.frame(), of_b = b.frame();
    const double *depth = of_a.node("depth")->data, *other = of_b.node("depth")->data;
    double most = 0.0, apart = 0.0;
    for (Index j = 0; j < of_a.grid.ny; ++j)
        for (Index i = 0; i < of_a.grid.nx; ++i) {
            const double here = depth[j * of_a.grid.nx + i];
            most = std::max(most, here);
            apart = std::max(apart, std::abs(here - other[i * of_b.grid.nx + j]));
        }
    REQUIRE(most > 0.5);
    CHECK(apart <= 1e-9 * most);  // round-off of sums in another order, as it grows in some hundred steps
    CHECK(a.status().kinetic == Approx(b.status().kinetic).epsilon(1e-9));
    DepthAveraged even(slide([&](Scene& s) { s.bed = along.bed; }));  // the zones matter
    run_to(even, 6.0);
    CHECK(std::abs(even.status().kinetic / a.status().kinetic - 1.0) > 0.05);
}

TEST_CASE("A layer holds where the friction of its zone holds it, asleep or not, and slides elsewhere", "[zones]") {
    for (const bool sleep : {true, false}) {
        Scene scene =
            scene_on(90, 40, 2.0, [](double x, double) { return -std::tan(20 * constants::kPi / 180.0) * x; });
        scene.scheme.sleep = sleep;
        fill(scene, [](double x, double y) { return x > 20 && x < 150 && y > 20 && y < 60 ? 1.0 : 0.0; });
        scene.friction =
            by_place<bed::Coulomb>(scene, [](double x, double) { return bed::Coulomb{x < 85.0 ? 0.55 : 0.2}; });
        DepthAveraged simulation(scene);
        run_to(simulation, 4.0);
        const Particles& c = simulation.flow().particles;
        double held = 0.0, slid = INFINITY;
        for (Index p = 0; p < c.count(); ++p) {
            const auto first = static_cast<std::size_t>(c.id[p]);
            if (c.id[p] >= scene.particles.count()) continue;
            const double x = scene.particles.x[first], way = c.x[p] * 2.0 - x;
            const bool inner = scene.particles.y[first] > 36 && scene.particles.y[first] < 44;
            if (x > 36 && x < 60 && inner) held = std::max(held, std::abs(way));
            if (x > 105 && x < 130 && inner) slid = std::min(slid, way);
        }
        CHECK(held == 0.0);
        CHECK(slid > 5.0);  // g (sin - mu cos) 16 s^2 / 2 = 12 m along the slope
    }
}

TEST_CASE("Four nodes with numbers of their own leave what each leaves by itself, to the last bit", "[zones][law]") {
    const auto check = [](const auto& of) {
        const auto together = laws::side_by_side(of[0], of[1], of[2], of[3]);
        // From steps that friction hardly feels to such that stop, and to those beyond the series and the fraction.
        for (const double dt : {1e-4, 0.05, 0.7, 9.0})
            for (const double s0 : {0.0, 0.3, 14.0})
                for (const double drive : {-2.0, 0.5, 6.0}) {
                    const BedStateOf<Double4> bed{{9.8, 8.1, 7.3, 9.0},
                                                  {0.01, 0.4, 3.0, 20.0},
                                                  {1.0, 1.1, 1.3, 1.02},
                                                  {1.0, 0.8, 0.7, 0.95},
                                                  9.81,
                                                  1800.0};
                    const Double4 before = {s0, 0.9 * s0, 1.1 * s0, s0}, driven = before + dt * drive;
                    const Double4 after = together.speed_after(bed, before, driven, dt);
                    for (int n = 0; n < 4; ++n) {
                        const BedState one{bed.normal_gravity[n], bed.thickness[n], bed.kappa[n],
                                           bed.cosine[n],         bed.gravity,      bed.density};
                        CHECK(after[n] == of[static_cast<std::size_t>(n)].speed_after(one, before[n], driven[n], dt));
                    }
                }
    };
    check(std::vector<bed::Voellmy>{{0.1, 200}, {0.25, 1200}, {0.0, 400}, {0.6, 3000}});
    check(std::vector<bed::Coulomb>{{0.1}, {0.25}, {0.0}, {0.6}});
}

TEST_CASE("A table has each law once, in the order of the nodes, and tells a parameter by its key", "[zones]") {
    const std::vector<bed::Voellmy> laws = {{0.3, 500}, {0.1, 500}, {0.3, 500}, {0.3, 400}};
    const bed::LawMap all = bed::law_map(laws);
    CHECK(std::get<std::vector<bed::Voellmy>>(all.laws).size() == 3);
    CHECK(all.place == std::vector<std::uint32_t>{0, 1, 0, 2});
    CHECK(bed::parameter_on_nodes(all, "mu") == std::vector<double>{0.3, 0.1, 0.3, 0.3});
    CHECK(bed::parameter_on_nodes(all, "xi") == std::vector<double>{500, 500, 500, 400});
    CHECK(bed::parameter_on_nodes(all, "manning_n").empty());
    CHECK(bed::plain_name(bed::Voellmy::keys(), &bed::Voellmy::mu) == "mu");
    CHECK(std::get<bed::Voellmy>(all.at(3)).xi == 400);
}

namespace {

const char* const kVoellmy = "[material]\ndensity = 1900\n[material.bed]\nlaw = \"voellmy\"\nmu = 0.2\nxi = 500\n";

Scene scene_of(const FakeGis& gis, const std::string& rest) {
    return build_scene(CaseFile::parse("[terrain]\ndem = \"dem.tif\"\n[[release]]\noutline = \"release.geojson\"\n"
                                       "depth = 2\n[time]\nend = 20\n" +
                                           rest,
                                       "slide/case.toml"),
                       gis);
}

std::string problem_of(const FakeGis& gis, const std::string& rest) {
    return only_problem([&] { scene_of(gis, rest); });
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

bool said(const Scene& scene, const std::string& part) {
    return std::any_of(scene.log.begin(), scene.log.end(), [&](const auto& line) { return has(line, part); });
}

bed::Voellmy law_at(const Scene& scene, Index i, Index j) {
    return std::get<bed::Voellmy>(scene.friction->laws.at(static_cast<std::size_t>(j * scene.bed.geometry.nx + i)));
}

}  // namespace

TEST_CASE("A case without zones and rasters has one friction", "[zones][scene]") {
    CHECK_FALSE(scene_of(slope_gis(), kVoellmy).friction);
}

TEST_CASE("Zones by outline and elevation: later ones win, and say what they say", "[zones][scene]") {
    FakeGis gis = slope_gis();  // 100 m + 0.5 (x - 1000); nodes at 1002.5, 1007.5, ...
    gis.polygons["fan.geojson"] = rectangle(1020, 2020, 1040, 2040);
    gis.polygons["fan.geojson"].parts[0].rings.push_back({{1026, 2026}, {1029, 2026}, {1029, 2029}, {1026, 2029}});
    const Scene scene = scene_of(gis, std::string(kVoellmy) +
                                          "[[material.zone]]\noutline = \"fan.geojson\"\nmu = 0.4\n"
                                          "[[material.zone]]\nabove = 115\nbelow = 150\nxi = 900\n"
                                          "[[material.zone]]\nabove = 150\nfriction_angle_deg = 45\n");
    const Friction& friction = *scene.friction;
    CHECK(law_at(scene, 0, 0).mu == 0.2);
    CHECK((law_at(scene, 4, 4).mu == 0.4 && law_at(scene, 4, 4).xi == 500));  // x 1022.5, z 111.25
    CHECK((law_at(scene, 5, 5).mu == 0.2));                                   // the hole
    CHECK((law_at(scene, 7, 4).mu == 0.4 && law_at(scene, 7, 4).xi == 900));  // z 118.75
    CHECK((law_at(scene, 3, 4).mu == 0.2 && law_at(scene, 8, 4).mu == 0.2));  // x 1017.5, 1042.5
    CHECK((law_at(scene, 39, 0).mu == Approx(1.0) && law_at(scene, 39, 0).xi == 500));
    CHECK(friction.keys == std::vector<std::string>{"mu", "xi"});
    REQUIRE(friction.parts.size() == 4);
    CHECK(friction.parts[0].name == "material.zone.0 (fan.geojson)");
    CHECK(friction.parts[0].area == 25.0 * (2 * 4 - 1));  // without the hole, and without what the second has
    CHECK(friction.parts[3].name == "elsewhere");
    CHECK(friction_sentence(friction.parts[1]) ==
          fmt::format("{:.6g} m2, mu 0.2 to 0.4, xi 900 m/s^2", friction.parts[1].area));
    double area = 0.0;
    for (const FrictionPart& part : friction.parts) area += part.area;
    CHECK(area == 25.0 * 40 * 30);
    const Scene covered = scene_of(gis, std::string(kVoellmy) +
                                            "[[material.zone]]\noutline = \"fan.geojson\"\nmu = 0.4\n"
                                            "[[material.zone]]\nabove = 0\nmu = 0.3\n");
    CHECK(said(covered, "material.zone.0: later zones cover all of it"));
}

TEST_CASE("A raster of a constant is the constant; its pixels are those at the nodes", "[zones][scene]") {
    FakeGis gis = slope_gis();
    gis.rasters["mu.tif"] = sampled({5, 4, 1020, 2020, 40.0}, [](double, double) { return 0.2; });  // to 1200, 2160
    const std::string law = "[material.bed]\nlaw = \"voellmy\"\nxi = 500\nmu = \"mu.tif\"\n";
    const Scene constant = scene_of(gis, law);
    CHECK(std::get<std::vector<bed::Voellmy>>(constant.friction->laws.laws).size() == 1);
    CHECK((law_at(constant, 17, 3).mu == 0.2 && law_at(constant, 17, 3).xi == 500));
    CHECK(constant.friction->parts.front().name == "everywhere");
    gis.rasters["mu.tif"].at(1, 0) = 0.7;  // x 1040 to 1080, y 2000 to 2040
    const Scene scene = scene_of(gis, law);
    CHECK((law_at(scene, 7, 0).mu == 0.2 && law_at(scene, 8, 0).mu == 0.7));
    CHECK((law_at(scene, 15, 7).mu == 0.7 && law_at(scene, 16, 7).mu == 0.2 && law_at(scene, 15, 8).mu == 0.2));
    CHECK(std::get<bed::Voellmy>(scene.bed_law).mu == Approx(0.2 + 0.5 * 64 / 1200.0));
    gis.rasters["mu.tif"].at(4, 3) = NAN;
    CHECK(has(problem_of(gis, law),
              "found no value at 48 of 1200 nodes, such as x 1162.5, y 2122.5; expected one at "
              "each, since material.bed.mu has no default"));
    const Scene filled = scene_of(gis, law + "[[material.zone]]\nabove = 170\nmu = 0.5\n");
    CHECK(law_at(filled, 39, 29).mu == 0.5);
    const Scene usual = scene_of(gis, "[material.bed]\nlaw = \"manning\"\nmanning_n = 0.05\nmu = \"mu.tif\"\n");
    CHECK(said(usual, "material.bed.mu: 4 % of the terrain's nodes have no data there; they have 0"));
}

TEST_CASE("What is wrong with zones and rasters of friction is said in one sentence", "[zones][scene]") {
    FakeGis gis = slope_gis();
    gis.polygons["far.geojson"] = rectangle(5000, 5000, 5100, 5100);
    gis.rasters["mu.tif"] = sampled(gis.rasters["dem.tif"].geometry, [](double, double) { return 0.2; });
    gis.rasters["mu.tif"].at(7, 5) = -0.5;
    const std::string zone = std::string(kVoellmy) + "[[material.zone]]\n";
    CHECK(has(problem_of(gis, zone + "mu = 0.3\n"), "not given, and no above or below either"));
    CHECK(has(problem_of(gis, zone + "above = 10\n"),
              "found no number of a law in it; expected keys of the case's laws: "
              "friction_angle_deg, mu, xi"));
    CHECK(has(problem_of(gis, zone + "above = 10\nmu = 0.3\nmanning_n = 0.1\n"),
              "found, but material.bed.law = \"voellmy\" does not use it; expected keys of that law: "
              "friction_angle_deg, mu, xi"));
    CHECK(has(problem_of(gis, zone + "above = 10\nbelow = 5\nmu = 0.3\n"), "expected less than below = 5"));
    CHECK(
        has(problem_of(gis, zone + "above = 1000\nmu = 0.3\n"), "material.zone.0: found no node of the terrain in it"));
    CHECK(has(problem_of(gis, zone + "outline = \"far.geojson\"\nmu = 0.3\n"), "found no node of the terrain in it"));
    CHECK(has(problem_of(gis, zone + "above = 10\nmu = -0.3\n"), "-0.3"));
    CHECK(has(problem_of(gis, zone + "above = 10\nmu = 0.3\nxj = 3\n"), "unknown key"));
    CHECK(has(problem_of(gis, "[material.bed]\nlaw = \"coulomb\"\nmu = \"mu.tif\"\n"),
              "mu.tif: found 1 pixel(s) out of range, such as -0.5 at x 1037.5, y 2027.5; expected numbers"));
    CHECK(has(
        problem_of(gis, std::string(kVoellmy) + "[material.rheology]\nlaw = \"newtonian\"\nviscosity = \"mu.tif\"\n"),
        "mu.tif: found 1 pixel(s) out of range, such as -0.5 at x 1037.5, y 2027.5; expected numbers"));
    gis.rasters["mu.tif"].at(7, 5) = 0.5;
    const std::string mud = "[material.bed]\nlaw = \"bingham\"\nviscosity = 50\nyield_stress = 500\n",
                      stage =
                          "[[material.zone]]\nabove = 10\nyield_stress = 900\n[[stage]]\nmodel = \"mpm3d\"\n"
                          "window = [1020, 2020, 1100, 2100]\n";
    CHECK(has(problem_of(gis, mud + stage),
              "material.bed.law: found \"bingham\" that varies from place to place, with a stage; expected one yield "
              "stress"));
    const std::string grains =
        "[material.bed]\nlaw = \"pouliquen\"\nmu_s = \"mu.tif\"\nmu_2 = 0.4\ngrain_diameter = 0.01\n";
    CHECK(has(problem_of(gis, grains), "found mu_2 = 0.4 at x 1037.5, y 2027.5; expected more than mu_s = 0.5 there"));
}

TEST_CASE("Overrides reach zones by their number", "[zones][scene]") {
    const std::string text =
        "[terrain]\ndem = \"dem.tif\"\n[[release]]\noutline = \"release.geojson\"\ndepth = 2\n[time]\nend = 20\n" +
        std::string(kVoellmy) + "[[material.zone]]\nabove = 150\nmu = 0.3\n";
    const CaseFile file = CaseFile::parse(
        text, "slide/case.toml", {"material.zone.0.mu=0.35", "material.zone.1.below=110", "material.zone.1.xi=50"});
    const Scene scene = build_scene(file, slope_gis());
    CHECK((law_at(scene, 39, 0).mu == 0.35 && law_at(scene, 0, 0).xi == 50));
    CHECK_THROWS_AS(CaseFile::parse(text, "slide/case.toml", {"material.zone.2.mu=0.35"}), UserError);
    CHECK(has(resolved_toml(file), "[[material.zone]]"));
    CHECK(resolved_toml(CaseFile::parse(resolved_toml(file), "slide/case.toml")).size() > 0);
}
