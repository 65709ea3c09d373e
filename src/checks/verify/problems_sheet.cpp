// Uniform flow down a plane, straight and across the grid. The slab is finite. It is so long that the flow in the
// middle is steady before what starts at its ends comes there. Only the middle is measured.
#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "checks/verify/exact_sheet.h"
#include "checks/verify/library.h"
#include "checks/verify/trial.h"

namespace frana::verify {
namespace {

using constants::kDegree;

/// A square of flow from rest, on a plane that falls towards `azimuth` from the x axis.
struct UniformSlab {
    double length, slope, thickness, density;  ///< [m], [rad], normal to the bed [m], [kg/m^3]
    BedLaw law;
    double speed;  ///< exact mean speed along the bed [m/s]
    double end;    ///< [s]
};

/// Largest error of depth and velocity in the middle, relative.
struct SlabErrors {
    double depth = 0.0, speed = 0.0;
};

SlabErrors errors(const Frame& frame, const UniformSlab& slab, double azimuth) {
    const double *h = frame.node("depth")->data, *v = frame.node("velocity")->data;
    const double along = slab.speed * std::cos(slab.slope), middle = 0.5 * slab.length;
    const double exact[3] = {along * std::cos(azimuth), along * std::sin(azimuth), -slab.speed * std::sin(slab.slope)};
    SlabErrors worst;
    for (Index j = 0; j < frame.grid.ny; ++j)
        for (Index i = 0; i < frame.grid.nx; ++i) {
            const double away = std::max(std::abs(frame.grid.x(i) - middle), std::abs(frame.grid.y(j) - middle));
            if (away > 0.1 * slab.length) continue;
            const Index k = j * frame.grid.nx + i;
            worst.depth = std::max(worst.depth, std::abs(h[k] * std::cos(slab.slope) / slab.thickness - 1));
            worst.speed = std::max(
                worst.speed,
                std::hypot(v[3 * k] - exact[0], v[3 * k + 1] - exact[1], v[3 * k + 2] - exact[2]) / slab.speed);
        }
    return worst;
}

Measurement run_slab(const Setup& setup, const UniformSlab& slab) {
    Measurement straight;
    double turned = 0.0;
    for (const double azimuth : {0.0, 27 * kDegree}) {
        const double fall = std::tan(slab.slope);
        Scene scene =
            scene_on(setup.cells + 1, setup.cells + 1, slab.length / static_cast<double>(setup.cells),
                     [&](double x, double y) { return -fall * (x * std::cos(azimuth) + y * std::sin(azimuth)); });
        scene.density = slab.density;
        scene.bed_law = slab.law;
        fill(scene, [&](double, double) { return slab.thickness / std::cos(slab.slope); }, {setup.per_side});
        Trial trial(std::move(scene), setup);
        trial.run_to(slab.end);
        const SlabErrors worst = errors(trial.simulation().frame(), slab, azimuth);
        if (azimuth == 0.0) {
            straight = trial.measure();
            straight.linf_depth = worst.depth;
            straight.add("speed_error", worst.speed);
        } else {
            turned = worst.speed;
        }
    }
    straight.add("speed_error_turned", turned);
    return straight;
}

UniformSlab bingham_slab(const BinghamSheet& sheet, double length, double end) {
    return {length,
            sheet.slope,
            sheet.thickness,
            sheet.density,
            bed::Bingham{sheet.viscosity, sheet.yield_stress, 0.0},
            sheet.mean_speed(),
            end};
}

Problem slab_problem(const char* name, const char* title, std::function<std::vector<Residual>()> residuals,
                     const UniformSlab& slab, const Gate& gate) {
    Problem problem{
        name, title, {60, 90, 120}, std::move(residuals), [slab](const Setup& setup) { return run_slab(setup, slab); }};
    problem.order_of = "speed_error";
    Gate turned = gate;
    turned.quantity = "speed_error_turned";
    problem.gates = {gate, turned, {120, "linf_depth", 1e-10, "round-off: a uniform lattice stays uniform"}};
    return problem;
}

}  // namespace

std::vector<Problem> sheet_problems() {
    // Relaxation rho h^2 / (3 mu) = 0.1 s: 50 of them.
    const BinghamSheet bingham{1500.0, 5000.0, 300.0, 15 * kDegree, 1.0};
    const BinghamSheet newton{1500.0, 5000.0, 0.0, 15 * kDegree, 1.0};
    const BagnoldSheet bagnold{{std::tan(21 * kDegree), std::tan(33 * kDegree), 0.3, 1e-3, 0.6}, 26 * kDegree, 0.02};
    const UniformSlab granular{80.0, bagnold.slope, bagnold.thickness, 1500.0, bagnold.law, bagnold.mean_speed(), 24.0};
    return {
        slab_problem("bingham_flow", "uniform Bingham flow down 15 deg, straight and turned 27 deg",
                     [bingham] { return bingham.residuals(); }, bingham_slab(bingham, 240.0, 5.0),
                     {120, "speed_error", 1e-10, "goal"}),
        slab_problem("newton_flow", "uniform Newtonian flow down 15 deg, straight and turned 27 deg",
                     [newton] { return newton.residuals(); }, bingham_slab(newton, 240.0, 5.0),
                     {120, "speed_error", 1e-10, "as bingham_flow"}),
        slab_problem("bagnold", "uniform granular flow, mu(I), down 26 deg (Bagnold's profile)",
                     [bagnold] { return bagnold.residuals(); }, granular, {120, "speed_error", 1e-3, "goal 0.1 %"})};
}

}  // namespace frana::verify
