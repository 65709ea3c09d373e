// From depth-averaged particles to 3D points: places, shares, velocities, stresses, and what is conserved.
#include "base/error.h"
#include "catch.h"
#include "convert/conservation.h"
#include "convert/paper_errors.h"
#include "flow_maker.h"

using namespace frana;
using namespace flow_maker;

namespace {

constexpr VelocityProfile kProfiles[] = {VelocityProfile::plug, VelocityProfile::linear, VelocityProfile::parabolic,
                                         VelocityProfile::bagnold};

/// One particle: 3 m deep over a bed at 10 m, 6 kg, 3e-3 m3, (4, 2) m/s, slope (0.5, -0.25), 30 Pa at the bed.
FlowParticles one_particle(double depth = 3.0) {
    FlowParticles c;
    c.x = {1.0}, c.y = {2.0}, c.bed = {10.0}, c.depth = {depth};
    c.slope_x = {0.5}, c.slope_y = {-0.25};
    c.vx = {4.0}, c.vy = {2.0};
    c.mass = {6.0}, c.volume = {3e-3}, c.bed_pressure = {30.0};
    c.stress = {5.0, -2.0, 1.5};
    c.id = {17.0};
    return c;
}

std::vector<double> elevations(const SolidPoints& points) {
    std::vector<double> z;
    for (std::size_t k = 0; k < points.count(); ++k) z.push_back(points.position[3 * k + 2]);
    return z;
}

/// Largest difference of two lists.
double apart(const std::vector<double>& a, const std::vector<double>& b) {
    REQUIRE(a.size() == b.size());
    double most = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k) most = std::max(most, std::abs(a[k] - b[k]));
    return most;
}

/// Distance of the layers' energy factor from the exact one.
double factor_error(VelocityProfile profile, Layers layers, Index count) {
    return std::abs(layer_energy_factor(layer_speeds(profile, layer_heights(layers, count))) -
                    exact_energy_factor(profile));
}

}  // namespace

TEST_CASE("A particle has as many layers as spacings fit, at least one, also where decimal numbers have no binary form",
          "[convert]") {
    CHECK(layer_count(0.0, 0.5) == 1);
    CHECK(layer_count(0.49, 0.5) == 1);
    CHECK(layer_count(3.0, 1.0) == 3);
    CHECK(layer_count(3.99, 1.0) == 3);
    CHECK(layer_count(0.3, 0.1) == 3);                        // 0.3 / 0.1 < 3 in double
    CHECK(layer_count(static_cast<float>(0.7), 0.1) == 7);    // 0.7 as a frame holds it, 0.699999988
    CHECK(layer_count(1e300, 1e-10) == 1000000000000000000);  // no overflow
}

TEST_CASE("Points stand in the middle of equal slices, or from bed to surface; a lone one in the middle", "[convert]") {
    ConversionChoice choice;
    const SolidPoints middle = particles_to_points(one_particle(), choice);
    CHECK(elevations(middle) == std::vector<double>{10.5, 11.5, 12.5});
    CHECK(middle.position[0] == 1.0);
    CHECK(middle.position[1] == 2.0);
    CHECK(middle.height == std::vector<double>{1.0, 1.0, 1.0});
    CHECK(middle.particle == std::vector<double>{17.0, 17.0, 17.0});
    choice.layers = Layers::end_points;
    CHECK(elevations(particles_to_points(one_particle(), choice)) == std::vector<double>{10.0, 11.5, 13.0});
    CHECK(elevations(particles_to_points(one_particle(0.6), choice)) == std::vector<double>{10.3});  // not 0 / 0
}

TEST_CASE("Mass and volume are shared evenly, pressure is linear, stress is minus it and the rheology's", "[convert]") {
    const SolidPoints points = particles_to_points(one_particle(), {});
    CHECK(apart(points.mass, {2.0, 2.0, 2.0}) < 1e-15);
    CHECK(apart(points.volume, {1e-3, 1e-3, 1e-3}) < 1e-18);
    CHECK(apart(points.pressure, {25.0, 15.0, 5.0}) < 1e-14);
    const std::vector<double> lowest(points.stress.begin(), points.stress.begin() + 6);
    CHECK(apart(lowest, {-20.0, -27.0, -28.0, 1.5, 0.0, 0.0}) < 1e-14);
    CHECK(lowest[0] + lowest[1] + lowest[2] == Approx(-3.0 * points.pressure[0]).epsilon(1e-15));
}

