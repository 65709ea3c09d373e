#pragma once

namespace frana {

/// Largest speeds count where the flow is at least this share of the footprint depth deep [1]. A film at its edge may run
/// faster than all of it.
inline constexpr double kSpeedCounts = 0.1;

inline bool speed_counts(double depth, double footprint_depth) { return depth >= kSpeedCounts * footprint_depth; }

}  // namespace frana
