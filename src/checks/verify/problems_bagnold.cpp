// A 3D sheet of grains that flows down an incline which holds it.
#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "checks/verify/body.h"
#include "checks/verify/library.h"

namespace frana::verify {
namespace {

using constants::kGravity;
constexpr double kMiddle = 1.0;  ///< half of what is measured [m]

/// A sheet under mu(I) on a rough incline, the tangent of whose angle is between mu_s and mu_2. Where the flow is steady,
/// friction is the incline's everywhere, so I is the same at each height. With z from the bed,
///   du/dz = I sqrt(phi g cos (H - z)) / d,   u = 2/3 I sqrt(phi g cos) / d (H^(3/2) - (H - z)^(3/2))
/// (Bagnold's profile: GDR MiDi 2004, Eur. Phys. J. E 14, 341; Jop, Forterre and Pouliquen 2006, Nature 441, 727).
struct Grains {
    static constexpr double kThickness = 1.0, kDensity = 1600.0, kSlope = 0.5, kSoundSpeed = 10.0;  ///< over sqrt(g H)
    solid::MuI law = of_stiffness();

    static solid::MuI of_stiffness() {
        constexpr double kPoisson = 0.3, modulus = kDensity * kSoundSpeed * kSoundSpeed * kGravity * kThickness;
        solid::MuI law{solid::Elastic::of_sound(modulus, kPoisson)};
        law.mu_s = 0.38, law.mu_2 = 0.65, law.i0 = 0.3, law.grain_diameter = 0.3, law.solid_fraction = 0.6;
        law.density = kDensity;
        return law;
    }
    static double cosine() { return 1.0 / std::hypot(1.0, kSlope); }
    double inertial_number() const { return law.i0 * (kSlope - law.mu_s) / (law.mu_2 - kSlope); }
    /// I sqrt(phi g cos) / d [1 / (s sqrt(m))]
    double brisk() const {
        return inertial_number() * std::sqrt(law.solid_fraction * kGravity * cosine()) / law.grain_diameter;
    }
    double rate(double z) const { return brisk() * std::sqrt(std::max(0.0, kThickness - z)); }
    double speed(double z) const {
        return 2.0 / 3.0 * brisk() * (std::pow(kThickness, 1.5) - std::pow(std::max(0.0, kThickness - z), 1.5));
    }
    /// d tau / d rate at the bed over the density: how fast shear spreads [m^2/s].
    double diffusivity() const {
        const double i = inertial_number(), slope = (law.mu_2 - law.mu_s) * law.i0 / ((law.i0 + i) * (law.i0 + i));
        return slope * law.grain_diameter * std::sqrt(kGravity * cosine() * kThickness / law.solid_fraction);
    }
};

SolidScene sheet(const Grains& grains, double length, double cell, int per_side) {
    constexpr double kWidthCells = 3.0;
    const double width = kWidthCells * cell, down = kGravity * Grains::cosine();
    SolidScene s;
    s.gravity = {down * Grains::kSlope, 0.0, -down};
    s.density = Grains::kDensity;
    s.law = grains.law;
    s.flip = true;
    s.blending = std::sqrt(cell / kGravity);  // as stages have it (scene/scene_stages.cpp)
    s.grid = grid_around({}, {-1.0, 0, 0}, {length + 12.0, width, 2.0}, cell);
    s.surfaces = {Surface::plane({0, 0, 0}, {0, 0, 1}, Hold::stuck)};
    add_slice(s, width);
    for_each_part({0, 0, 0}, {length, width, Grains::kThickness}, cell, per_side, [&](const Vec3& x, double volume) {
        const double p = Grains::kDensity * down * (Grains::kThickness - x.z());
        s.points.add(x, Vec3(grains.speed(x.z()), 0, 0), Grains::kDensity * volume, p);
    });
    return s;
}

/// It starts with the profile and should keep it. Three of the times in which shear crosses the sheet leave 5 % of what is
/// not the scheme's own. Waves from the ends come 12 m far by then, and the middle is 20 m away.
Measurement run_bagnold_sheet(const Setup& setup) {
    const Grains grains;
    constexpr double kLength = 40.0;
    const double cell = Grains::kThickness / static_cast<double>(setup.cells);
    Mpm3d flow(sheet(grains, kLength, cell, setup.per_side));
    const double crossing =
        4.0 * Grains::kThickness * Grains::kThickness / (constants::kPi * constants::kPi * grains.diffusivity());
    Measurement m = run_body(flow, 3.0 * crossing);
    // The mean speed of Bagnold's profile is three fifths of the surface's.
    const double middle = 0.5 * kLength + 0.6 * grains.speed(Grains::kThickness) * flow.status().time;
    double off = 0.0, all = 0.0, sum = 0.0, highest = 0.0;
    for (Index p = 0; p < flow.body().points.count(); ++p) {
        const Vec3 x = flow.position(p);
        if (std::abs(x.x() - middle) > kMiddle) continue;
        const double found = flow.velocity(p).x(), exact = grains.speed(x.z());
        off += std::abs(found - exact), all += exact, sum += found;
        highest = std::max(highest, x.z());
    }
    m.add("profile_error", off / all);
    m.add("mean_error", sum / all - 1.0);
    m.add("thickness", highest + 0.5 * cell / setup.per_side, "m");
    return m;
}

std::vector<Residual> bagnold_residuals() {
    const Grains grains;
    double worst = 0.0, law = 0.0;
    for (int k = 1; k < 60; ++k) {
        const double z = 0.01 * k, d = 1e-5, slope = (grains.speed(z + d) - grains.speed(z - d)) / (2.0 * d);
        worst = std::max(worst, std::abs(slope - grains.rate(z)));
        const double p = Grains::kDensity * kGravity * Grains::cosine() * (Grains::kThickness - z);
        const double i =
            slope * grains.law.grain_diameter * std::sqrt(Grains::kDensity / grains.law.solid_fraction / p);
        const double mu = grains.law.mu_s + (grains.law.mu_2 - grains.law.mu_s) / (1.0 + grains.law.i0 / i);
        law = std::max(law, std::abs(mu - Grains::kSlope));
    }
    return {{"du/dz less the rate of the law", worst / grains.rate(0.0), 1e-8},
            {"mu(I) of the profile less the slope", law, 1e-8}};
}

}  // namespace

std::vector<Problem> bagnold_problems() {
    Problem sheet{"bagnold_sheet",
                  "a sheet of grains under mu(I) flows down an incline that holds it: Bagnold's profile",
                  {4, 8},
                  bagnold_residuals,
                  run_bagnold_sheet};
    sheet.finest_is_long = true;
    sheet.order_of = "profile_error";
    const std::string own = "a fifth above its own figure; 0.05 is the aim";
    sheet.gates = {{4, "profile_error", 0.125, own},
                   {8, "profile_error", 0.025, own},
                   {0, "momentum_residual", 1e-12, "round-off"}};
    sheet.in_3d = true;
    return {sheet};
}

}  // namespace frana::verify