TEST_CASE("Velocity follows the profile and, unless told otherwise, the bed", "[convert]") {
    ConversionChoice choice;
    choice.profile = VelocityProfile::linear;
    const SolidPoints along = particles_to_points(one_particle(), choice);
    // 2 s = 1/3, 1, 5/3; w = 0.5 * 4 - 0.25 * 2 = 1.5 times that
    CHECK(apart(along.velocity, {4 / 3.0, 2 / 3.0, 0.5, 4, 2, 1.5, 20 / 3.0, 10 / 3.0, 2.5}) < 1e-14);
    choice.vertical = Vertical::zero;
    const SolidPoints level = particles_to_points(one_particle(), choice);
    CHECK(apart(level.velocity, {4 / 3.0, 2 / 3.0, 0, 4, 2, 0, 20 / 3.0, 10 / 3.0, 0}) < 1e-14);
}

TEST_CASE("Every profile has mean 1 and its energy factor as integrals", "[convert]") {
    for (const VelocityProfile profile : kProfiles) {
        double mean = 0.0, square = 0.0;
        constexpr int n = 100000;  // midpoint rule, error 1 / (24 n^2) times a slope below 12: under 1e-10
        for (int i = 0; i < n; ++i) {
            const double f = profile_value(profile, (i + 0.5) / n);
            mean += f / n;
            square += f * f / n;
        }
        CHECK(mean == Approx(1.0).epsilon(1e-9));
        CHECK(square == Approx(exact_energy_factor(profile)).epsilon(1e-9));
    }
}

TEST_CASE("The layers' energy factor goes to the exact one: second order in centred layers, first in end points",
          "[convert]") {
    for (const VelocityProfile profile : kProfiles) {
        if (profile == VelocityProfile::plug) {
            for (const Index count : {1, 2, 37}) CHECK(factor_error(profile, Layers::centres, count) < 1e-15);
            continue;
        }
        INFO("profile " << static_cast<int>(profile));
        const auto order = [&](Layers layers) {
            return std::log2(factor_error(profile, layers, 64) / factor_error(profile, layers, 128));
        };
        // Midpoint rule on functions with one or more bounded derivatives; the end points' outer slices count double.
        CHECK(order(Layers::centres) == Approx(2.0).margin(0.1));
        CHECK(order(Layers::end_points) == Approx(1.0).margin(0.1));
    }
    // The linear one in closed form: 4/3 - 1 / (3 M^2).
    for (const Index count : {1, 2, 5, 100})
        CHECK(layer_energy_factor(layer_speeds(VelocityProfile::linear, layer_heights(Layers::centres, count))) ==
              Approx(4.0 / 3.0 - 1.0 / (3.0 * static_cast<double>(count * count))).epsilon(1e-14));
}

TEST_CASE("Mass, volume and horizontal momentum are conserved in total and per particle, whatever is chosen",
          "[convert]") {
    const Raster bed = tilted_bed(30, 2.0);
    const FlowParticles particles = uneven_flow(bed, 1300.0, 9.81);
    for (const VelocityProfile profile : kProfiles)
        for (const Layers layers : {Layers::centres, Layers::end_points})
            for (const double spacing : {5.0, 0.7, 0.01}) {
                const ConversionChoice choice{spacing, layers, Vertical::along_bed, profile};
                const SolidPoints points = particles_to_points(particles, choice);
                CHECK(static_cast<double>(points.count()) == forecast_points(particles, spacing));
                const Conservation c = conservation_of(particles, points, choice);
                REQUIRE(c.kept.size() == 4);
                for (const Kept& kept : c.kept) {
                    INFO(kept.name << " spacing " << spacing << " profile " << static_cast<int>(profile));
                    CHECK(kept.particles != 0.0);
                    CHECK(kept.relative_error <= 1e-12);  // round-off of a sum over all points
                    CHECK(kept.worst_particle <= 1e-12);
                }
                CHECK(c.outside == 0.0);
                CHECK(c.particles == particles.count());
                CHECK(c.points == points.count());
            }
}

TEST_CASE("The table of conservation sees what is lost", "[convert]") {
    const FlowParticles particles = one_particle();
    SolidPoints points = particles_to_points(particles, {});
    points.mass[1] *= 1.01;             // 0.02 of 6 kg
    points.position[3 * 2 + 2] = 13.1;  // above the free surface
    const Conservation c = conservation_of(particles, points, {});
    CHECK(c.kept[0].relative_error == Approx(0.02 / 6.0));
    CHECK(c.kept[0].worst_particle == Approx(0.02 / 6.0));
    CHECK(c.kept[1].relative_error < 1e-15);
    CHECK(c.kept[2].worst_particle == Approx(0.02 / 6.0 * 4.0 / std::hypot(4.0, 2.0)));
    CHECK(c.outside == Approx(1.0 / 3.0));
    CHECK_THAT(conservation_text(c), Catch::Contains("mass [kg]") && Catch::Contains("3.33e-03"));
}

