#include "law/two_phase.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "law/friction_step.h"

namespace frana {
namespace {

constexpr double kStokes = 1e-4;  ///< largest grain that settles as Stokes has it [m]

double relative_weight(const TwoPhaseMaterial& m) {
    return (m.solid_density - m.fluid_density) / m.fluid_density * m.gravity;
}

}  // namespace

double bound_density(const TwoPhaseMaterial& material, const Mixture& mixture) {
    return (mixture.solids * material.solid_density + mixture.confined * mixture.fluid() * material.fluid_density) /
           mixture.bound();
}

double stokes_velocity(const TwoPhaseMaterial& m, double d) {
    return (m.solid_density - m.fluid_density) * m.gravity * d * d / (18.0 * m.viscosity);
}

double zanke_velocity(const TwoPhaseMaterial& m, double d) {
    const double nu = m.viscosity / m.fluid_density;
    const double x = 0.01 * relative_weight(m) * d * d * d / (nu * nu);
    return 10.0 * nu / d * (x / (std::sqrt(1.0 + x) + 1.0));  // sqrt(1 + x) - 1 without its cancellation
}

double terminal_velocity(const TwoPhaseMaterial& m, double d) {
    return d < kStokes ? stokes_velocity(m, d) : zanke_velocity(m, d);
}

double richardson_zaki(double reynolds) {
    if (reynolds < 0.2) return 4.65;
    if (reynolds < 1.0) return 4.35 * std::pow(reynolds, -0.03);
    if (reynolds < 500.0) return 4.45 * std::pow(reynolds, -0.1);
    return 2.39;
}

TwoPhaseDrag::TwoPhaseDrag(const TwoPhaseMaterial& material)
    : material_(material), grain_(settling(material.grain)), block_(settling(material.block)) {
    expect(material.power == 1 || material.power == 2, "drag is linear or quadratic");
    expect(material.solid_density > material.fluid_density, "solids settle");
}

TwoPhaseDrag::Settling TwoPhaseDrag::settling(double d) const {
    const double speed = terminal_velocity(material_, d);
    const double reynolds = material_.fluid_density * d * speed / material_.viscosity;
    return {speed, reynolds, richardson_zaki(reynolds)};
}

double TwoPhaseDrag::over(double weight, double speed) const {
    return weight / (material_.power == 2 ? speed * speed : speed);
}

double TwoPhaseDrag::grain_speed(const Mixture& x, double flux) const {
    const double free = x.free(), grains = x.grains(), ratio = free / grains;
    const double solid_like =
        material_.fluid_density / material_.solid_density / 180.0 * ratio * ratio * ratio * grain_.reynolds;
    const double fluid_like = std::pow(free, grain_.exponent - 1.0);
    const double p = std::pow(grains / (grains + free), material_.weighting);
    return grain_.speed * (p * solid_like + (1.0 - p) * fluid_like) + (p / x.bound() + (1.0 - p) / free) * flux;
}

double TwoPhaseDrag::block_speed(const Mixture& x, double flux) const {
    return block_.speed * std::pow(x.free(), block_.exponent - 1.0) + flux / x.free();
}

double TwoPhaseDrag::unsplit(double solids, double flux) const {
    const Mixture all_free{solids};
    const double weight =
        solids * (1.0 - solids) * (material_.solid_density - material_.fluid_density) * material_.gravity;
    return over(weight, grain_speed(all_free, flux));
}

double TwoPhaseDrag::coefficient(const Mixture& x, double flux) const {
    const TwoPhaseMaterial& m = material_;
    if (!m.split) return unsplit(x.solids, flux);
    const double both = x.bound() * x.free() * m.gravity;
    double sum = 0.0;
    if (x.structured > 0.0)
        sum += over(x.structured * both * (bound_density(m, x) - m.fluid_density), block_speed(x, flux));
    if (x.structured < 1.0)  // F grows without bound as grains vanish: their drag does
        sum += over((1.0 - x.structured) * both * (m.solid_density - m.fluid_density), grain_speed(x, flux));
    return sum;
}

double virtual_mass_number(VirtualMass law, const TwoPhaseMaterial& material, const Mixture& x) {
    if (law == VirtualMass::none) return 0.0;
    if (law == VirtualMass::unbounded) return 0.5 * (1.0 + 2.0 * x.bound()) / x.free();
    constexpr double kN = 10.0, kL = 0.12;
    const double gamma = material.fluid_density / bound_density(material, x);
    return (kN * (kL + x.bound()) - 1.0) / (x.bound() / x.free() + gamma);
}

double virtual_mass(VirtualMass law, const TwoPhaseMaterial& material, const Mixture& mixture, double depth) {
    return mixture.bound() * material.fluid_density * virtual_mass_number(law, material, mixture) * depth;
}

Vec2 buoyancy(double fluid_density, double normal_gravity, double bound_depth, const Vec2& surface_slope) {
    return -fluid_density * normal_gravity * bound_depth * surface_slope;
}

double basal_stress(const TwoPhaseMaterial& m, const Mixture& x, double normal_gravity, double depth, double support) {
    const double grains = x.solids * (m.solid_density - m.fluid_density),
                 blocks = x.bound() * (bound_density(m, x) - support * m.fluid_density);
    return normal_gravity * depth * ((1.0 - x.structured) * grains + x.structured * blocks);
}

double mud_viscosity(double eta_0, double beta, double concentration, double clear) {
    return std::max(clear, eta_0 * std::exp(beta * concentration));
}

namespace {

/// Slip after a step: inertia dD/dt = drive - drag |D|^(j - 1) D.
Vec2 slip_after(const Vec2& slip, const Vec2& drive, double inertia, const Exchange& by, double dt) {
    const double rate = by.drag / inertia;  // [1/s], or [1/m] for j = 2
    const Vec2 gain = dt / inertia * drive;
    if (by.power == 1) {
        const double x = rate * dt;
        return std::exp(-x) * slip + (x > 0.0 ? -std::expm1(-x) / x : 1.0) * gain;
    }
    const Vec2 driven = slip + gain;
    const double speed = driven.norm();
    if (speed == 0.0) return Vec2::Zero();
    const Vec2 direction = driven / speed;
    return riccati_speed(std::max(0.0, slip.dot(direction)), speed, 0.0, rate, dt) * direction;
}

}  // namespace

void exchange(const Exchange& by, double dt, Phase& c, Phase& u) {
    const double mass = c.mass + u.mass;
    if (mass <= 0.0) return;
    const Vec2 together = (c.mass * c.velocity + u.mass * u.velocity + dt * (c.force + u.force)) / mass;
    if (c.mass <= 0.0 || u.mass <= 0.0) {
        c.velocity = u.velocity = together;
        return;
    }
    const double reduced = c.mass * u.mass / mass;
    const Vec2 drive = reduced * (c.force / c.mass - u.force / u.mass);
    const Vec2 slip = slip_after(c.velocity - u.velocity, drive, reduced + by.virtual_mass, by, dt);
    c.velocity = together + u.mass / mass * slip;
    u.velocity = together - c.mass / mass * slip;
}

}  // namespace frana
