#pragma once
// What happens to points at the sides of the domain and where the elevation model has no data.
#include "shallow/transfer.h"

namespace frana {

/// A point so near to a wall lies on it [cells]. That is the round-off of places on grids of up to 65 000 cells.
constexpr double kOnWall = 1e-11;

/// Records in `sums` that point p leaves at node k. Returns its kinetic and potential energy [J].
template <class Real>
double leave(const Flow& flow, Index p, Index k, PointSums& sums);

/// Walls reflect point p. Those in holes of the terrain stop it, also on its way (dx, dy) of the step [cells]. Beyond
/// open sides, and where the elevation model has no data, it leaves. It is marked in `gone`, recorded in `sums`,
/// without mass from then on. Returns how far a wall in a hole set it back [cells].
template <class Real>
double meet_side(Flow& flow, Index p, double dx, double dy, std::vector<std::uint8_t>& gone, PointSums& sums);

}  // namespace frana
