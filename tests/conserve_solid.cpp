// What the 3D model keeps: mass, momentum against what gravity and surfaces give, the bits.
#include <omp.h>

#include <random>

#include "base/constants.h"
#include "base/error.h"
#include "catch.h"
#include "checks/verify/library.h"
#include "solid_maker.h"

using namespace frana;

namespace {

void steps(Mpm3d& flow, int count) {
    for (int n = 0; n < count; ++n) flow.advance(1e9);
}

/// Places of the points, in the order of the scene's; zero for those that left.
std::vector<Vec3> by_id(const Mpm3d& flow, const SolidScene& scene) {
    std::vector<Vec3> x(scene.points.mass.size(), Vec3::Zero());
    for (Index p = 0; p < flow.body().points.count(); ++p)
        x[static_cast<std::size_t>(flow.body().points.id[p])] = flow.position(p);
    return x;
}

}  // namespace

TEST_CASE("Mass in 3D is exact, and momentum changes by what gravity and surfaces give", "[solid]") {
    for (const SolidLaw& law : all_solid_laws()) {
        CAPTURE(law.index());
        Mpm3d flow(lump(law));
        const double mass = flow.status().mass;
        steps(flow, 300);
        CHECK(flow.status().mass + flow.status().mass_left == Approx(mass).epsilon(1e-14));
        CHECK(flow.status().points == flow.body().points.count());
        const double given = flow.status().weight_impulse.norm();
        CHECK(flow.momentum_residual().norm() < 1e-12 * given);
        CHECK(flow.body().impulse[0].z() > 0.1 * given);  // it has met the floor
    }
}

TEST_CASE("Points that retain their velocities conserve mass and momentum too, with the same bits for any threads",
          "[solid][threads]") {
    const int threads = omp_get_max_threads();
    for (const SolidLaw& law : all_solid_laws()) {
        CAPTURE(law.index());
        const SolidScene scene = kept(lump(law));
        std::vector<std::vector<Vec3>> places;
        for (const int count : {1, 3}) {
            omp_set_num_threads(count);
            Mpm3d flow(scene);
            const double mass = flow.status().mass;
            steps(flow, 200);
            CHECK(flow.status().mass + flow.status().mass_left == Approx(mass).epsilon(1e-14));
            CHECK(flow.momentum_residual().norm() < 1e-12 * flow.status().weight_impulse.norm());
            places.push_back(by_id(flow, scene));
            places.back().push_back(flow.body().impulse[0]);
        }
        omp_set_num_threads(threads);
        CHECK(places[0] == places[1]);
    }
}

TEST_CASE("The 3D ledger of energy has each loss under its name", "[solid]") {
    const auto run = [](SolidScene s, double end) {
        Mpm3d flow(s);
        while (flow.status().time < end) flow.advance(end);
        return flow.status();
    };
    for (const bool flip : {false, true}) {
        CAPTURE(flip);
        SolidScene s = lump(solid::Elastic::of(4e5, 0.3));
        if (flip) s = kept(s);
        s.surfaces.clear();
        s.points.velocity.assign(s.points.velocity.size(), Vec3(0.3, -0.2, 0.1));
        const SolidStatus fall = run(s, 0.2);
        const double gained = 0.5 * fall.mass * 0.2 * 0.2 * 9.81 * 9.81;
        // Nothing is lost in free fall; velocity first, so that a step's m g^2 dt t is not.
        CHECK(fall.stored == Approx(0.0).margin(1e-12 * gained));
        CHECK(fall.material == Approx(0.0).margin(1e-12 * gained));
        CHECK(fall.contact_work == 0.0);
        CHECK(fall.friction == 0.0);
        CHECK(std::abs(fall.numerical()) < 0.02 * gained);
    }
    // On the slope: friction takes, sand yields, and a smooth slope takes no friction.
    const SolidLaw sand = solid::DruckerPrager::of(solid::Elastic::of(4e5, 0.3), 0.5, 0.0);
    const SolidStatus rough = run(lump(sand), 0.4), elastic = run(lump(solid::Elastic::of(4e5, 0.3)), 0.4);
    CHECK(rough.friction > 0.0);
    CHECK(rough.material > 0.0);
    // Of the fall: third order in the step, and the impact on so soft a body strains by per cents in one.
    CHECK(std::abs(elastic.material) < 0.01 * (elastic.energy_given - elastic.potential));
    CHECK(elastic.stored > 0.0);
    SolidScene smooth = lump(sand);
    smooth.surfaces[0].friction = 0.0;
    CHECK(std::abs(run(smooth, 0.4).friction) < 1e-12 * rough.friction);
}

