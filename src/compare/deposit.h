#pragma once
// A simulated deposit held against a surveyed one, thickness by thickness.
#include "terrain/raster.h"

namespace frana {

/// What lies there at the end: the final depth, and what has become bed; `deposited` may be null. NaN in one of them adds
/// nothing.
Raster with_deposit(const Raster& final_depth, const Raster* deposited);

/// The largest depth that is known of a place: the flow's peak, or what lies there at the end. Thin layers may have buried
/// ground which no flow was ever deep on. NaN in one of them counts as nothing.
Raster deepest_cover(const Raster& peak_depth, const Raster& lying);

/// Of all depths above zero [m3].
double volume_of(const Raster& depth);

struct DepositErrors {
    double simulated_volume = 0.0;   ///< where the survey has data [m3]
    double surveyed_volume = 0.0;    ///< [m3]
    double unsurveyed_volume = 0.0;  ///< simulated where the survey has none; in none of the errors [m3]
    double compared_area = 0.0;      ///< deeper than the limit in one of the two, and surveyed [m2]
    double mae = 0.0;                ///< mean |simulated - surveyed| over that area [m]; NaN when there is none
    double rmse = 0.0;               ///< root of the mean square there [m]
    Index negative = 0;              ///< pixels of the survey below zero, taken as they are

    /// (simulated - surveyed) / surveyed [1]
    double volume_error() const { return (simulated_volume - surveyed_volume) / surveyed_volume; }
};

/// `surveyed` has the pixels of `simulated`, and may have more around them; there nothing was
/// simulated. NaN in the survey: not surveyed. NaN in the simulation: nothing.
DepositErrors deposit_errors(const Raster& simulated, const Raster& surveyed, double limit);

}  // namespace frana
