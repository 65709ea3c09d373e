// 3D sheets that flow down an incline which holds them: viscous fluid, Herschel and Bulkley's mud.
#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "checks/verify/body.h"
#include "checks/verify/library.h"

namespace frana::verify {
namespace {

constexpr double kMudMiddle = 1.0;  ///< half of what is measured [m]

/// A sheet 1 m thick of water's density on a floor that holds it, 45 degrees steep, from rest.
struct Sheet {
    static constexpr double kGravity = 9.81, kDensity = 1000.0, kWidthCells = 3.0;
    double length = 12.0;
    double sound_speed = 10.0;  ///< over sqrt(g), of 1 m
    double floor = 0.0;         ///< how far above nodes [cells]
    SolidLaw law = solid::Fluid{};

    double bulk() const { return kDensity * sound_speed * sound_speed * kGravity; }
    SolidScene scene(double cell, int per_side) const {
        const double width = kWidthCells * cell, low = floor * cell, along = kGravity * std::sqrt(0.5);
        SolidScene s;
        s.gravity = {along, 0.0, -along};
        s.density = kDensity;
        s.law = law;
        s.grid = grid_around({}, {-1.0, 0, 0}, {length + 3.0, width, 2.0}, cell);
        s.surfaces = {Surface::plane({0, 0, low}, {0, 0, 1}, Hold::stuck)};
        add_slice(s, width);
        for_each_part({0, 0, 0}, {length, width, 1.0}, cell, per_side, [&](const Vec3& x, double volume) {
            const double p = kDensity * along * (1.0 - x.z());
            s.points.add(x + Vec3(0, 0, low), Vec3::Zero(), kDensity * volume / (1.0 - p / bulk()), p);
        });
        return s;
    }
};

/// A viscous sheet: u = rho g sin / mu (z - z^2 / 2).
constexpr double kViscosity = 5000.0;
double viscous_speed(double z) {
    return Sheet::kDensity * Sheet::kGravity * std::sqrt(0.5) / kViscosity * (z - 0.5 * z * z);
}

/// How far points' speeds in the middle of the sheet are off, over the speed. It is after eight of the times in which
/// shear crosses it.
double viscous_error(const Setup& setup, double floor, Measurement& m) {
    Sheet sheet;
    sheet.sound_speed = 20.0, sheet.floor = floor;
    sheet.law = solid::Fluid{sheet.bulk(), kViscosity};
    const double cell = 1.0 / static_cast<double>(setup.cells);
    Mpm3d flow(sheet.scene(cell, setup.per_side));
    m = joined(m, run_body(flow, 8.0 * 4.0 * Sheet::kDensity / (constants::kPi * constants::kPi * kViscosity)));
    double off = 0.0, all = 0.0;
    for (Index p = 0; p < flow.body().points.count(); ++p) {
        const Vec3 x = flow.position(p);
        if (std::abs(x.x() - 0.5 * sheet.length) > kMudMiddle) continue;
        const double exact = viscous_speed(x.z() - floor * cell);
        off += std::abs(flow.velocity(p).x() - exact), all += exact;
    }
    return off / all;
}

/// Its floor through nodes, and half a cell above them.
Measurement run_viscous_sheet(const Setup& setup) {
    Measurement m;
    const double on = viscous_error(setup, 0.0, m), between = viscous_error(setup, 0.5, m);
    m.add("profile_error", on);
    m.add("error_between", between);
    return m;
}

/// A sheet of mud. Depth below the surface gives the shear stress, rho g sin (H - z). Where that is above the yield
/// stress, below z_y, the sheet shears. Above it moves as a plug. In its middle, until the ends are felt, the speed
/// goes to (Huang and Garcia 1998, J. Fluid Mech. 374, 305, without inertia)
///   u = n / (n + 1) (rho g sin / K)^(1/n) (z_y^(1 + 1/n) - (z_y - z)+^(1 + 1/n)).
struct Mud {
    double thickness = 1.0, density = Sheet::kDensity;
    double yield_share = 0.4;  ///< of the stress at the bed
    double consistency = 5250.0, exponent = 0.5;

    double drive() const { return density * Sheet::kGravity * std::sqrt(0.5); }  ///< [Pa/m]
    double yield_stress() const { return yield_share * drive() * thickness; }
    double sheared() const { return (1.0 - yield_share) * thickness; }  ///< z_y [m]
    double speed(double z) const {
        const double power = 1.0 + 1.0 / exponent;
        return std::pow(drive() / consistency, 1.0 / exponent) / power *
               (std::pow(sheared(), power) - std::pow(std::max(0.0, sheared() - z), power));
    }
    /// Shear rate at a height, from the law: K rate^n = tau - tau_Y [1/s].
    double rate(double z) const {
        return std::pow(std::max(0.0, drive() * (thickness - z) - yield_stress()) / consistency, 1.0 / exponent);
    }
    /// d tau / d rate at the bed over the density: how fast shear spreads [m^2/s].
    double diffusivity() const { return exponent * consistency * std::pow(rate(0.0), exponent - 1.0) / density; }
};

/// From rest, for eight of the times in which shear crosses the sheet. What the ends do comes along the plug, as the
/// plug is stiff. In the middle of a sheet half as long, they add 4 % of its weight. Its plug is 4 % faster.
Measurement run_mud_sheet(const Setup& setup) {
    const Mud mud;
    const double cell = mud.thickness / static_cast<double>(setup.cells);
    Sheet sheet;
    sheet.length = 48.0;
    sheet.law = solid::HerschelBulkley{sheet.bulk(), 100.0 * mud.yield_stress(), mud.consistency, mud.exponent,
                                       mud.yield_stress()};
    Mpm3d flow(sheet.scene(cell, setup.per_side));
    const double crossing = 4.0 * mud.thickness * mud.thickness / (constants::kPi * constants::kPi * mud.diffusivity());
    Measurement m = run_body(flow, 8.0 * crossing);
    // The middle has moved; its depth and the ends have hardly changed it.
    const double middle = 0.5 * sheet.length + 0.5 * mud.speed(mud.thickness) * flow.status().time;
    double off = 0.0, all = 0.0, plug = 0.0, highest = 0.0;
    Index in_plug = 0;
    for (Index p = 0; p < flow.body().points.count(); ++p) {
        const Vec3 x = flow.position(p);
        if (std::abs(x.x() - middle) > kMudMiddle) continue;
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
    mud.finest_is_long = true;
    mud.order_of = "profile_error";
    // Two errors of opposite signs. Points are pressed by up to 0.7 %, which raises the stress as much. The law takes
    // it to the power of two. And each step takes a little from what shears.
    const std::string own = "a fifth above its own figure; 0.05 is the aim";
    mud.gates = {{4, "profile_error", 0.039, own},
                 {8, "profile_error", 0.023, own},
                 {8, "plug_error", 0.026, own},
                 {0, "momentum_residual", 1e-12, "round-off"}};
    mud.in_3d = true;
    Problem viscous{"viscous_sheet",
                    "a sheet of viscous fluid flows down an incline that holds it: its profile",
                    {4, 8},
                    {},
                    run_viscous_sheet};
    viscous.finest_is_long = true;
    viscous.order_of = "profile_error";
    viscous.gates = {{4, "profile_error", 0.018, own},
                     {4, "error_between", 0.033, own},
                     {8, "profile_error", 0.0068, own},
                     {8, "error_between", 0.011, own},
                     {0, "momentum_residual", 1e-12, "round-off"}};
    viscous.in_3d = true;
    return {mud, viscous};
}

}  // namespace frana::verify
