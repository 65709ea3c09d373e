#include "convert/flow_particles.h"

#include <cmath>

#include "terrain/bed_points.h"

namespace frana {
namespace {

constexpr std::vector<double> FlowParticles::*kNumbers[] = {
    &FlowParticles::x,       &FlowParticles::y,       &FlowParticles::bed,          &FlowParticles::depth,
    &FlowParticles::slope_x, &FlowParticles::slope_y, &FlowParticles::vx,           &FlowParticles::vy,
    &FlowParticles::mass,    &FlowParticles::volume,  &FlowParticles::bed_pressure, &FlowParticles::id};

/// Slope between the elevations half a cell before, at, and half a cell behind a point.
double quotient(double before, double here, double behind, double cell) {
    if (std::isfinite(before) && std::isfinite(behind)) return (behind - before) / cell;
    if (std::isfinite(before) && std::isfinite(here)) return (here - before) / (0.5 * cell);
    if (std::isfinite(behind) && std::isfinite(here)) return (behind - here) / (0.5 * cell);
    return 0.0;
}

}  // namespace

void FlowParticles::reserve(std::size_t particles) {
    for (const auto member : kNumbers) (this->*member).reserve(particles);
}

void FlowParticles::take(const FlowParticles& other, std::size_t k) {
    for (const auto member : kNumbers) (this->*member).push_back((other.*member)[k]);
    if (!other.domain.empty()) domain.push_back(other.domain[k]);
    if (other.stress.empty()) return;
    for (std::size_t c = 0; c < 3; ++c) stress.push_back(other.stress[3 * k + c]);
}

Vec2 bed_gradient(const Raster& bed, double x, double y) {
    const double half = 0.5 * bed.geometry.cell, here = bed_elevation(bed, x, y);
    return {quotient(bed_elevation(bed, x - half, y), here, bed_elevation(bed, x + half, y), bed.geometry.cell),
            quotient(bed_elevation(bed, x, y - half), here, bed_elevation(bed, x, y + half), bed.geometry.cell)};
}

void take_slopes(FlowParticles& particles, const Raster& bed) {
    particles.slope_x.resize(particles.count());
    particles.slope_y.resize(particles.count());
    for (std::size_t p = 0; p < particles.count(); ++p) {
        const Vec2 slope = bed_gradient(bed, particles.x[p], particles.y[p]);
        particles.slope_x[p] = slope[0];
        particles.slope_y[p] = slope[1];
    }
}

}  // namespace frana
