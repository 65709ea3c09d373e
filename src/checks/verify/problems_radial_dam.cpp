// A round column of water of 1 m is let go (scheme study, section 4). It is on dry ground or in water of 0.2 m.
#include <cmath>

#include "base/constants.h"
#include "checks/verify/exact_radial_dam.h"
#include "checks/verify/library.h"
#include "checks/verify/trial.h"

namespace frana::verify {
namespace {

constexpr double kRadialReach = 24.0;  ///< of the square around the column; no wave gets there [m]

/// The reference, computed once.
const RadialDam& reference(double outer) {
    static const RadialDam dry(0.0), wet(0.2);
    return outer > 0.0 ? wet : dry;
}

/// Radius of a disc as large as what lies deeper than `level` [m]. A quarter of it is seen, and walls cut nodes in
/// half.
double mean_radius(const Frame& frame, double level) {
    const double* h = frame.node("depth")->data;
    double nodes = 0.0;
    for (Index j = 0; j < frame.grid.ny; ++j)
        for (Index i = 0; i < frame.grid.nx; ++i)
            if (h[j * frame.grid.nx + i] > level) nodes += (i == 0 ? 0.5 : 1.0) * (j == 0 ? 0.5 : 1.0);
    return frame.grid.cell * std::sqrt(4 * nodes / constants::kPi);
}

/// A quarter of the square, cells counted along its whole side; the walls are the symmetry.
Measurement run_dam(const Setup& setup, double outer, double level) {
    const Index half = setup.cells / 2;
    Scene scene =
        scene_on(half + 1, half + 1, kRadialReach / static_cast<double>(half), [](double, double) { return 0.0; });
    scene.sides = Sides::wall;
    const auto depth = [&](double x, double y) {
        return std::hypot(x, y) < RadialDam::kRadius ? RadialDam::kDepth : outer;
    };
    fill_cut(scene, depth, {setup.per_side});
    Trial trial(std::move(scene), setup);
    trial.run_to(RadialDam::kEnd);
    const RadialDam& exact = reference(outer);
    const auto velocity = [&](double x, double y, double along) {
        const double r = std::hypot(x, y);
        return r > 0.0 ? exact.at(r).velocity * along / r : 0.0;
    };
    Measurement m = trial.measure({[&](double x, double y) { return exact.at(std::hypot(x, y)).depth; },
                                   [&](double x, double y) { return velocity(x, y, x); },
                                   [&](double x, double y) { return velocity(x, y, y); }});
    m.front_error = mean_radius(trial.simulation().frame(), level) - exact.contour(level);
    return m;
}

}  // namespace

std::vector<Problem> radial_dam_problems() {
    const Gate volume{0, "mass_error", 1e-13, "round-off"};
    Problem dry{"radial_dam",
                "round dam break on a dry bed, against a radial reference of 3000 cells",
                {80, 160, 320},
                [] { return reference(0.0).residuals(); },
                [](const Setup& s) { return run_dam(s, 0.0, 0.01); }};
    const std::string source = "a fifth above what an earlier code had: ";
    dry.gates = {{160, "l1_depth", 4e-2, source + "3.3e-2"}, {320, "l1_depth", 2e-2, source + "1.7e-2"}, volume};
    Problem wet{"radial_dam_wet",
                "round dam break onto shallow water, against a radial reference of 3000 cells",
                {80, 160, 320},
                [] { return reference(0.2).residuals(); },
                [](const Setup& s) { return run_dam(s, 0.2, 0.25); }};
    wet.gates = {{160, "l1_depth", 2.4e-2, source + "2.0e-2"}, {320, "l1_depth", 1.3e-2, source + "1.07e-2"}, volume};
    return {dry, wet};
}

}  // namespace frana::verify