TEST_CASE("3D bodies have the same bits for any number of threads", "[solid][threads]") {
    const int threads = omp_get_max_threads();
    for (const SolidLaw& law : all_solid_laws()) {
        CAPTURE(law.index());
        std::vector<std::vector<Vec3>> places;
        for (const int count : {1, law.index() % 2 == 0 ? 2 : 4}) {
            omp_set_num_threads(count);
            const SolidScene scene = lump(law);
            Mpm3d flow(scene);
            steps(flow, 150);
            places.push_back(by_id(flow, scene));
            places.back().push_back(flow.body().impulse[0]);
        }
        omp_set_num_threads(threads);
        CHECK(places[0] == places[1]);
    }
}

TEST_CASE("Tiles that work side by side do not meet, in a long corner", "[solid]") {
    // Ten tiles along a turned floor and a wall: of each colour two or three, and of the images'.
    const int threads = omp_get_max_threads();
    SolidScene s;
    s.grid = {{-0.4, -0.4, -0.4}, 0.1, {89, 25, 81}};
    s.surfaces = {Surface::plane({0, 0, 0}, Vec3(-0.9, 0, 1)), Surface::plane({0, 0, 0}, {0, 1, 0})};
    s.law = solid::Fluid{4e5, 1.0};
    for (int n = 0; n < 70; ++n)
        verify::for_each_part({0.1 * n, 0.0, 0.09 * n}, {0.1 * n + 0.1, 0.9, 0.09 * n + 0.4}, 0.1, 2,
                              [&](const Vec3& x, double volume) {
                                  s.points.add(x, {-1, -0.5, -1}, s.density * volume);
                              });
    std::vector<std::vector<Vec3>> places;
    for (const int count : {1, 2, 4}) {
        omp_set_num_threads(count);
        Mpm3d flow(s);
        steps(flow, 25);
        places.push_back(by_id(flow, s));
        places.back().push_back(flow.body().impulse[0]);
        places.back().push_back(flow.body().impulse[1]);
    }
    omp_set_num_threads(threads);
    CHECK(places[0] == places[1]);
    CHECK(places[0] == places[2]);
}

TEST_CASE("Each surface is credited with what it gives: a rough floor's friction is not its wall's force", "[solid]") {
    // A block slides along a rough floor beside a smooth wall, which it never presses.
    SolidScene s;
    s.grid = {{-0.4, -0.4, -0.4}, 0.1, {31, 15, 15}};
    s.law = solid::Elastic::of(4e5, 0.0);
    s.surfaces = {Surface::plane({0, 0, 0}, {0, 0, 1}, Hold::free, 0.3), Surface::plane({0, 0, 0}, {1, 0, 0})};
    verify::for_each_part({0.05, 0, 0}, {0.85, 0.6, 0.4}, 0.1, 2, [&](const Vec3& x, double volume) {
        s.points.add(x, {1.5, 0, 0}, s.density * volume);  // away from the wall, within its reach
    });
    Mpm3d flow(s);
    while (flow.status().time < 0.05) flow.advance(0.05);
    const Vec3 floor = flow.body().impulse[0], wall = flow.body().impulse[1];
    CHECK(floor.z() > 0.0);
    CHECK(floor.x() == Approx(-0.3 * floor.z()).epsilon(1e-6));
    // A wall is felt a cell and a half early, by what little the rim is stressed; a fifth of the floor lies so near to it.
    CHECK(wall.norm() < 0.02 * std::abs(floor.x()));
}

