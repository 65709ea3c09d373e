#pragma once
// How finely outlines of pixels are divided where their distance is taken.

namespace frana {

/// Of pixels of that size: well below their own coarseness [m].
inline double outline_step(double cell) { return 0.25 * cell; }

}  // namespace frana
