#pragma once
// Drag between neighbouring material of different velocity, SamosAT's artificial viscosity.
#include "shallow/flow.h"

namespace frana {

inline bool has_lateral_drag(const Scheme& scheme) { return scheme.lateral_drag > 0.0; }

/// THEORY (29): acceleration of each node by its four neighbours [m/s^2], from mass, flags and velocity before the
/// grid update. The stress on a face is  rho C |dv| dv / 2  over the cell's width and the depth there. dv is the
/// neighbour's velocity less the node's along the map. The depth is by the harmonic mean of both masses m. (Sampl and
/// Granig 2009; AvaFrame's com1DFA has it between a particle and the mesh.) Momentum goes from one side to the other,
/// none is lost; energy is. A step of `dt` takes at most an eighth of dv through a face. So any C is stable:
///   a = sum over faces of (m / m_node) w dv / dt,   w = f / (1 + 8 f),   f = C |dv| dt / (2 cell).
void lateral_pass(Flow& flow, double dt);

}  // namespace frana