TEST_CASE("A body that falls free keeps its shape", "[solid]") {
    SolidScene s = lump(solid::Elastic::of(4e5, 0.3));
    s.surfaces.clear();
    s.affine = Affine::apic;
    s.points.velocity.assign(s.points.velocity.size(), Vec3(0.3, -0.2, 0.1));
    const auto start = s.points.position;
    Mpm3d flow(s);
    while (flow.status().time < 0.2) flow.advance(0.2);
    const auto now = by_id(flow, s);
    // Velocity first: x = v t + g t (t + dt) / 2, and dt is below 2 % of the time.
    const Vec3 moved = now[0] - start[0];
    for (std::size_t p = 0; p < now.size(); ++p) REQUIRE((now[p] - start[p] - moved).norm() < 1e-12);
    CHECK(moved.z() == Approx(0.1 * 0.2 - 0.5 * 9.81 * 0.04).epsilon(0.02));
    CHECK(flow.velocity(0).z() == Approx(0.1 - 9.81 * 0.2).epsilon(1e-12));
}

TEST_CASE("A mirrored 3D scene gives the mirrored flow", "[solid]") {
    SolidScene s = lump(solid::Fluid{4e5, 0.0});
    s.surfaces = {Surface::plane({0, 0, 0}, {0, 0, 1}), Surface::plane({0, 0, 0}, {1, 0, 0})};
    s.points = {};
    SolidScene mirror = s;
    // x and y change places: node planes, sums and images are not the same numbers in another order, hence
    // round-off.
    mirror.surfaces[1] = Surface::plane({0, 0, 0}, {0, 1, 0});
    verify::for_each_part({0.2, 0.2, 0.1}, {0.9, 0.8, 0.5}, 0.1, 2, [&](const Vec3& x, double volume) {
        s.points.add(x, {-1, 0.2, 0}, 1000.0 * volume);
        mirror.points.add({x.y(), x.x(), x.z()}, {0.2, -1, 0}, 1000.0 * volume);
    });
    Mpm3d one(s), two(mirror);
    steps(one, 60), steps(two, 60);
    const auto a = by_id(one, s), b = by_id(two, mirror);
    for (std::size_t p = 0; p < a.size(); ++p) REQUIRE((a[p] - Vec3(b[p].y(), b[p].x(), b[p].z())).norm() < 1e-9);
}

namespace {

/// A cylinder of mud around x = 0, so high that it slumps: the whole of it, or the half beyond x = 0 before `middle`.
SolidScene cylinder_of_mud(bool whole, bool stuck, const Surface& middle) {
    constexpr double kRadius = 0.3, kHeight = 0.8, kCell = 0.1, kDensity = 1000.0;
    const double low = whole ? -1.0 : 0.0, bulk = 4e5;
    SolidScene s;
    s.density = kDensity;
    s.law = solid::Bingham{bulk, 1e5, 500.0, 1500.0};
    s.grid = verify::grid_around({}, {low, -1.0, 0.0}, {1.0, 1.0, kHeight}, kCell);
    s.surfaces = {Surface::plane({0, 0, 0}, {0, 0, 1}, stuck ? Hold::stuck : Hold::free)};
    if (!whole) s.surfaces.push_back(middle);
    const double first = whole ? -kRadius : 0.0;
    verify::for_each_part({first, -kRadius, 0}, {kRadius, kRadius, kHeight}, kCell, 2, [&](const Vec3& x, double v) {
        if (x.head<2>().norm() < kRadius) s.points.add(x, {0, 0, 0}, kDensity * v);
    });
    return s;
}

/// Of the points beyond x = 0: how far away from it and how high their middle is [m].
Vec2 middle_of_half(const Mpm3d& flow) {
    Vec2 sum{0, 0};
    double mass = 0.0;
    for (Index p = 0; p < flow.body().points.count(); ++p) {
        const Vec3 x = flow.position(p);
        if (x.x() <= 0.0) continue;
        mass += flow.body().points.mass[p];
        sum += flow.body().points.mass[p] * Vec2(x.x(), x.z());
    }
    return sum / mass;
}

}  // namespace

