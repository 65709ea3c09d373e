#pragma once

namespace frana {

/// Largest speeds count where the flow is at least this share of the footprint depth deep [1]. A film at its edge may run
/// faster than all of it.
inline constexpr double kSpeedCounts = 0.1;

}  // namespace frana