TEST_CASE("The kinetic energy of the converted flow is that of the profile", "[convert]") {
    const FlowParticles particles = one_particle(100.0);
    for (const VelocityProfile profile : kProfiles) {
        const ConversionChoice choice{0.1, Layers::centres, Vertical::along_bed, profile};
        const Conservation c = conservation_of(particles, particles_to_points(particles, choice), choice);
        CHECK(c.kinetic_particles == Approx(0.5 * 6.0 * 20.0).epsilon(1e-14));
        CHECK(c.energy_factor == Approx(c.exact_factor).epsilon(2e-6));  // 1000 layers, order 2: about 1 / M^2
        CHECK(c.kinetic_vertical == Approx(c.kinetic_points * 1.5 * 1.5 / 20.0).epsilon(1e-13));
    }
}

TEST_CASE("A plane bed has one gradient everywhere, also at its edge and next to unknown nodes", "[convert][nan]") {
    Raster bed = tilted_bed(6, 2.0);
    bed.at(3, 3) = Raster::nodata;
    const GridGeometry& g = bed.geometry;
    for (const double u : {0.0, 0.3, 1.5, 2.0, 5.0})
        for (const double v : {0.0, 0.7, 1.5, 5.0}) {
            const Vec2 slope = bed_gradient(bed, g.x0 + 2.0 * u, g.y0 + 2.0 * v);
            CHECK(slope[0] == Approx(-0.5).epsilon(1e-9));  // map coordinates of 5e6 have 1e-9 m
            CHECK(slope[1] == Approx(0.25).epsilon(1e-9));
        }
    CHECK(bed_gradient(bed, g.x0 - 50.0, g.y0) == Vec2(0.0, 0.0));
}

TEST_CASE("A spacing that is no distance is refused with a sentence", "[convert]") {
    for (const double spacing : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
        ConversionChoice choice;
        choice.spacing = spacing;
        CHECK_THROWS_WITH(particles_to_points(one_particle(), choice),
                          Catch::Contains("--spacing: found") && Catch::Contains("above 0"));
    }
}

TEST_CASE("The paper's error measures are the same from particles as from the points they become", "[convert]") {
    const FlowParticles particles = uneven_flow(tilted_bed(12, 2.0), 1000.0, 9.81);
    ExactTotals exact;
    for (std::size_t p = 0; p < particles.count(); ++p) {
        exact.mass += particles.mass[p];
        exact.momentum += particles.mass[p] * particles.vx[p];
    }
    ConversionChoice choice;
    choice.spacing = 0.4;
    const SolidPoints points = particles_to_points(particles, choice);
    const auto particle = [&](Index k) {
        const auto p = static_cast<std::size_t>(k);
        return ErrorParticle{particles.depth[p], particles.mass[p], particles.volume[p],
                             particles.mass[p] * particles.vx[p]};
    };
    const ConversionErrors before = conversion_errors(static_cast<Index>(particles.count()), particle, 0.4, exact);
    const ConversionErrors after = conversion_errors(points, exact);
    CHECK(before.points == static_cast<double>(points.count()));
    CHECK(after.points == before.points);
    CHECK(after.mass == Approx(before.mass).epsilon(1e-12));
    CHECK(after.momentum == Approx(before.momentum).epsilon(1e-12));
}

TEST_CASE("The paper's error measure is the root of a mean over the volume", "[convert]") {
    // Two particles of 2 and 1 layers: points of 3, 3 and 9 kg, 1, 1 and 4 m3; 15 kg over three points are 5 kg each.
    const ErrorParticle two[] = {{2.5, 6.0, 2.0, 12.0}, {1.0, 9.0, 4.0, 0.0}};
    const ConversionErrors errors = conversion_errors(2, [&](Index p) { return two[p]; }, 1.0, {15.0, 12.0});
    CHECK(errors.points == 3.0);
    CHECK(errors.mass == Approx(std::sqrt((2 * 4.0 + 4 * 16.0) / 6.0)).epsilon(1e-14));
    CHECK(errors.momentum == Approx(std::sqrt((2 * 4.0 + 4 * 16.0) / 6.0)).epsilon(1e-14));  // 6, 6, 0 around 4
}
