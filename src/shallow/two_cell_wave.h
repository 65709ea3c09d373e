#pragma once
// The wave of two cells that central differences do not see. THEORY (17), (18).
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

}  // namespace frana
