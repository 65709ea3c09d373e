#include "convert/conservation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/compensated_sum.h"

namespace frana {
namespace {

/// A quantity of a particle, of a point, and what an error of the particle is relative to.
struct Both {
    double particle = 0.0, points = 0.0, scale = 0.0;
};

/// Collects the particles of one quantity.
class Ledger {
public:
    Ledger(std::string name, std::string unit) { kept_.name = std::move(name), kept_.unit = std::move(unit); }
    void add(const Both& both) {
        particles_.add(both.particle);
        points_.add(both.points);
        scale_.add(both.scale);
        const double error = std::abs(both.points - both.particle);
        if (error > 0.0) kept_.worst_particle = std::max(kept_.worst_particle, error / both.scale);
    }
    Kept close() {
        kept_.particles = particles_.value();
        kept_.points = points_.value();
        const double error = std::abs(kept_.points - kept_.particles);
        if (error > 0.0) kept_.relative_error = error / scale_.value();
        return kept_;
    }

private:
    Kept kept_;
    CompensatedSum particles_, points_, scale_;
};

struct ParticleSums {
    CompensatedSum mass, volume, momentum[2], kinetic, vertical;
};

ParticleSums sums_of(const SolidPoints& points, std::size_t from, std::size_t to) {
    ParticleSums sums;
    for (std::size_t k = from; k < to; ++k) {
        const double m = points.mass[k];
        const double* v = &points.velocity[3 * k];
        sums.mass.add(m);
        sums.volume.add(points.volume[k]);
        for (int axis = 0; axis < 2; ++axis) sums.momentum[axis].add(m * v[axis]);
        sums.kinetic.add(0.5 * m * (v[0] * v[0] + v[1] * v[1]));
        sums.vertical.add(0.5 * m * v[2] * v[2]);
    }
    return sums;
}

/// Points below their particle's bed or above its free surface, by more than the round-off of an elevation.
std::size_t outside_of(const FlowParticles& particles, const SolidPoints& points, std::size_t p) {
    const double bed = particles.bed[p], top = bed + particles.depth[p],
                 slack = 1e-12 * (std::abs(bed) + particles.depth[p]);
    std::size_t outside = 0;
    for (std::size_t k = points.first[p]; k < points.first[p + 1]; ++k)
        outside += points.position[3 * k + 2] < bed - slack || points.position[3 * k + 2] > top + slack;
    return outside;
}

}  // namespace

Conservation conservation_of(const FlowParticles& particles, const SolidPoints& points,
                             const ConversionChoice& choice) {
    Conservation result;
    result.particles = particles.count();
    result.points = points.count();
    result.exact_factor = exact_energy_factor(choice.profile);
    Ledger mass("mass", "kg"), volume("volume", "m3");
    Ledger momentum[2] = {{"momentum_x", "kg m/s"}, {"momentum_y", "kg m/s"}};
    CompensatedSum kinetic_particles, kinetic_points, kinetic_vertical;
    std::size_t outside = 0;
    for (std::size_t p = 0; p < particles.count(); ++p) {
        const ParticleSums sums = sums_of(points, points.first[p], points.first[p + 1]);
        const double m = particles.mass[p], v[2] = {particles.vx[p], particles.vy[p]}, speed = std::hypot(v[0], v[1]);
        mass.add({m, sums.mass.value(), m});
        volume.add({particles.volume[p], sums.volume.value(), particles.volume[p]});
        for (int axis = 0; axis < 2; ++axis) momentum[axis].add({m * v[axis], sums.momentum[axis].value(), m * speed});
        kinetic_particles.add(0.5 * m * speed * speed);
        kinetic_points.add(sums.kinetic.value());
        kinetic_vertical.add(sums.vertical.value());
        result.most_layers = std::max(result.most_layers, points.first[p + 1] - points.first[p]);
        outside += outside_of(particles, points, p);
    }
    result.kept = {mass.close(), volume.close(), momentum[0].close(), momentum[1].close()};
    result.kinetic_particles = kinetic_particles.value();
    result.kinetic_points = kinetic_points.value();
    result.kinetic_vertical = kinetic_vertical.value();
    if (result.kinetic_particles > 0.0) result.energy_factor = result.kinetic_points / result.kinetic_particles;
    if (result.points > 0) result.outside = static_cast<double>(outside) / static_cast<double>(result.points);
    return result;
}

std::string conservation_text(const Conservation& c) {
    std::string text = fmt::format("{:<22} {:>16} {:>16} {:>15} {:>15}\n", "conserved", "particles", "points",
                                   "relative error", "worst particle");
    for (const Kept& kept : c.kept)
        text += fmt::format("{:<22} {:>16.9g} {:>16.9g} {:>15.2e} {:>15.2e}\n", kept.name + " [" + kept.unit + "]",
                            kept.particles, kept.points, kept.relative_error, kept.worst_particle);
    text += fmt::format("{:<22} {:>16.9g} {:>16.9g}   factor {:.6g}, of the profile {:.6g}\n", "kinetic energy [J]",
                        c.kinetic_particles, c.kinetic_points, c.energy_factor, c.exact_factor);
    text += fmt::format("{:<22} {:>16} {:>16.9g}\n", "  of vertical motion", "", c.kinetic_vertical);
    return text + fmt::format("{:<22} {:>16} {:>16}   up to {} layers, {:.4g} % between bed and surface\n", "number",
                              c.particles, c.points, c.most_layers, 100.0 * (1.0 - c.outside));
}

std::string conservation_json(const Conservation& c) {
    std::string text = "{";
    for (const Kept& kept : c.kept)
        text += fmt::format(
            "\n  \"{}\": {{\"unit\": \"{}\", \"columns\": {}, \"points\": {}, \"relative_error\": {}, "
            "\"worst_column\": {}}},",
            kept.name, kept.unit, kept.particles, kept.points, kept.relative_error, kept.worst_particle);
    text += fmt::format(
        "\n  \"kinetic_energy\": {{\"unit\": \"J\", \"columns\": {}, \"points\": {}, \"vertical\": {}, \"factor\": {}, "
        "\"exact_factor\": {}}},",
        c.kinetic_particles, c.kinetic_points, c.kinetic_vertical, c.energy_factor, c.exact_factor);
    return text +
           fmt::format("\n  \"columns\": {},\n  \"points\": {},\n  \"most_layers\": {},\n  \"outside\": {}\n}}\n",
                       c.particles, c.points, c.most_layers, c.outside);
}

}  // namespace frana
