// 3D fluid: a tank at rest, a dam that breaks.
#include <algorithm>
#include <cmath>

#include "checks/verify/body.h"
#include "checks/verify/library.h"

namespace frana::verify {
namespace {

constexpr double kTankGravity = 10.0, kTankDensity = 1000.0;  // [m/s^2], [kg/m^3]
// Of a slice. It is so wide that mirror particles in both of its sides do not meet where material is.
constexpr double kTankWidthCells = 3.0;

/// A box of water in its own axes, at rest, with hydrostatic pressure. Sound is ten times as fast as a wave on it.
struct Water {
    Frame3 frame;
    double cell;
    Vec3 box, room;  ///< of the water; of the tank [m]
    int per_side = 2;
    double bulk = kTankDensity * 100.0 * kTankGravity * box.z();

    SolidScene scene() const {
        SolidScene s;
        s.gravity = frame.at({0, 0, -kTankGravity});
        s.density = kTankDensity;
        s.law = solid::Fluid{bulk, 0.0};
        s.grid = grid_around(frame, {0, 0, 0}, room, cell);
        s.surfaces = {Surface::plane(frame.at({0, 0, 0}), frame.at({0, 0, 1})),
                      Surface::plane(frame.at({0, 0, 0}), frame.at({1, 0, 0})),
                      Surface::plane(frame.at({room.x(), 0, 0}), frame.at({-1, 0, 0}))};
        add_slice(s, box.y());
        for_each_part({0, 0, 0}, box, cell, per_side, [&](const Vec3& x, double volume) {
            const double p = kTankDensity * kTankGravity * (box.z() - x.z());
            s.points.add(frame.at(x), Vec3::Zero(), kTankDensity * volume / (1.0 - p / bulk), p);
        });
        return s;
    }
};

/// Straight line through the points' pressures against their height, and how far they lie off it.
struct PressureFit {
    double at_bed, noise;
};
PressureFit fit_pressure(const Mpm3d& flow, const Frame3& frame) {
    double n = 0.0, z = 0.0, p = 0.0, zz = 0.0, zp = 0.0, pp = 0.0;
    for (Index k = 0; k < flow.body().points.count(); ++k) {
        const double height = (frame.turn.transpose() * flow.position(k)).z(), pressure = -flow.stress(k).trace() / 3.0;
        n += 1.0, z += height, p += pressure;
        zz += height * height, zp += height * pressure, pp += pressure * pressure;
    }
    const double slope = (n * zp - z * p) / (n * zz - z * z), at_bed = (p - slope * z) / n;
    const double off =
        pp - 2.0 * (at_bed * p + slope * zp) + n * at_bed * at_bed + 2.0 * at_bed * slope * z + slope * slope * zz;
    return {at_bed, std::sqrt(std::max(0.0, off) / n)};
}

/// Water 1 m deep in a tank 1 m long, along the grid and turned by 20 degrees. The worse of both, after one second.
Measurement run_tank(const Setup& setup) {
    constexpr double kEnd = 1.0;
    const double cell = 1.0 / static_cast<double>(setup.cells), width = kTankWidthCells * cell;
    double bed_pressure = 0.0, noise = 0.0, bed_force = 0.0, wall_force = 0.0, speed = 0.0, centre = 0.0;
    Measurement m;
    for (const double turn : {0.0, 20.0}) {
        const Water water{turned_about_y(turn), cell, {1.0, width, 1.0}, {1.0, width, 1.3}, setup.per_side};
        Mpm3d flow(water.scene());
        std::vector<Vec3> half;
        double since = 0.0;
        const Vec3 start = flow.status().centre;
        const double mass = flow.status().mass;
        const Measurement run = run_body(flow, kEnd, [&](const Mpm3d& now) {
            if (half.empty() && now.status().time >= 0.5 * kEnd) half = now.body().impulse, since = now.status().time;
        });
        m = joined(m, run);
        const auto force = [&](std::size_t s) {
            return (flow.body().impulse[s] - half[s]).norm() / (kEnd - since) / width;
        };
        const double weight = mass * kTankGravity / width,
                     pressure_force = 0.5 * weight;  // a square of water: half its weight
        const PressureFit fit = fit_pressure(flow, water.frame);
        bed_pressure = std::max(bed_pressure, std::abs(fit.at_bed / weight - 1.0));
        noise = std::max(noise, fit.noise / weight);
        bed_force = std::max(bed_force, std::abs(force(0) / weight - 1.0));
        for (const std::size_t wall : {1u, 2u})
            wall_force = std::max(wall_force, std::abs(force(wall) / pressure_force - 1.0));
        speed = std::max(speed, flow.status().max_speed);
        centre = std::max(centre, (flow.status().centre - start).norm());
    }
    m.add("bed_pressure_error", bed_pressure);
    m.add("pressure_noise", noise);
    m.add("bed_force_error", bed_force);
    m.add("wall_force_error", wall_force);
    m.add("max_speed", speed, "m/s");
    m.add("centre_drift", centre, "m");
    return m;
}

/// Where 99 % of the points lie short of: single ones run ahead [m].
double front_of(const Mpm3d& flow) {
    std::vector<double> x;
    for (Index p = 0; p < flow.body().points.count(); ++p) x.push_back(flow.position(p).x());
    const auto at = x.begin() + static_cast<std::ptrdiff_t>(x.size() * 99 / 100);
    std::nth_element(x.begin(), at, x.end());
    return *at;
}

/// Front of a column 1 m wide and 2 m high on a smooth floor, at times T = t sqrt(2 g / a). It slumps. It is
/// compared with those of Martin and Moyce (1952, Phil. Trans. R. Soc. A 244, 312), Fig. 3, n^2 = 2, a = 1.125 inch, as
/// read from it for the solver PySPH.
Measurement run_dam_front(const Setup& setup) {
    constexpr double kMeasured[][2] = {{0.849, 1.245}, {1.212, 1.443}, {1.602, 1.884}, {2.283, 2.689}, {2.950, 3.728}};
    const double cell = 1.0 / static_cast<double>(setup.cells), width = kTankWidthCells * cell;
    const Water water{{}, cell, {1.0, width, 2.0}, {4.5, width, 2.6}, setup.per_side};
    Mpm3d flow(water.scene());
    const double scale = std::sqrt(2.0 * kTankGravity);
    constexpr double kWeighed = 2.65;  // T at which its energies are recorded, all but the last
    Measurement m;
    SolidStatus now;
    double lead = 0.0, ahead = 0.0;
    for (const auto& [time, place] : kMeasured) {
        if (time > kWeighed) m = joined(m, run_body(flow, kWeighed / scale)), now = flow.status();
        m = joined(m, run_body(flow, time / scale));
        ahead = front_of(flow) - place, lead = std::max(lead, std::abs(ahead) / place);
    }
    m.steps = flow.status().step;
    m.front_error = ahead;
    m.add("lead", lead);
    const double fallen = now.mass * kTankGravity * (1.0 - now.centre.z());
    m.add("energy_lost", 1.0 - now.kinetic / fallen);
    m.add("numerical_loss", now.numerical() / fallen);
    m.add("material_loss", now.material / fallen);
    m.add("wall_loss", -now.contact_work / fallen);
    m.add("stored_share", now.stored / fallen);
    return m;
}

/// A reservoir 10 m long and 1 m high that breaks. Far from the gate and long after, waves are long and the depth is
/// Ritter's (1892), (2 c - x / t)^2 / (9 g), c = sqrt(g). Depths are of slabs half a metre wide; errors over c t, the
/// water that moves.
Measurement run_dam_far(const Setup& setup) {
    constexpr double kReservoir = 10.0, kSlab = 0.5;
    const double cell = 1.0 / static_cast<double>(setup.cells), width = kTankWidthCells * cell,
                 c = std::sqrt(kTankGravity);
    const Water water{{}, cell, {kReservoir, width, 1.0}, {kReservoir + 22.0, width, 1.5}, setup.per_side};
    Mpm3d flow(water.scene());
    Measurement m;
    std::vector<std::pair<std::string, double>> found;
    for (const double t : {1.0, 2.0, 3.0}) {
        m = joined(m, run_body(flow, t));
        std::vector<double> volume(static_cast<std::size_t>((kReservoir + 22.0) / kSlab), 0.0);
        for (Index p = 0; p < flow.body().points.count(); ++p)
            volume.at(static_cast<std::size_t>(flow.position(p).x() / kSlab)) += flow.body().points.rest_volume[p];
        double wrong = 0.0;
        for (std::size_t n = 0; n < volume.size(); ++n) {
            const double x = (static_cast<double>(n) + 0.5) * kSlab - kReservoir;
            const double exact = x < -c * t        ? 1.0
                                 : x > 2.0 * c * t ? 0.0
                                                   : std::pow(2.0 * c - x / t, 2) / (9.0 * kTankGravity);
            wrong += std::abs(volume[n] / (kSlab * width) - exact) * kSlab;
        }
        found.emplace_back("depth_error_" + std::to_string(static_cast<int>(t)), wrong / (c * t));
    }
    for (const auto& [name, value] : found) m.add(name, value);
    m.steps = flow.status().step;
    return m;
}

std::vector<Residual> tank_residuals() {
    // Half the weight of a square of water is its sideways force: the integral of rho g (H - z) over H.
    double pressure_force = 0.0;
    for (int k = 0; k < 1000; ++k) pressure_force += kTankDensity * kTankGravity * (1.0 - (k + 0.5) / 1000.0) / 1000.0;
    return {{"side force of a square of water over half its weight - 1",
             pressure_force / (0.5 * kTankDensity * kTankGravity) - 1.0, 1e-12}};
}

}  // namespace

std::vector<Problem> tank_problems() {
    Problem tank{"tank",
                 "water at rest in a tank along the grid and turned by 20 degrees: pressure, forces, no motion",
                 {8, 16},
                 tank_residuals,
                 run_tank};
    tank.order_of = "wall_force_error";
    const std::string slice = "a slice of the same scheme was within it";
    tank.gates = {{16, "bed_pressure_error", 0.01, slice},        {16, "bed_force_error", 0.005, slice},
                  {16, "wall_force_error", 0.005, slice},         {16, "pressure_noise", 0.02, slice},
                  {16, "max_speed", 0.008, "that slice, turned"}, {0, "momentum_residual", 1e-12, "round-off"}};
    Problem dam{"dam_front",
                "a column of water 1 m by 2 m slumps: its front at five times (Martin and Moyce 1952)",
                {8, 16},
                {},
                run_dam_front};
    dam.order_of = "front_error";
    dam.gates = {{0, "lead", 0.16, "by which slices of the same scheme, as codes without friction do, led at the most"},
                 {16, "energy_lost", 0.01, "a slice of the same scheme kept 99 %"},
                 {16, "numerical_loss", 0.015, "that, and what stays stored and the walls take"},
                 {0, "momentum_residual", 1e-12, "round-off"}};
    Problem far{"dam_far",
                "a long reservoir breaks: depths far from the gate are those of shallow water (Ritter 1892)",
                {8},
                {},
                run_dam_far};
    far.finest_is_long = true;
    far.gates = {
        {0, "depth_error_3", 0.05, "the start is still felt: the front of a slice of the same scheme was 5 % short"},
        {0, "momentum_residual", 1e-12, "round-off"}};
    for (Problem* problem : {&tank, &dam, &far}) problem->in_3d = true;
    return {tank, dam, far};
}

}  // namespace frana::verify