TEST_CASE("Half of a scene before its plane of symmetry moves as the whole does", "[solid]") {
    const bool stuck = GENERATE(false, true);
    const auto run = [&](bool whole, const Surface& middle) {
        Mpm3d flow(cylinder_of_mud(whole, stuck, middle));
        while (flow.status().time < 1.0) flow.advance(1.0);
        return flow;
    };
    const Surface mirror = Surface::symmetry_plane({0, 0, 0}, {1, 0, 0});
    const Mpm3d whole = run(true, mirror), half = run(false, mirror);
    const Vec2 exact = middle_of_half(whole), found = middle_of_half(half);
    INFO("stuck " << stuck << ", found " << found.transpose() << ", whole " << exact.transpose());
    CHECK((found - exact).norm() < 1e-3);  // a hundredth of a cell
    CHECK(half.status().mass == Approx(0.5 * whole.status().mass).epsilon(1e-12));
    // A wall lets it go: what is next to it does not hang on to the other half.
    const Vec2 before_wall = middle_of_half(run(false, Surface::plane({0, 0, 0}, {1, 0, 0})));
    INFO("before a wall " << before_wall.transpose());
    CHECK((before_wall - exact).norm() > 0.02);
}

TEST_CASE("Points that leave the grid are counted and gone", "[solid]") {
    SolidScene s = lump(solid::Fluid{4e5, 0.0});
    s.surfaces.clear();
    Mpm3d flow(s);
    const double mass = flow.status().mass;
    while (flow.status().time < 0.6) flow.advance(0.6);
    CHECK(flow.status().points < static_cast<Index>(s.points.mass.size()));
    CHECK(flow.body().points.count() == flow.status().points);
    CHECK(flow.status().mass + flow.status().mass_left == Approx(mass).epsilon(1e-14));
    CHECK(flow.momentum_residual().norm() < 1e-12 * mass);
}

TEST_CASE("No point is found behind a surface, and one that is not finite is told of", "[solid]") {
    SolidScene s = lump(solid::DruckerPrager::of(solid::Elastic::of(4e5, 0.3), 0.5, 0.0));
    Mpm3d flow(s);
    for (int n = 0; n < 400; ++n) {
        flow.advance(1e9);
        for (Index p = 0; p < flow.body().points.count(); ++p)
            for (const Surface& surface : s.surfaces) REQUIRE(contact(surface, flow.position(p)).distance > -1e-12);
    }
    s.points.velocity[7].x() = std::nan("");
    for (const bool ground : {false, true}) {
        if (ground) s.surfaces = {Surface::ground(Raster::filled({9, 9, -1.0, -1.0, 0.5}, 0.0))};
        Mpm3d bad(s);
        CHECK_THROWS_AS(bad.advance(1.0), NumericsError);
    }
}

TEST_CASE("A few points alone have a ledger of numbers, wherever they lie between nodes", "[solid]") {
    // Nodes that a point barely touches fly off. No lane without a point may take that for a strain of its own.
    for (const SolidLaw& law : all_solid_laws())
        for (const bool flip : {false, true}) {
            CAPTURE(law.index(), flip);
            std::mt19937_64 random(1);  // its own bits are the same everywhere, those of distributions are not
            const auto dice = [&] { return std::ldexp(static_cast<double>(random() >> 11), -53); };
            for (int n = 0; n < 400; ++n) {
                SolidScene s = lump(law);
                if (flip) s = kept(s);
                s.surfaces.clear();
                s.points = {};
                for (int p = 0; p <= n % 7; ++p) {
                    const auto at = [&] { return 8.5 + (dice() < 0.5 ? -1.0 : 1.0) * std::pow(10.0, -9.0 * dice()); };
                    s.points.add(s.grid.origin + s.grid.cell * Vec3(at(), at(), at()),
                                 {dice() - 0.5, dice() - 0.5, dice() - 0.5}, s.density * 1e-4, 2e4);
                }
                Mpm3d flow(s);
                flow.advance(1e9);
                CHECK(std::isfinite(flow.status().material));
                CHECK(std::isfinite(flow.status().contact_work));
            }
        }
}

