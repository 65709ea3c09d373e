// Slumps of a Bingham material that come to rest where the yield stress holds them. They are on flat ground, round an
// axis and on an incline. Also deposits that start from the exact answer and must stay.
#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "checks/verify/exact_deposit.h"
#include "checks/verify/library.h"
#include "checks/verify/trial.h"

namespace frana::verify {
namespace {

using constants::kDegree;

/// Bed friction and stress inside by the same material.
void set_material(Scene& scene, const YieldMaterial& material, double viscosity) {
    scene.density = material.density;
    scene.bed_law = bed::Bingham{viscosity, material.yield_stress, 0.0};
    scene.rheology = rheology::Bingham{viscosity, material.yield_stress};
    scene.sides = Sides::wall;
}

/// A strip from a wall at x = 0, four cells wide.
Scene strip(double length, double cell, double fall) {
    const Index nx = static_cast<Index>(std::ceil(length / cell)) + 1;
    return scene_on(nx, 5, cell, [&](double x, double) { return -fall * x; });
}

/// How far the contour of `level` stands from its exact place, in cells. Along a line of nodes from node `start` on.
double contour_cells(const Frame& frame, Index start, Index step, double step_cells, double level, double exact) {
    const double* h = frame.node("depth")->data;
    const Index count = frame.grid.size();
    double found = kNone;
    for (Index n = 0, k = start; k + step < count && n + 1 < frame.grid.nx; ++n, k += step)
        if (h[k] >= level && h[k + step] < level)
            found = (static_cast<double>(n) + (h[k] - level) / (h[k] - h[k + step])) * step_cells;
    return found - exact / frame.grid.cell;
}

struct Slump {
    double column_length, column_depth;  ///< released from the wall [m]
    double viscosity, end;               ///< [Pa s], [s]
    double domain, reference;            ///< lengths: of the strip, and of what Setup::cells counts [m]
    double fall;                         ///< tan(slope)
};

/// Depth at the wall, front and profile of a slump in a strip, against a deposit.
template <class Deposit>
Measurement run_slump(const Setup& setup, const Slump& slump, const YieldMaterial& material, const Deposit& deposit) {
    Scene scene = strip(slump.domain, slump.reference / static_cast<double>(setup.cells), slump.fall);
    set_material(scene, material, slump.viscosity);
    fill_cut(scene, [&](double x, double) { return x < slump.column_length ? slump.column_depth : 0.0; },
             {setup.per_side});
    Trial trial(std::move(scene), setup);
    trial.run_to(slump.end);
    Measurement m = trial.measure({[&](double x, double) { return deposit.depth(x); }});
    const Frame frame = trial.simulation().frame();
    const Index row = frame.grid.ny / 2 * frame.grid.nx;
    const double level = 0.02 * slump.column_depth;
    m.add("front_cells", contour_cells(frame, row, 1, 1.0, level, deposit.contour(level)), "cells");
    m.front_error = m.extras.back().value * frame.grid.cell;
    m.add("wall_depth_error", frame.node("depth")->data[row] / deposit.depth(0.0) - 1);
    m.add("max_speed", frame.status.max_speed_on_map, "m/s");
    return m;
}

Measurement run_arrest(const Setup& setup) {
    const YieldMaterial material{1000.0, 50.0};
    return run_slump(setup, {2.0, 0.5, 20.0, 400.0, 7.5, 6.0, 0.0}, material, FlatDeposit{material, 1.0});
}

const InclineDeposit& incline_deposit() {
    static const InclineDeposit deposit({1000.0, 500.0}, 10 * kDegree, 1.0);
    return deposit;
}

Measurement run_incline(const Setup& setup) {
    return run_slump(setup, {1.6, 0.625, 100.0, 200.0, 6.0, 5.0, std::tan(10 * kDegree)}, {1000.0, 500.0},
                     incline_deposit());
}

constexpr double kCylinder = 0.9;  ///< radius of the released cylinder [m]

Measurement run_axial(const Setup& setup) {
    const YieldMaterial material{1000.0, 50.0};
    const RoundDeposit deposit{material, 1.0};
    const double cell = 2.0 / static_cast<double>(setup.cells), column = 1.0 / (constants::kPi * kCylinder * kCylinder);
    const Index n = static_cast<Index>(std::ceil(2.6 / cell)) + 1;
    Scene scene = scene_on(n, n, cell, [](double, double) { return 0.0; });
    set_material(scene, material, 30.0);
    fill_cut(scene, [&](double x, double y) { return std::hypot(x, y) < kCylinder ? column : 0.0; }, {setup.per_side});
    Trial trial(std::move(scene), setup);
    trial.run_to(200.0);
    Measurement m = trial.measure({[&](double x, double y) { return deposit.depth(std::hypot(x, y)); }});
    const Frame frame = trial.simulation().frame();
    const double level = 0.02 * column, exact = deposit.contour(level);
    const double axis = contour_cells(frame, 0, 1, 1.0, level, exact);
    const double diagonal = contour_cells(frame, 0, frame.grid.nx + 1, std::sqrt(2.0), level, exact);
    m.front_error = (std::abs(axis) > std::abs(diagonal) ? axis : diagonal) * cell;
    m.add("front_axis", axis, "cells");
    m.add("front_diagonal", diagonal, "cells");
    m.add("centre_depth_error", frame.node("depth")->data[0] / deposit.depth(0.0) - 1);
    m.add("max_speed", frame.status.max_speed_on_map, "m/s");
    return m;
}

std::vector<Residual> flat_residuals() { return FlatDeposit{{1000.0, 50.0}, 1.0}.residuals(); }

}  // namespace

std::vector<Problem> deposit_problems() {
    Problem arrest{"bingham_arrest",
                   "a Bingham column 2 m x .5 m slumps on flat ground and arrests, 400 s",
                   {30, 60, 120},
                   flat_residuals,
                   run_arrest};
    arrest.finest_is_long = true;
    arrest.gates = {{60, "wall_depth_error", 1e-2, "goal"},
                    {60, "front_cells", 1.0, "goal"},
                    {60, "l1_depth", 2.5e-2, "goal; 6.9e-3 is still to flow at 400 s"},
                    {0, "mass_error", 1e-13, "round-off"}};
    Problem incline{"bingham_incline",
                    "a Bingham column slumps on 10 deg and arrests (Liu and Mei 1989)",
                    {25, 50, 100},
                    [] { return incline_deposit().residuals(); },
                    run_incline};
    incline.finest_is_long = true;
    incline.gates = {{0, "mass_error", 1e-13, "round-off"}};
    Problem axial{"bingham_axial",
                  "a Bingham cylinder slumps on flat ground and arrests",
                  {20, 30, 40},
                  [] {
                      return RoundDeposit{{1000.0, 50.0}, 1.0}.residuals();
                  },
                  run_axial};
    axial.finest_is_long = true;
    axial.gates = {{30, "l1_depth", 5e-2, "goal"}, {0, "mass_error", 1e-13, "round-off"}};
    return {arrest, incline, axial};
}

}  // namespace frana::verify
