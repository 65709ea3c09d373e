// Mud in space: a sheet of Herschel and Bulkley's fluid that flows down an incline.
#include <algorithm>
#include <cmath>

#include "verify/body.h"
#include "verify/library.h"

namespace frana::verify {
namespace {

/// A sheet 1 m thick on a plane that holds it. Depth below the surface gives the shear stress, rho g sin (H - z): where
/// that is above the yield stress, below z_y, the sheet shears; above it moves as a plug. In its middle, until the
/// ends are felt, the speed goes to (Huang and Garcia 1998, J. Fluid Mech. 374, 305, without inertia)
///   u = n / (n + 1) (rho g sin / K)^(1/n) (z_y^(1 + 1/n) - (z_y - z)+^(1 + 1/n)).
struct Mud {
    double thickness = 1.0, slope = 45.0 * M_PI / 180.0, gravity = 9.81, density = 1000.0;
    double yield_share = 0.4;  ///< of the stress at the bed
    double consistency = 5250.0, exponent = 0.5;

    double pull() const { return density * gravity * std::sin(slope); }  ///< [Pa/m]
    double yield_stress() const { return yield_share * pull() * thickness; }
    double sheared() const { return (1.0 - yield_share) * thickness; }  ///< z_y [m]
    double speed(double z) const {
        const double power = 1.0 + 1.0 / exponent;
        return std::pow(pull() / consistency, 1.0 / exponent) / power *
               (std::pow(sheared(), power) - std::pow(std::max(0.0, sheared() - z), power));
    }
    /// Shear rate at a height, from the law: K rate^n = tau - tau_Y [1/s].
    double rate(double z) const {
        return std::pow(std::max(0.0, pull() * (thickness - z) - yield_stress()) / consistency, 1.0 / exponent);
    }
    /// d tau / d rate at the bed over the density: how fast shear spreads [m^2/s].
    double diffusivity() const { return exponent * consistency * std::pow(rate(0.0), exponent - 1.0) / density; }
};

constexpr double kLength = 24.0, kMiddle = 1.0;  ///< of the sheet; half of what is looked at [m]
constexpr double kWidthCells = 3.0;

SolidScene sheet(const Mud& mud, double cell, int per_side) {
    const double width = kWidthCells * cell, sound = 10.0 * std::sqrt(mud.gravity * mud.thickness);
    SolidScene s;
    s.gravity = mud.gravity * Vec3(std::sin(mud.slope), 0.0, -std::cos(mud.slope));
    s.density = mud.density;
    s.law = solid::HerschelBulkley{mud.density * sound * sound, 100.0 * mud.yield_stress(), mud.consistency,
                                   mud.exponent, mud.yield_stress()};
    s.grid = grid_around({}, {-1.0, 0, 0}, {kLength + 3.0, width, 2.0 * mud.thickness}, cell);
    s.surfaces = {Surface::plane({0, 0, 0}, {0, 0, 1}, Hold::stuck)};
    add_slice(s, width);
    for_each_part({0, 0, 0}, {kLength, width, mud.thickness}, cell, per_side, [&](const Vec3& x, double volume) {
        const double p = mud.density * mud.gravity * std::cos(mud.slope) * (mud.thickness - x.z());
        s.points.add(x, Vec3::Zero(), mud.density * volume, p);
    });
    return s;
}

/// From rest, for eight of the times in which shear crosses the sheet. What the ends do comes along the plug: on 20
/// degrees a sheet half as long thins by 2 % in its middle in that time, and this one by 0.1 %.
Measurement run_mud_sheet(const Setup& setup) {
    const Mud mud;
    const double cell = mud.thickness / static_cast<double>(setup.cells);
    SolidFlow flow(sheet(mud, cell, setup.per_side));
    const double crossing = 4.0 * mud.thickness * mud.thickness / (M_PI * M_PI * mud.diffusivity());
    Measurement m = run_body(flow, 8.0 * crossing);
    // The middle has moved; its depth and the ends have hardly changed it.
    const double middle = 0.5 * kLength + 0.5 * mud.speed(mud.thickness) * flow.status().time;
    double off = 0.0, all = 0.0, plug = 0.0, highest = 0.0;
    Index in_plug = 0;
    for (Index p = 0; p < flow.body().points.count(); ++p) {
        const Vec3 x = flow.position(p);
        if (std::abs(x.x() - middle) > kMiddle) continue;
        const double found = flow.velocity(p).x(), exact = mud.speed(x.z());
        off += std::abs(found - exact), all += exact;
        highest = std::max(highest, x.z());
        if (x.z() > mud.sheared() + cell) plug += found, ++in_plug;
    }
    m.add("profile_error", off / all);
    m.add("plug_error", plug / static_cast<double>(in_plug) / mud.speed(mud.thickness) - 1.0);
    m.add("thickness", highest + 0.5 * cell / setup.per_side, "m");
    return m;
}

std::vector<Residual> mud_residuals() {
    const Mud mud;
    double worst = 0.0;
    for (int k = 1; k < 60; ++k) {
        const double z = 0.01 * k, d = 1e-5;
        worst = std::max(worst, std::abs((mud.speed(z + d) - mud.speed(z - d)) / (2.0 * d) - mud.rate(z)));
    }
    return {{"du/dz less the rate of the law", worst / mud.rate(0.0), 1e-8}};
}

}  // namespace

std::vector<Problem> mud_problems() {
    Problem mud{"mud_sheet",
                "a sheet of Herschel and Bulkley's fluid, n = 0.5, flows down an incline: its profile",
                {4, 8},
                mud_residuals,
                run_mud_sheet};
    mud.order_of = "profile_error";
    // Not of the grid: at 8 cells the speed still grows as layers of points pass each other (plug 3 % too fast after three
    // crossings, 8 % after eight), supposedly since the rate takes the square of a noisy stress.
    mud.gates = {{0, "profile_error", 0.05, "an aim, missed on both grids"},
                 {0, "plug_error", 0.05, "the same, missed on the finer"},
                 {0, "momentum_residual", 1e-12, "round-off"}};
    mud.in_space = true;
    return {mud};
}

}  // namespace frana::verify
