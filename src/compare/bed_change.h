#pragma once
// How a run has changed the ground, held against the difference of two surveys.
#include <vector>

#include "terrain/raster.h"

namespace frana {

/// Both are positive [m3].
struct BedVolumes {
    double eroded = 0.0, deposited = 0.0;
    double all() const { return eroded + deposited; }
};

/// Changes of at most `noise` count as none, in the run as in the survey.
struct BedChangeErrors {
    double noise = 0.1;              ///< [m]
    BedVolumes simulated, surveyed;  ///< where the survey has data, outside of the release
    BedVolumes within_noise;         ///< simulated, of at most `noise`; in nothing else
    BedVolumes unsurveyed;           ///< simulated where the survey has no data; in nothing else
    BedVolumes release;              ///< surveyed where the run began; in nothing else
    double misplaced = 0.0;          ///< where one of the two rises and the other sinks, or only one changes [m3]
    double compared_area = 0.0;      ///< where one of the two changes, and surveyed [m2]
    double mae = 0.0;                ///< mean |simulated - surveyed| over that area [m]; NaN when there is none
    double rmse = 0.0;               ///< root of the mean square there [m]

    /// (simulated - surveyed) / surveyed [1]; NaN when nothing was surveyed
    double eroded_error() const { return ratio(simulated.eroded - surveyed.eroded, surveyed.eroded); }
    double deposited_error() const { return ratio(simulated.deposited - surveyed.deposited, surveyed.deposited); }
    /// Misplaced over surveyed volume [1]. 0: each pixel changes as surveyed. 1: the run changes nothing. 2: it changes
    /// as much as was surveyed, but elsewhere.
    double misplaced_share() const { return ratio(misplaced, surveyed.all()); }

private:
    static double ratio(double a, double b) { return b > 0.0 ? a / b : Raster::nodata; }
};

/// What a second survey would see: the change of the bed [m]. With `lying` it adds the depth of what lies on it at the
/// end [m]. NaN where the run began (arrival time 0, when that is known): what stood there before was no bed. NaN also
/// where `later` is above 0, a release that entered after the start; it may be null. All rasters are on one grid; no
/// data counts as no change.
Raster surface_change(const Raster& bed_change, const Raster* lying, const Raster* arrival_time,
                      const Raster* later = nullptr);

/// `surveyed` has the pixels of `simulated` (see surface_change), and may have more around them; there nothing was
/// simulated. NaN in the survey: not surveyed.
BedChangeErrors bed_change_errors(const Raster& simulated, const Raster& surveyed, double noise);

/// A step of the path, with all changes whose nearest point on it lies there.
struct BedChangeStep {
    double distance = 0.0;  ///< of its middle along the path [m]
    Vec2 point{0, 0};       ///< there
    BedVolumes simulated, surveyed;
};

/// The volumes of bed_change_errors by where they lie along a path, in equal steps of at most two cells. What lies before
/// the path or beyond it is in its first and last step. Empty for a path without length.
std::vector<BedChangeStep> bed_change_along(const Polyline& path, const Raster& simulated, const Raster& surveyed,
                                            double noise);

}  // namespace frana
