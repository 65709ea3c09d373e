// Particles at rest that become 3D points and stay at rest.
#include <algorithm>
#include <chrono>
#include <cmath>

#include "base/constants.h"
#include "checks/verify/body.h"
#include "checks/verify/library.h"
#include "checks/verify/trial.h"
#include "coupling/staged_run.h"

namespace frana::verify {
namespace {

constexpr double kRestGravity = 10.0, kRestDensity = 1000.0, kDeepest = 1.0;  // [m/s^2], [kg/m^3], [m]
constexpr double kRestSlope = 20.0 * constants::kPi / 180.0;

/// A wedge of water against a wall at x = 0, level at z = kDeepest over a bed of 20 degrees. It is of particles one
/// cell wide. A 3D stage from the start makes points of them, half of that apart.
Scene wedge(const SolidLaw& law, double bed_friction, const Setup& setup) {
    constexpr Index kAcross = 4, kRoom = 4;  // nodes of the terrain
    const double cell = kDeepest / static_cast<double>(setup.cells);
    const double length = kDeepest / std::tan(kRestSlope);
    const Index along = static_cast<Index>(std::ceil(length / cell)) + kRoom;
    Scene scene = scene_on(along, kAcross, cell, [](double x, double) { return x * std::tan(kRestSlope); });
    scene.gravity = kRestGravity;
    scene.density = kRestDensity;
    fill(scene, [&](double x, double) { return kDeepest - x * std::tan(kRestSlope); }, {1});
    SolidStage stage;
    stage.window = {0, 0, along - 1, kAcross - 1};
    stage.closed = {true, true, false, true};
    stage.cell = cell;
    stage.spacing = cell / setup.per_side;
    stage.law = law;
    stage.bed_friction = bed_friction;
    scene.solid = stage;
    return scene;
}

std::vector<Vec3> places(const Mpm3d& flow) {
    std::vector<Vec3> x(static_cast<std::size_t>(flow.body().points.count()));
    for (Index p = 0; p < flow.body().points.count(); ++p)
        x[static_cast<std::size_t>(flow.body().points.id[p])] = flow.position(p);
    return x;
}

double rms_apart(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    double sum = 0.0;
    for (std::size_t p = 0; p < a.size(); ++p) sum += (a[p] - b[p]).squaredNorm();
    return std::sqrt(sum / static_cast<double>(a.size()));
}

/// Root mean square of the pressure's error, over that on the deepest bed.
double pressure_error(const Mpm3d& flow) {
    double sum = 0.0;
    for (Index p = 0; p < flow.body().points.count(); ++p) {
        const double exact = kRestDensity * kRestGravity * std::max(0.0, kDeepest - flow.position(p).z());
        sum += std::pow(-flow.stress(p).trace() / 3.0 - exact, 2);
    }
    return std::sqrt(sum / static_cast<double>(flow.body().points.count())) / (kRestDensity * kRestGravity * kDeepest);
}

/// What bed and wall carry in some time: the bed the weight, the wall a triangle of pressure.
struct Forces {
    double bed_error, wall_error;
    Forces(const Mpm3d& flow, const std::vector<Vec3>& before, double since) {
        const SolidStatus& now = flow.status();
        const double weight = now.mass * kRestGravity, pressure_force = weight * std::tan(kRestSlope),
                     time = now.time - since;
        bed_error = (flow.body().impulse[0].z() - before[0].z()) / time / weight - 1.0;
        wall_error = (flow.body().impulse[1].x() - before[1].x()) / time / pressure_force - 1.0;
    }
};

struct Rest {
    double creep, later,
        speed;  ///< rms way in the first second and in half of the next [cells]; rms speed then [m/s]
    double pressure, pressure_at_start;
    double force, force_at_start;  ///< errors, of bed and wall the worse: from 0.5 to 1 s, in the first step
    Measurement run;
};

/// One second, and half of another for what `stops`.
Rest rest(const SolidLaw& law, double bed_friction, bool stops, const Setup& setup) {
    const double cell = kDeepest / static_cast<double>(setup.cells);
    const auto began = std::chrono::steady_clock::now();
    StagedRun run(wedge(law, bed_friction, setup));
    const Mpm3d& flow = *run.points();
    const std::vector<Vec3> start = places(flow);
    const auto worse = [](const Forces& f) { return std::max(std::abs(f.bed_error), std::abs(f.wall_error)); };
    Rest r{};
    r.pressure_at_start = pressure_error(flow);
    std::vector<Vec3> half = flow.body().impulse;
    run.advance(1.0);
    r.force_at_start = worse(Forces(flow, half, 0.0));
    double since = 0.0;
    while (flow.status().time < 1.0) {
        run.advance(1.0);
        if (flow.status().time <= 0.5) half = flow.body().impulse, since = flow.status().time;
    }
    r.force = worse(Forces(flow, half, since));
    r.pressure = pressure_error(flow);
    const std::vector<Vec3> then = places(flow);
    r.creep = rms_apart(start, then) / cell;
    while (stops && flow.status().time < 1.5) run.advance(1.5);
    r.later = rms_apart(then, places(flow)) / cell;
    r.speed = std::sqrt(2.0 * flow.status().kinetic / flow.status().mass);
    r.run.particles = flow.status().points;
    r.run.steps = flow.status().step;
    double given = flow.status().weight_impulse.norm();
    for (const Vec3& impulse : flow.body().impulse) given += impulse.norm();
    r.run.add("momentum_residual", flow.momentum_residual().norm() / given);
    r.run.wall_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    return r;
}

/// Water, whose creep nothing ends; water on a rough bed; and mud, which stops.
Measurement run_conversion_at_rest(const Setup& setup) {
    constexpr double kYield = 100.0;  // of the mud [Pa]: a hundredth of the deepest pressure
    const Rest water = rest(solid::Fluid{}, 0.0, false, setup), rough = rest(solid::Fluid{}, 0.3, true, setup),
               mud = rest(solid::Bingham{0.0, 100.0 * kYield, 1.0, kYield}, 0.0, true, setup);
    Measurement m = joined(joined(water.run, rough.run), mud.run);
    m.add("pressure_at_start", water.pressure_at_start);
    m.add("force_at_start", water.force_at_start);
    m.add("pressure_error", water.pressure);
    m.add("force_error", water.force);
    m.add("creep", water.creep, "cells");
    m.add("creep_rough", rough.creep, "cells");
    m.add("later_rough", rough.later, "cells");
    m.add("speed_rough", rough.speed, "m/s");
    m.add("creep_mud", mud.creep, "cells");
    m.add("later_mud", mud.later, "cells");
    m.add("speed_mud", mud.speed, "m/s");
    return m;
}

}  // namespace

std::vector<Problem> rest_problems() {
    Problem rest{"conversion_at_rest",
                 "a wedge of water at rest on 20 degrees becomes 3D points and stays where it is",
                 {8, 16},
                 {},
                 run_conversion_at_rest};
    rest.order_of = "pressure_error";
    rest.finest_is_long = true;
    const std::string slice = "a slice of the same scheme, points exactly hydrostatic, was within it";
    const std::string stops = "a fifteenth of what water creeps in that time";
    rest.gates = {{16, "creep", 0.1, slice},
                  {16, "pressure_error", 0.025, slice},
                  {16, "force_at_start", 0.01, slice},
                  {16, "force_error", 0.01, slice},
                  {0, "later_rough", 5e-3, stops},
                  {0, "later_mud", 5e-3, stops},
                  {0, "momentum_residual", 1e-12, "round-off"}};
    rest.in_3d = true;
    return {rest};
}

}  // namespace frana::verify