// Its gates; with nodes at rest on the floor and behind it both are 0.11.
TEST_CASE("A viscous sheet has its speeds on a floor that holds it, whether nodes lie on it or not", "[solid]") {
    const verify::Problem* sheet = verify::find_problem("viscous_sheet");
    REQUIRE(sheet);
    const verify::Measurement found = sheet->run({sheet->grids.front()});
    for (const verify::Gate& gate : sheet->gates) {
        if (gate.cells > sheet->grids.front()) continue;
        CAPTURE(gate.quantity);
        CHECK(std::abs(found.value(gate.quantity)) <= gate.bound);
    }
}

/// A slice of mud 0.9 m thick that comes with 15 m/s down a slope of 25 degrees, onto a floor that holds it.
SolidScene thrown_mud(double cell) {
    constexpr double density = 1500.0, sound = 150.0, angle = 25.0 * constants::kPi / 180.0;
    SolidScene s;
    s.gravity = {9.81 * std::sin(angle), 0.0, -9.81 * std::cos(angle)};
    s.density = density;
    s.law = solid::Bingham{density * sound * sound, 5e4, 20.0, 500.0};
    s.grid = verify::grid_around({}, {-1.0, 0, 0}, {45.0, 2.0 * cell, 3.0}, cell);
    s.surfaces = {Surface::plane({0, 0, 0}, {0, 0, 1}, Hold::stuck)};
    verify::add_slice(s, 2.0 * cell);
    verify::for_each_part({0, 0, 0}, {12.0, 2.0 * cell, 0.9}, cell, 2, [&](const Vec3& x, double volume) {
        s.points.add(x, {15.0, 0, 0}, density * volume);
    });
    return s;
}

// Were the profile that it has for a moment carried on behind the floor, the floor would drive it: by 0.5 % of its energy.
TEST_CASE("A floor that holds fast mud takes energy from it", "[solid]") {
    for (const char* transfer : {"tpic", "apic"}) {
        CAPTURE(transfer);
        SolidScene s = thrown_mud(0.45);
        if (transfer[0] == 'a') s.affine = Affine::apic;
        Mpm3d flow(s);
        while (flow.status().time < 1.2) flow.advance(1.2);
        CHECK(flow.status().friction > 0.0);
    }
}

// Where nodes behind the floor take part in the turn, points that keep their velocities gain half of the fall and more.
TEST_CASE("A floor that holds material gives it no energy, whatever the transfer", "[solid]") {
    const auto energy = [](const SolidStatus& s) { return s.kinetic + s.stored + s.potential; };
    for (const SolidLaw& law : {SolidLaw(solid::Fluid{4e5, 0.0}), SolidLaw(solid::Bingham{4e5, 1e5, 10.0, 200.0})})
        for (const char* transfer : {"tpic", "apic", "flip"}) {
            CAPTURE(law.index(), transfer);
            SolidScene s = lump(law);
            s.surfaces[0] = Surface::plane({0, 0, 0.03}, {0, 0, 1}, Hold::stuck);
            if (transfer[0] == 'a') s.affine = Affine::apic;
            if (transfer[0] == 'f') s = kept(s), s.blending = 1.0;
            Mpm3d flow(s);
            flow.advance(1e9);
            const double start = energy(flow.status()), fall = flow.status().mass * 9.81 * 0.1;
            double most = 0.0;
            while (flow.status().time < 0.6) {
                flow.advance(0.6);
                most = std::max(most, energy(flow.status()) - start);
            }
            CHECK(most < 1e-3 * fall);
        }
}
