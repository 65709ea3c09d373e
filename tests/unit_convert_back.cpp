// From 3D points back to depth-averaged particles and rasters.
#include <numeric>

#include "catch.h"
#include "convert/conservation.h"
#include "convert/gather.h"
#include "flow_maker.h"

using namespace frana;
using namespace flow_maker;

namespace {

constexpr double kGate = 1e-12;  // round-off of a sum over all points, there and back

double relative(double a, double b, double scale) { return a == b ? 0.0 : std::abs(a - b) / scale; }

}  // namespace

TEST_CASE("Into 3D and back gives every particle its mass, volume and momentum again", "[convert]") {
    const Raster bed = tilted_bed(30, 2.0);
    const FlowParticles particles = uneven_flow(bed, 1300.0, 9.81);  // one in each inner pixel
    const ConversionChoice choice{0.3, Layers::centres, Vertical::along_bed, VelocityProfile::bagnold};
    const GatheredFlow back = points_to_particles(particles_to_points(particles, choice), bed);
    REQUIRE(back.particles.count() == particles.count());
    CHECK(back.outside == 0);
    double worst = 0.0, place = 0.0, pressure = 0.0, slope = 0.0;
    for (std::size_t p = 0; p < particles.count(); ++p) {
        const FlowParticles& c = back.particles;
        const double m = particles.mass[p], momentum = m * std::hypot(particles.vx[p], particles.vy[p]);
        worst =
            std::max({worst, relative(c.mass[p], m, m), relative(c.volume[p], particles.volume[p], particles.volume[p]),
                      relative(c.mass[p] * c.vx[p], m * particles.vx[p], momentum),
                      relative(c.mass[p] * c.vy[p], m * particles.vy[p], momentum),
                      relative(c.depth[p], particles.volume[p] / 4.0, c.depth[p])});
        place = std::max({place, std::abs(c.x[p] - particles.x[p]), std::abs(c.y[p] - particles.y[p]),
                          std::abs(c.bed[p] - particles.bed[p])});
        pressure =
            std::max(pressure, relative(c.bed_pressure[p], particles.bed_pressure[p], particles.bed_pressure[p]));
        slope = std::max({slope, std::abs(c.slope_x[p] + 0.5), std::abs(c.slope_y[p] - 0.25)});
    }
    CHECK(worst <= kGate);
    CHECK(place <= 1e-8);  // digits of map coordinates of 5e6 m
    CHECK(pressure <= kGate);
    CHECK(slope <= 1e-8);
}

TEST_CASE("Coarse pixels hold the sums of their particles, and the motion within is counted as given up",
          "[convert][nan]") {
    const Raster bed = tilted_bed(30, 2.0), coarse = tilted_bed(6, 13.0);
    const FlowParticles particles = uneven_flow(bed, 1300.0, 9.81);
    const ConversionChoice choice{0.3, Layers::end_points, Vertical::zero, VelocityProfile::linear};
    const SolidPoints points = particles_to_points(particles, choice);
    const GatheredFlow back = points_to_particles(points, coarse);
    REQUIRE(back.particles.count() < particles.count() / 10);
    REQUIRE(back.outside == 0);

    std::vector<double> mass(36, 0.0), momentum(36, 0.0), speed(36, 0.0);
    for (std::size_t p = 0; p < particles.count(); ++p) {
        const auto i = static_cast<Index>((particles.x[p] - coarse.geometry.x0) / 13.0 + 0.5);
        const auto j = static_cast<Index>((particles.y[p] - coarse.geometry.y0) / 13.0 + 0.5);
        const auto pixel = static_cast<std::size_t>(j * 6 + i);
        mass[pixel] += particles.mass[p];
        momentum[pixel] += particles.mass[p] * particles.vx[p];
        speed[pixel] += particles.mass[p] * std::abs(particles.vx[p]);
    }
    double kinetic = 0.0;
    for (std::size_t b = 0; b < back.particles.count(); ++b) {
        const auto pixel = static_cast<std::size_t>(back.pixel[b]);
        CHECK(relative(back.particles.mass[b], mass[pixel], mass[pixel]) <= kGate);
        CHECK(relative(back.particles.mass[b] * back.particles.vx[b], momentum[pixel], speed[pixel]) <= kGate);
        CHECK(back.kinetic[b] > 0.0);
        kinetic += back.kinetic[b] +
                   0.5 * back.particles.mass[b] *
                       (back.particles.vx[b] * back.particles.vx[b] + back.particles.vy[b] * back.particles.vy[b]);
    }
    const Conservation c = conservation_of(particles, points, choice);
    CHECK(kinetic == Approx(c.kinetic_points + c.kinetic_vertical).epsilon(kGate));
}

TEST_CASE("Rasters of gathered points hold their volume and momentum, and nodata where there is no bed",
          "[convert][nan]") {
    Raster bed = tilted_bed(12, 2.0);
    FlowParticles particles = uneven_flow(bed, 1000.0, 9.81);
    const SolidPoints points = particles_to_points(particles, {});
    bed.at(0, 0) = Raster::nodata;
    const FlowRasters rasters = rasters_of(points_to_particles(points, bed), bed);
    double volume = 0.0, momentum = 0.0, of_particles = 0.0, moved = 0.0;
    for (Index k = 0; k < bed.geometry.size(); ++k) {
        const auto at = static_cast<std::size_t>(k);
        if (k == 0) continue;
        volume += 4.0 * rasters.depth.values[at];
        momentum += 4000.0 * rasters.depth.values[at] * rasters.velocity_x.values[at];
    }
    for (std::size_t p = 0; p < particles.count(); ++p) {
        of_particles += particles.mass[p] * particles.vx[p];
        moved += particles.mass[p] * std::abs(particles.vx[p]);
    }
    CHECK(volume == Approx(std::accumulate(particles.volume.begin(), particles.volume.end(), 0.0)).epsilon(kGate));
    CHECK(std::abs(momentum - of_particles) <= kGate * moved);
    CHECK(std::isnan(rasters.depth.values[0]));
    CHECK(rasters.depth.at(1, 0) == 0.0);
}

TEST_CASE("Points beyond the pixels or over unknown bed are counted, not placed", "[convert][nan]") {
    Raster bed = tilted_bed(12, 2.0);
    const FlowParticles particles = uneven_flow(bed, 1000.0, 9.81);
    SolidPoints points = particles_to_points(particles, {});
    bed.at(5, 5) = Raster::nodata;
    points.position[0] = bed.geometry.x0 - 100.0;
    const GatheredFlow back = points_to_particles(points, bed);
    double inside = 0.0, all = 0.0;
    for (const double m : back.particles.mass) inside += m;
    for (const double m : points.mass) all += m;
    CHECK(back.outside > 1);
    CHECK(inside + back.mass_outside == Approx(all).epsilon(1e-13));
    for (const Index pixel : back.pixel) CHECK(pixel != 5 * 12 + 5);
}
