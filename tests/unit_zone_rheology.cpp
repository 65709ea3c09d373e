// Rheologies that vary from place to place: the same bits where all nodes have the same, what points of a zone feel, and what zones and
// rasters of a case mean.
#include <algorithm>
#include <cmath>

#include "analytic_scene.h"
#include "base/constants.h"
#include "catch.h"
#include "checks/verify/placement.h"
#include "friction_in_space.h"
#include "law/rheology/law_map.h"
#include "observe/budget.h"
#include "same_run.h"
#include "scene/build_scene.h"
#include "shallow/depth_averaged.h"
#include "slope_case.h"

namespace frana::zone_rheology_test {  // its names are other files' too
using namespace frana::test;

namespace {

const Rheology kRheologies[] = {rheology::Newtonian{20000.0}, rheology::Bingham{500.0, 2000.0},
                                rheology::Bingham{20000.0, 0.0}};

/// Mud that slides over a bump.
Scene slide(const Rheology& law, const std::function<void(Scene&)>& edit = {}) {
    Scene scene = scene_on(80, 60, 2.0, [](double x, double y) {
        return 90 - 0.5 * x + 0.01 * (y - 59) * (y - 59) +
               3 * std::exp(-((x - 90) * (x - 90) + (y - 59) * (y - 59)) / 60);
    });
    scene.bed_law = bed::Coulomb{0.2};
    scene.rheology = law;
    verify::place(
        scene, [](double x, double y) { return std::hypot(x - 35, y - 59) < 20 ? 3.0 : 0.0; }, verify::Placement::r2,
        2);
    if (edit) edit(scene);
    return scene;
}

/// What frames show: stresses at the points.
std::vector<double> stresses(DepthAveraged& run) {
    const Frame frame = run.frame();
    const Field* stress = frame.particle("stress");
    return std::vector<double>(stress->data, stress->data + 3 * stress->count);
}

std::shared_ptr<const Friction> stiff_beyond(const Scene& scene, double x0) {
    return rheologies_by_place<rheology::Bingham>(scene, [x0](double x, double y) {
        return rheology::Bingham{x < x0 ? 300.0 + y : 8000.0, x < x0 ? 500.0 : 4000.0};
    });
}

}  // namespace

TEST_CASE("Four rheologies side by side are each of them, to the last bit", "[zones][law]") {
    const rheology::Bingham laws[] = {{10.0, 100.0}, {10.0, 0.0}, {0.0, 50.0}, {2000.0, 1e-3}};
    StrainState<Double4> four{
        {{0.3, -0.2, 0.1, 0.0}, {0.1, 0.4, -0.1, 0.0}, {0.4, 0.2, 0.0, 0.0}}, {4.0, 0.0, 2.0, 0.0}, 1e-3, 300.0};
    const PlaneOf<Double4> together = frana::laws::side_by_side(laws[0], laws[1], laws[2], laws[3]).stress(four);
    for (int n = 0; n < 4; ++n) {
        const StrainState<double> one{{four.rate.xx[n], four.rate.yy[n], four.rate.xy[n]}, four.shear[n], 1e-3, 300.0};
        const Plane alone = laws[n].stress(one);
        CAPTURE(n, alone.xx);
        CHECK((together.xx[n] == alone.xx && together.yy[n] == alone.yy && together.xy[n] == alone.xy));
    }
    CHECK(together.xx[0] != laws[1].stress(StrainState<double>{{0.3, 0.1, 0.4}, 4.0, 1e-3, 300.0}).xx);
}

TEST_CASE("Nodes that all have the rheology of the scene change no bit of it, or round-off in vectorised kernels",
          "[zones]") {
    const auto default_scheme = [](Scene&) {};
    const std::function<void(Scene&)> schemes[] = {
        default_scheme,
        [](Scene& s) { s.scheme.precision = Precision::single; },
        [](Scene& s) { s.scheme.shape = Shape::cubic; },
        [](Scene& s) { s.scheme.transfer = Transfer::flip; },
        [](Scene& s) { s.scheme.shape = Shape::linear, s.scheme.transfer = Transfer::apic; },
        [](Scene& s) {
            verify::set_preset(s, "paper");
            s.scheme.cfl = 0.25;
        }};
    for (const Rheology& law : kRheologies)
        for (const auto& scheme : schemes) {
            INFO("law " << law.index() << ", scheme " << &scheme - schemes);
            DepthAveraged plain(slide(law, scheme));
            Scene scene = slide(law, scheme);
            scene.friction = rheologies_twice(scene);
            DepthAveraged of_nodes(scene);
            run_to(plain, 3.0), run_to(of_nodes, 3.0);
            if (&scheme - schemes > 1) {
                check_same(of_nodes, plain);
                CHECK(stresses(of_nodes) == stresses(plain));
            } else  // fused multiply-adds differ from kernel to kernel: round-off, which the flow makes larger
                CHECK(of_nodes.status().kinetic ==
                      Approx(plain.status().kinetic).epsilon(&scheme == schemes ? 1e-9 : 1e-5));
        }
}

TEST_CASE("Zones of a rheology have the same bits on any number of threads, and when a run goes on",
          "[zones][threads]") {
    Scene scene = slide(kRheologies[1]);
    scene.friction = stiff_beyond(scene, 60.0);
    check_threads_and_resume(scene, 6.0);
    DepthAveraged zones(scene), everywhere(slide(kRheologies[1]));
    run_to(zones, 6.0), run_to(everywhere, 6.0);
    CHECK(everywhere.status().kinetic != zones.status().kinetic);
}

// A layer that shears across its motion, v_x = r y: eps_xy = r / 2, and Bingham's I2 has the shear over its thickness besides.
TEST_CASE("A point has the stress of the node nearest to it", "[zones]") {
    constexpr double rate = 0.1, border = 20.0, cell = 1.0;
    Scene scene = scene_on(41, 41, cell, [](double, double) { return 0.0; });
    fill(scene, [](double, double) { return 1.0; });
    scene.particles.vx.clear();
    for (const double y : scene.particles.y) scene.particles.vx.push_back(rate * (y - 20.0));
    scene.particles.vy.assign(scene.particles.y.size(), 0.0);
    scene.rheology = rheology::Bingham{};
    scene.scheme.cfl = 0.01;  // so short steps cap no stress
    const rheology::Bingham thin{50.0, 100.0}, thick{400.0, 900.0};
    scene.friction =
        rheologies_by_place<rheology::Bingham>(scene, [&](double x, double) { return x < border ? thin : thick; });
    DepthAveraged run(scene);
    const Frame frame = run.frame();
    const Field *stress = frame.particle("stress"), *place = frame.particle("position");
    Index checked = 0;
    for (Index p = 0; p < stress->count; ++p) {
        const double x = place->data[3 * p], y = place->data[3 * p + 1];
        if (std::abs(x - 20.0) > 10.0 || std::abs(y - 20.0) > 10.0) continue;  // gradients are those of the nodes
        const rheology::Bingham& law = x < border - 0.5 * cell ? thin : thick;
        const double v = rate * (y - 20.0);
        const Plane exact =
            law.stress(StrainState<double>{{0.0, 0.0, 0.5 * rate}, std::abs(v), scene.scheme.strain_rate_floor, 1e9});
        CAPTURE(x, y);
        CHECK(stress->data[3 * p + 2] == Approx(exact.xy).epsilon(1e-9));
        ++checked;
    }
    CHECK(checked > 1000);
}

// Friction of the bed, by (42) and (43): |V| = tau_B h / (6 mu) (2 + z)(1 - z)^2 with z the plug's share, tau_Y / tau_B. Nothing
// flows across the slope, and so each zone has its own speed.
TEST_CASE("A sheet of mud rests in the zone whose yield stress holds it, and flows uniformly in the other", "[zones]") {
    const double slope = std::tan(10.0 * constants::kPi / 180.0), thickness = 0.8, border = 30.0;
    Scene scene = scene_on(121, 61, 1.0, [=](double x, double) { return -slope * x; });
    scene.density = 1800.0;
    scene.sides = Sides::wall;
    fill(scene, [=](double, double) { return thickness * std::sqrt(1.0 + slope * slope); });
    const double stress = 1800.0 * scene.gravity * thickness * std::sin(std::atan(slope));
    REQUIRE((stress > 2400.0 && stress < 2500.0));
    scene.friction = by_place<bed::Bingham>(scene, [=](double, double y) {
        return y < border ? bed::Bingham{300.0, 900.0, 0.0} : bed::Bingham{300.0, 2500.0, 0.0};
    });
    scene.bed_law = bed::Bingham{300.0, 900.0, 0.0};
    DepthAveraged run(scene);
    run_to(run, 10.0);  // it relaxes in rho h^2 / (3 mu) = 1.3 s or less; from the walls waves come 44 m far
    const Frame frame = run.frame();
    const double z = 900.0 / stress, speed = stress * thickness / (6.0 * 300.0) * (2.0 + z) * (1.0 - z) * (1.0 - z);
    const auto v = [&](Index i, Index j) { return frame.node("speed")->data[j * frame.grid.nx + i]; };
    for (const Index i : {55, 60, 65}) {
        CHECK(v(i, 45) == 0.0);
        CHECK(v(i, 15) == Approx(speed).epsilon(1e-3));  // twice e^(-10 / 1.3)
    }
}

namespace {

const char* const kMud = "[material]\ndensity = 1900\n[material.bed]\nlaw = \"coulomb\"\nmu = 0.2\n";
const char* const kBingham = "[material.rheology]\nlaw = \"bingham\"\nviscosity = 50\n";

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

rheology::Bingham law_at(const Scene& scene, Index i, Index j) {
    return std::get<rheology::Bingham>(scene.rheologies()->at(static_cast<std::size_t>(j * scene.bed.geometry.nx + i)));
}

}  // namespace

TEST_CASE("Zones give numbers of the rheology along with those of the bed law", "[zones][scene]") {
    FakeGis gis = slope_gis();  // 100 m + 0.5 (x - 1000); nodes at 1002.5, 1007.5, ...
    gis.polygons["fan.geojson"] = rectangle(1020, 2020, 1040, 2040);
    const std::string zones =
        "[[material.zone]]\noutline = \"fan.geojson\"\nmu = 0.4\nrheology.yield_stress = 900\n"
        "[[material.zone]]\nabove = 150\n[material.zone.rheology]\nviscosity = 80\n";
    const Scene scene = scene_of(gis, std::string(kMud) + kBingham + "yield_stress = 400\n" + zones);
    CHECK((law_at(scene, 0, 0).viscosity == 50 && law_at(scene, 0, 0).yield_stress == 400));
    CHECK((law_at(scene, 4, 4).viscosity == 50 && law_at(scene, 4, 4).yield_stress == 900));
    CHECK((law_at(scene, 39, 0).viscosity == 80 && law_at(scene, 39, 0).yield_stress == 400));
    CHECK(std::get<bed::Coulomb>(scene.bed_laws()->at(4 * 40 + 4)).mu == 0.4);
    CHECK(std::get<rheology::Bingham>(scene.rheology).yield_stress == Approx(400.0 + 500.0 * 16 / 1200.0));
    CHECK(scene.friction->keys == std::vector<std::string>{"mu", "rheology.viscosity", "rheology.yield_stress"});
    CHECK(friction_sentence(scene.friction->parts[0]) ==
          "400 m2, mu 0.4, rheology.viscosity 50 Pa s, rheology.yield_stress 900 Pa");
    const Scene of_rheology = scene_of(gis, std::string(kMud) + kBingham + "yield_stress = 400\n" +
                                                "[[material.zone]]\nabove = 150\nrheology.viscosity = 80\n");
    CHECK(of_rheology.rheologies() != nullptr);
    CHECK(of_rheology.bed_laws() == nullptr);  // which costs time
}

TEST_CASE("A rheology by elevation is that by outline, and that of a raster", "[zones][scene]") {
    FakeGis gis = slope_gis();
    gis.polygons["high.geojson"] = rectangle(1100, 1990, 1300, 2200);
    gis.rasters["tau.tif"] =
        sampled(gis.rasters["dem.tif"].geometry, [](double x, double) { return x > 1100.0 ? 700.0 : 400.0; });
    const std::string law = std::string(kMud) + kBingham, number = law + "yield_stress = 400\n[[material.zone]]\n";
    const Scene high = scene_of(gis, number + "above = 150\nrheology.yield_stress = 700\n");
    const Scene inside = scene_of(gis, number + "outline = \"high.geojson\"\nrheology.yield_stress = 700\n");
    const Scene raster = scene_of(gis, law + "yield_stress = \"tau.tif\"\n");
    CHECK(law_at(high, 20, 3).yield_stress == 700);
    CHECK(law_at(high, 19, 3).yield_stress == 400);
    for (const Scene* other : {&inside, &raster}) CHECK(other->rheologies()->place == high.rheologies()->place);
    const Scene one = scene_of(gis, law + "yield_stress = 400\n");
    CHECK(one.rheologies() == nullptr);
    gis.rasters["tau.tif"] = sampled(gis.rasters["dem.tif"].geometry, [](double, double) { return 400.0; });
    DepthAveraged constant(scene_of(gis, law + "yield_stress = \"tau.tif\"\n")), plain(one);
    run_to(constant, 2.0), run_to(plain, 2.0);
    check_same(constant, plain);
}

TEST_CASE("What is wrong with zones and rasters of a rheology is said in one sentence", "[zones][scene]") {
    FakeGis gis = slope_gis();
    gis.rasters["tau.tif"] = sampled(gis.rasters["dem.tif"].geometry, [](double, double) { return 400.0; });
    const std::string mud = std::string(kMud) + kBingham, number = mud + "yield_stress = 400\n",
                      zone = number + "[[material.zone]]\nabove = 150\n";
    gis.rasters["tau.tif"].at(7, 5) = -1.0;
    CHECK(has(problem_of(gis, mud + "yield_stress = \"tau.tif\"\n"),
              "tau.tif: found 1 pixel(s) out of range, such as -1 at x 1037.5, y 2027.5; expected numbers"));
    gis.rasters["tau.tif"].at(7, 5) = NAN;
    CHECK(has(
        problem_of(gis, mud + "yield_stress = \"tau.tif\"\n"),
        "material.rheology.law: found no value at 1 of 1200 nodes, such as x 1037.5, y 2027.5; expected one at each, "
        "since material.rheology.yield_stress has no default; fill the gaps of the raster, or give "
        "rheology.yield_stress there by a [[material.zone]]"));
    CHECK(law_at(
              scene_of(gis, mud + "yield_stress = \"tau.tif\"\n[[material.zone]]\nbelow = 150\nrheology.yield_stress = "
                                  "90\n"),
              7, 5)
              .yield_stress == 90);
    CHECK(has(problem_of(gis, zone + "rheology.yield_stress = -3\n"), "rheology.yield_stress"));
    CHECK(has(problem_of(gis, zone + "mu = 0.3\nrheology.yield_stres = 3\n"),
              "did you mean material.zone.rheology.yield_stress?"));
    CHECK(has(problem_of(gis, zone),
              "expected keys of the case's laws: friction_angle_deg, mu, rheology.viscosity, rheology.yield_stress"));
    CHECK(
        has(problem_of(gis, std::string(kMud) +
                                "[material.rheology]\nlaw = \"newtonian\"\nviscosity = 3\n[[material.zone]]\nabove = "
                                "10\nrheology.yield_stress = 3\n"),
            "material.zone.0.rheology.yield_stress: found, but material.rheology.law = \"newtonian\" does not use it; "
            "expected keys of that law: rheology.viscosity"));
    CHECK(has(problem_of(gis, zone + "water.manning_n = 0.1\n"),
              "found, but water.friction = \"none\" does not use it; expected keys of that law: none"));
    const std::string stage = "[[stage]]\nmodel = \"mpm3d\"\nwindow = [1020, 2020, 1100, 2100]\n";
    CHECK(has(problem_of(gis, zone + "rheology.yield_stress = 900\n" + stage),
              "material.rheology.law: found \"bingham\" that varies from place to place, with a stage that takes its "
              "numbers"));
    CHECK_NOTHROW(scene_of(gis, zone + "rheology.yield_stress = 900\n" + stage + "viscosity = 5\nyield_stress = 50\n"));
}

TEST_CASE("Overrides reach a zone's rheology, and a resolved case has it", "[zones][scene]") {
    const std::string text =
        "[terrain]\ndem = \"dem.tif\"\n[[release]]\noutline = \"release.geojson\"\ndepth = 2\n[time]\nend = 20\n" +
        std::string(kMud) + kBingham + "yield_stress = 400\n[[material.zone]]\nabove = 150\nrheology.viscosity = 3\n";
    const CaseFile file = CaseFile::parse(text, "slide/case.toml",
                                          {"material.zone.0.rheology.viscosity=7", "material.zone.1.below=110",
                                           "material.zone.1.rheology.yield_stress=50"});
    const Scene scene = build_scene(file, slope_gis());
    CHECK((law_at(scene, 39, 0).viscosity == 7 && law_at(scene, 0, 0).yield_stress == 50));
    const std::string resolved = resolved_toml(file);
    CHECK(has(resolved, "rheology.viscosity = 7.0\n"));
    const CaseFile again = CaseFile::parse(resolved, "slide/case.toml");
    CHECK(again.number("material.zone.1.rheology.yield_stress") == 50);
}

}  // namespace frana::zone_rheology_test
