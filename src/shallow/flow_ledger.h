#pragma once
// What a depth-averaged flow gained and lost, from the sums of its passes.
#include "mpm/ledger.h"
#include "observe/frame.h"
#include "shallow/erosion.h"
#include "shallow/grid_update.h"
#include "shallow/transfer.h"

namespace frana {

/// What a flow gained and lost since the start, or in a step (mpm/ledger.h).
struct FlowLedger {
    double mass_left = 0.0;  ///< gone through open sides and exits [kg]
    double mass_in = 0.0;  ///< by inflows, and released later [kg]; its momentum and energy count as what did not leave
    double lost_in_holes = 0.0;  ///< of what left [kg]
    double energy_left = 0.0;    ///< carried out [J]
    double dissipated = 0.0;     ///< [J]
    Flat2 momentum_left{0, 0};   ///< carried out [kg m/s]
    Flat2 impulse{0, 0};         ///< of forces; not where walls stand, whose force closes the balance [kg m/s]
};

/// In the status of the same time.
inline void set_totals(const FlowLedger& all, Status& status) {
    status.mass_left = all.mass_left, status.mass_in = all.mass_in, status.energy_left = all.energy_left;
    status.dissipated = all.dissipated;
    for (std::size_t axis = 0; axis < 2; ++axis) {
        status.momentum_left[axis] = all.momentum_left[static_cast<Eigen::Index>(axis)];
        status.impulse[axis] = all.impulse[static_cast<Eigen::Index>(axis)];
    }
}

/// With the points that were removed.
inline FlowLedger carried_out(const PointSums& sums) {
    FlowLedger out;
    out.mass_left = sums.left_mass, out.energy_left = sums.left_energy;
    out.momentum_left = {sums.left_px, sums.left_py};
    return out;
}

/// The same of points that came in.
inline FlowLedger carried_in(const PointSums& sums) {
    FlowLedger in;
    in.mass_in = sums.left_mass, in.energy_left = -sums.left_energy;
    in.momentum_left = {-sums.left_px, -sums.left_py};
    return in;
}

/// By what the bed gave, or took.
inline FlowLedger of_bed(const ExchangeSums& sums) {
    FlowLedger bed;
    bed.dissipated = sums.lost;
    bed.impulse = {sums.px, sums.py};
    return bed;
}

/// `stress_work`: lost inside the mass in the same step [J].
inline FlowLedger of_grid_update(const GridUpdateSums& sums, double stress_work) {
    FlowLedger update;
    update.dissipated = sums.dissipated + stress_work;
    update.impulse = {sums.impulse_x, sums.impulse_y};
    return update;
}

}  // namespace frana
