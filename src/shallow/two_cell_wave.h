#pragma once
// The wave of two cells that is invisible to central differences. THEORY (17), (18).
#include "base/simd.h"
#include "base/types.h"

namespace frana {

/// X of THEORY (17) along one direction, of one node or four: a sixteenth of the fourth difference.
template <class Real>
Real wave_along(const double* e, Index step) {
    const auto at = [&](Index n) { return read<Real>(e + n * step); };
    return ((at(-2) + at(2)) - 4.0 * (at(-1) + at(1)) + 6.0 * at(0)) / 16.0;
}

/// XY: the wave in y of the waves in x.
template <class Real>
Real wave_along_both(const double* e, Index up) {
    const auto row = [&](Index n) { return wave_along<Real>(e + n * up, 1); };
    return ((row(-2) + row(2)) - 4.0 * (row(-1) + row(1)) + 6.0 * row(0)) / 16.0;
}

/// The waves along a row of four nodes: `left` has what two before them have, `right` two behind.
[[gnu::always_inline]] inline Double4 wave_of_row(Double4 left, Double4 right) {
    const Double4 before = __builtin_shufflevector(left, right, 1, 2, 3, 4);
    const Double4 here = __builtin_shufflevector(left, right, 2, 3, 4, 5);
    const Double4 behind = __builtin_shufflevector(left, right, 3, 4, 5, 6);
    return ((left + right) - 4.0 * (before + behind) + 6.0 * here) / 16.0;
}

/// The wave that the level and the depth have in common, over the depth [1]; none where they disagree. `law_depth` is the
/// depth without its wave, `surface` the level without its own. THEORY (50).
template <class Real>
Real common_wave(Real depth, Real law_depth, Real level, Real surface) {
    constexpr double kDry = 1e-100;  // [m]
    const Real none{}, of_depth = depth - law_depth, of_level = level - surface;
    const Real wave = max(none, min(of_depth, of_level)) + min(none, max(of_depth, of_level));
    return wave / max(depth, none + kDry);
}

/// Takes the way (dx, dy) of a point in a step [cells] off the crests of two-cell waves. Along each axis that is at most half
/// of its length, `way`. What stays in place stays. THEORY (50).
/// wave_x, wave_y: change of the wave over a cell [1]. strength: `scheme.wave_shift`.
template <class Real>
void off_waves(double strength, const Real& wave_x, const Real& wave_y, const Real& way, Real& dx, Real& dy) {
    const Real most = 0.5 * way, scale = strength * way;
    dx -= max(-most, min(most, scale * wave_x));
    dy -= max(-most, min(most, scale * wave_y));
}

}  // namespace frana
