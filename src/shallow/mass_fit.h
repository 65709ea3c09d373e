#pragma once
#include <string>

#include "shallow/flow.h"

namespace frana {

/// What the fit did.
struct MassFit {
    Index rows = 0;               ///< nodes held to the level
    Index iterations = 0;         ///< of the conjugate gradients, all rounds
    double largest_change = 0.0;  ///< largest |m - m0| / m0 of a point [1]
    Index clipped = 0;            ///< points whose mass met the limits [0.03, 5] m0
    Index left_free = 0;          ///< wet nodes that nothing can hold: at open sides, or on higher ground
    double volume_change = 0.0;   ///< of all, relative [1]
    double level_error = 0.0;     ///< largest distance of the surface from the level where it is wet (off_level) [m]
};

/// Largest distance of the free surface, margins included, from `level` on the wet nodes of the domain [m].
double off_level(const Flow& flow, double level);

/// THEORY (58): changes the points' masses so that depth + bed equals `level` [m] on the wet nodes. It is a lake that
/// starts at exact rest, wherever the points stand. Least change, weighted by mass: m = m0 + W B^T y, (B W B^T) y = t -
/// B m0, by conjugate gradients. B is the deposit (sub-points and walls included). Nodes whose surface is extrapolated
/// from inside are left free unless they would end below the level. So are those within a cell of an open side, beyond which
/// nothing is, and those on ground above the level, as of a barrier in the lake. Sorts must have been done; rheology plays no part.
MassFit fit_masses(Flow& flow, double level);

/// What to say of a fit on cells of that size [m].
std::string remark_on(const MassFit& fit, double cell);

}  // namespace frana
