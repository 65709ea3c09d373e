#pragma once
// What surfaces do to the nodes of the 3D grid and to points that came to lie behind them. It is the same for all laws.
#include "solid3d/mpm3d.h"

namespace frana {

/// The nodes' velocities, from their momentum. flip: points retain theirs (mpm3d.h). averages: of J they tell the mean.
void move_nodes(SolidBody& body, bool flip, bool averages);

/// Points that came to lie behind a surface are put back on it, without their speed into it. It rarely happens.
void move_out(SolidBody& body, SurfaceSet near, Index p, Vec3* impulse);

/// Points stay outside of barriers. If a point's way from its last place crosses a face, it is put back on that
/// face. It then lies a hair before the face so that it never starts inside. Where there is no such place, it is
/// put back where it was.
void keep_out(SolidBody& body, Index tile, Index p, const Vec3& from);

}  // namespace frana
