#include "convert/solid_points.h"

#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <new>

#include "base/error.h"

namespace frana {
namespace {

void require_valid(const FlowParticles& particles, const ConversionChoice& choice) {
    require_spacing(choice.spacing);
    const std::size_t n = particles.count();
    for (const auto* numbers :
         {&particles.y, &particles.bed, &particles.depth, &particles.slope_x, &particles.slope_y, &particles.vx,
          &particles.vy, &particles.mass, &particles.volume, &particles.bed_pressure, &particles.id})
        expect(numbers->size() == n, "the particles' arrays have equal lengths");
    expect(particles.stress.empty() || particles.stress.size() == 3 * n, "every particle has a stress, or none has");
}

void make_room(SolidPoints& points, std::size_t count) {
    points.position.resize(3 * count);
    points.velocity.resize(3 * count);
    points.stress.resize(6 * count);
    for (auto* numbers : {&points.mass, &points.volume, &points.pressure, &points.particle, &points.height})
        numbers->resize(count);
}

/// The layers of particle p.
void fill_particle(const FlowParticles& particles, std::size_t p, const ConversionChoice& choice, SolidPoints& points) {
    const auto count = static_cast<Index>(points.first[p + 1] - points.first[p]);
    const std::vector<double> heights = layer_heights(choice.layers, count);
    const std::vector<double> speeds = layer_speeds(choice.profile, heights);
    const double share = 1.0 / static_cast<double>(count), depth = particles.depth[p];
    const double climb = choice.vertical == Vertical::along_bed
                             ? particles.vx[p] * particles.slope_x[p] + particles.vy[p] * particles.slope_y[p]
                             : 0.0;
    std::array<double, 3> sigma{};
    if (!particles.stress.empty())
        for (std::size_t c = 0; c < 3; ++c) sigma[c] = particles.stress[3 * p + c];
    for (std::size_t i = 0; i < heights.size(); ++i) {
        const std::size_t k = points.first[p] + i;
        const double pressure = particles.bed_pressure[p] * (1.0 - heights[i]);
        const double place[3] = {particles.x[p], particles.y[p], particles.bed[p] + heights[i] * depth};
        const double velocity[3] = {particles.vx[p] * speeds[i], particles.vy[p] * speeds[i], climb * speeds[i]};
        const double stress[6] = {
            sigma[0] - pressure, sigma[1] - pressure, -sigma[0] - sigma[1] - pressure, sigma[2], 0.0, 0.0};
        std::copy(place, place + 3, &points.position[3 * k]);
        std::copy(velocity, velocity + 3, &points.velocity[3 * k]);
        std::copy(stress, stress + 6, &points.stress[6 * k]);
        points.mass[k] = particles.mass[p] * share;
        points.volume[k] = particles.volume[p] * share;
        points.pressure[k] = pressure;
        points.particle[k] = particles.id[p];
        points.height[k] = depth * share;
    }
}

}  // namespace

void require_spacing(double spacing) {
    if (!(spacing > 0.0 && std::isfinite(spacing)))
        throw UserError(fmt::format(
            "--spacing: found {}; expected a distance above 0 in metres; give the size of the 3D points", spacing));
}

FlowParticles particles_within(const FlowParticles& particles, const std::array<double, 4>& window) {
    FlowParticles inside;
    for (std::size_t p = 0; p < particles.count(); ++p)
        if (particles.x[p] >= window[0] && particles.x[p] < window[2] && particles.y[p] >= window[1] &&
            particles.y[p] < window[3])
            inside.take(particles, p);
    return inside;
}

double forecast_points(const FlowParticles& particles, double spacing) {
    double count = 0.0;
    for (const double depth : particles.depth) count += static_cast<double>(layer_count(depth, spacing));
    return count;
}

SolidPoints particles_to_points(const FlowParticles& particles, const ConversionChoice& choice) {
    require_valid(particles, choice);
    SolidPoints points;
    points.first.reserve(particles.count() + 1);
    points.first.push_back(0);
    for (const double depth : particles.depth)
        points.first.push_back(points.first.back() + static_cast<std::size_t>(layer_count(depth, choice.spacing)));
    make_room(points, points.first.back());
    std::atomic<bool> short_of_memory{false};  // no exception may leave the loop
#pragma omp parallel for schedule(static)
    for (std::size_t p = 0; p < particles.count(); ++p) {
        try {
            fill_particle(particles, p, choice, points);
        } catch (const std::bad_alloc&) {
            short_of_memory = true;
        }
    }
    if (short_of_memory) throw std::bad_alloc();
    return points;
}

}  // namespace frana
