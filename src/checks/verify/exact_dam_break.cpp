#include "checks/verify/exact_dam_break.h"

#include <cmath>

namespace frana::verify {
namespace {

/// Left-going fan of water of depth hl at rest.
WaveState fan(double s, double hl, double g) {
    const double c = std::sqrt(g * hl);
    return {(2 * c - s) * (2 * c - s) / (9 * g), 2.0 / 3.0 * (c + s)};
}

}  // namespace

WaveState Ritter::at(double s) const {
    const double c = std::sqrt(g * hl);
    if (s <= -c) return {hl, 0.0};
    if (s >= 2 * c) return {0.0, 0.0};
    return fan(s, hl, g);
}

double Ritter::front() const { return 2 * std::sqrt(g * hl); }

/// The middle depth is where the fan's and the shock's velocity agree; bisection, as both are monotone in it.
Stoker::Stoker(double left, double right, double gravity) : hl(left), hr(right), g(gravity) {
    double low = right, high = left;
    for (int k = 0; k < 200; ++k) {
        hm = 0.5 * (low + high);
        const double by_fan = 2 * (std::sqrt(g * hl) - std::sqrt(g * hm));
        const double by_shock = (hm - hr) * std::sqrt(0.5 * g * (hm + hr) / (hm * hr));
        (by_fan > by_shock ? low : high) = hm;
    }
    um = 2 * (std::sqrt(g * hl) - std::sqrt(g * hm));
    shock = hm * um / (hm - hr);
}

WaveState Stoker::at(double s) const {
    if (s <= -std::sqrt(g * hl)) return {hl, 0.0};
    if (s <= um - std::sqrt(g * hm)) return fan(s, hl, g);
    return s < shock ? WaveState{hm, um} : WaveState{hr, 0.0};
}

std::vector<Residual> Stoker::residuals() const {
    const double scale = g * hl * hl;
    const double mass = hm * (um - shock) + hr * shock;
    const double momentum = hm * um * (um - shock) + 0.5 * g * (hm * hm - hr * hr);
    const WaveState foot = fan(um - std::sqrt(g * hm), hl, g);
    return {{"shock: jump of mass / (hl c)", mass / (hl * std::sqrt(g * hl)), 1e-14},
            {"shock: jump of momentum / (g hl^2)", momentum / scale, 1e-14},
            {"foot of the fan: depth / hm - 1", foot.depth / hm - 1, 1e-14},
            {"foot of the fan: velocity / um - 1", foot.velocity / um - 1, 1e-14}};
}

}  // namespace frana::verify
