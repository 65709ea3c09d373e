// Viscous sheets of constant volume (Huppert 1982) on flat ground, round an axis and down an incline. They go from the
// exact shape at one time to a later one. Inertia against viscosity is h^2 / (15 nu t): a few 1e-4 here.
#include <cmath>

#include "base/constants.h"
#include "checks/verify/exact_spreading.h"
#include "checks/verify/library.h"
#include "checks/verify/trial.h"

namespace frana::verify {
namespace {

using constants::kDegree;

void set_viscosity(Scene& scene, double nu) {
    scene.bed_law = bed::Bingham{nu * scene.density, 0.0, 0.0};
    scene.rheology = rheology::Newtonian{nu * scene.density};
    scene.sides = Sides::wall;
}

/// Where the depth last falls through `level` along the nodes from `start`, so many cells a step; in cells.
double last_contour(const Frame& frame, Index start, Index step, double step_cells, double level) {
    const double* h = frame.node("depth")->data;
    double found = kNone;
    for (Index n = 0, k = start; k + step < frame.grid.size() && n + 1 < frame.grid.nx; ++n, k += step)
        if (h[k] >= level && h[k + step] < level)
            found = (static_cast<double>(n) + (h[k] - level) / (h[k] - h[k + step])) * step_cells;
    return found;
}

constexpr double kSpreadingStart = 20.0, kSpreadingEnd = 200.0;  ///< [s]

Measurement run_planar(const Setup& setup) {
    const PlanarSpreading sheet{0.2, 1.0};
    const double cell = 6.0 / static_cast<double>(setup.cells);
    const Index nx = static_cast<Index>(std::ceil(8.0 / cell)) + 1;
    Scene scene = scene_on(nx, 5, cell, [](double, double) { return 0.0; });
    set_viscosity(scene, sheet.nu);
    fill_cut(scene, [&](double x, double) { return sheet.depth(x, kSpreadingStart); }, {setup.per_side});
    Trial trial(std::move(scene), setup);
    trial.run_to(kSpreadingEnd - kSpreadingStart);
    Measurement m = trial.measure({[&](double x, double) { return sheet.depth(x, kSpreadingEnd); },
                                   [&](double x, double) { return sheet.speed(x, kSpreadingEnd); }});
    const Frame frame = trial.simulation().frame();
    const double level = 0.2 * sheet.depth(0.0, kSpreadingEnd), exact = sheet.contour(level, kSpreadingEnd);
    const Index row = frame.grid.ny / 2 * frame.grid.nx;
    m.front_error = last_contour(frame, row, 1, 1.0, level) * cell - exact;
    m.add("front_law", m.front_error / exact);
    m.add("wall_depth_error", frame.node("depth")->data[row] / sheet.depth(0.0, kSpreadingEnd) - 1);
    return m;
}

Measurement run_round(const Setup& setup) {
    const RoundSpreading sheet{0.2, 3.0};
    const double cell = 3.0 / static_cast<double>(setup.cells);
    const Index n = static_cast<Index>(std::ceil(4.0 / cell)) + 1;
    Scene scene = scene_on(n, n, cell, [](double, double) { return 0.0; });
    set_viscosity(scene, sheet.nu);
    fill_cut(scene, [&](double x, double y) { return sheet.depth(std::hypot(x, y), kSpreadingStart); },
             {setup.per_side});
    Trial trial(std::move(scene), setup);
    trial.run_to(kSpreadingEnd - kSpreadingStart);
    const auto radial = [&](double x, double y) {
        const double r = std::hypot(x, y);
        return r > 0.0 ? sheet.speed(r, kSpreadingEnd) / r : 0.0;
    };
    Measurement m = trial.measure({[&](double x, double y) { return sheet.depth(std::hypot(x, y), kSpreadingEnd); },
                                   [&](double x, double y) { return radial(x, y) * x; },
                                   [&](double x, double y) { return radial(x, y) * y; }});
    const Frame frame = trial.simulation().frame();
    const double level = 0.2 * sheet.depth(0.0, kSpreadingEnd), exact = sheet.contour(level, kSpreadingEnd);
    const double axis = last_contour(frame, 0, 1, 1.0, level) * cell - exact;
    const double diagonal = last_contour(frame, 0, frame.grid.nx + 1, std::sqrt(2.0), level) * cell - exact;
    m.front_error = std::abs(axis) > std::abs(diagonal) ? axis : diagonal;
    m.add("front_law", m.front_error / exact);
    m.add("front_axis", axis / cell, "cells");
    m.add("front_diagonal", diagonal / cell, "cells");
    m.add("centre_depth_error", frame.node("depth")->data[0] / sheet.depth(0.0, kSpreadingEnd) - 1);
    return m;
}

const InclineSpreading kIncline{0.1, 1.0, 20 * kDegree};

/// What a thickness h at X along the bed is on the map. It is the depth h / cos at x = X cos + h sin, the surface's
/// place.
double map_depth(double x, double t) {
    const double c = std::cos(kIncline.slope), s = std::sin(kIncline.slope);
    double h = 0.0;
    for (int k = 0; k < 50; ++k) h = 0.5 * (h + kIncline.thickness((x - h * s) / c, t));  // damped: steep at the front
    return h / c;
}

Measurement run_incline(const Setup& setup) {
    const double start = 100.0, end = 400.0, c = std::cos(kIncline.slope);
    const double cell = 30.0 / static_cast<double>(setup.cells), fall = std::tan(kIncline.slope);
    const Index nx = static_cast<Index>(std::ceil(45.0 / cell)) + 1;
    Scene scene = scene_on(nx, 5, cell, [&](double x, double) { return -fall * x; });
    set_viscosity(scene, kIncline.nu);
    fill_cut(scene, [&](double x, double) { return map_depth(x, start); }, {setup.per_side});
    Trial trial(std::move(scene), setup);
    trial.run_to(end - start);
    Measurement m = trial.measure({[&](double x, double) { return map_depth(x, end); }});
    const Frame frame = trial.simulation().frame();
    const double h = 0.5 * kIncline.front_thickness(end);
    const double exact = kIncline.contour(h, end) * c + h * std::sin(kIncline.slope);
    const Index row = frame.grid.ny / 2 * frame.grid.nx;
    m.front_error = last_contour(frame, row, 1, 1.0, h / c) * cell - exact;
    m.add("front_law", m.front_error / exact);
    return m;
}

}  // namespace

std::vector<Problem> spreading_problems() {
    const Gate mass{0, "mass_error", 1e-13, "round-off"};
    const auto front = [](Index cells) { return Gate{cells, "front_law", 1e-2, "goal 1 %"}; };
    Problem planar{"huppert",     "a viscous sheet spreads on flat ground (Huppert 1982)",
                   {40, 80, 120}, [] { return PlanarSpreading{0.2, 1.0}.residuals(); },
                   run_planar,    {front(120), mass}};
    Problem round{"huppert_round", "a viscous sheet spreads round an axis (Huppert 1982)",
                  {20, 40, 60},    [] { return RoundSpreading{0.2, 3.0}.residuals(); },
                  run_round,       {front(60), mass}};
    Problem incline{"huppert_incline", "a viscous sheet runs down 20 deg (Huppert 1982)",
                    {60, 120, 240},    [] { return kIncline.residuals(); },
                    run_incline,       {front(240), mass}};
    round.finest_is_long = true;  // the two before it show the order
    return {planar, round, incline};
}

}  // namespace frana::verify
