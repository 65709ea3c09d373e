#pragma once
// A run held against a survey: every score in one place, from rasters and polygons.
#include <optional>
#include <string>
#include <vector>

#include "compare/bed_change.h"
#include "compare/deposit.h"
#include "compare/overlap.h"
#include "compare/runout.h"

namespace frana {

/// What was simulated. All rasters on one grid.
struct SimulatedRun {
    const Raster* peak_depth = nullptr;       ///< needed
    const Raster* final_depth = nullptr;      ///< or null: no scores of the final state
    const Raster* arrival_time = nullptr;     ///< or null: no steepest path
    const Raster* bed = nullptr;              ///< or null: no steepest path
    double limit = 0.1;                       ///< deeper counts as covered [m]
    const Raster* bed_change = nullptr;       ///< or null: the bed is rock
    const Raster* deposited_depth = nullptr;  ///< or null: nothing became bed; lies with the final depth
    std::vector<Vec2> starts;                 ///< where material came in that was not released at the start
    const Raster* released_later = nullptr;   ///< or null; above 0 where a release entered after the start
};

/// What was surveyed.
struct Survey {
    Polygons footprint;                ///< polygons that do not overlap; none: changes of the bed are compared alone
    std::optional<Polyline> path;      ///< for the runout; nothing: the steepest one from the start of the flow
    std::optional<Raster> deposit;     ///< thickness [m] on pixels of the run, maybe more around them
    std::string path_source;           ///< file of the path
    std::string deposit_source;        ///< file of the thickness
    std::optional<Raster> bed_change;  ///< after minus before [m], likewise
    double bed_change_noise = 0.1;     ///< of that [m]
    std::string bed_change_source;     ///< file of that
};

/// Scores of one simulated extent.
struct ExtentScores {
    Overlap areas;
    OutlineDistance boundary;        ///< NaN when nothing was simulated
    double runout = Raster::nodata;  ///< along the path [m]; NaN without path or extent
    double reach = Raster::nodata;   ///< straight from the path's start to the farthest point of the extent [m]
};

/// Runout of a release whose flow does not touch that of a larger one, or went down another valley.
struct OtherRunout {
    Polyline path;
    double simulated = Raster::nodata, surveyed = Raster::nodata;  ///< NaN: nothing of that is nearest to this path [m]
};

struct Comparison {
    std::string survey, path_source, deposit_source, bed_change_source;
    double limit = 0.1;
    double cell = 1.0;
    bool extents = true;                ///< a footprint was surveyed; else there are no scores of extents
    ExtentScores trace;                 ///< everything ever covered, as Fois et al. (2024), section 4.3
    std::optional<ExtentScores> final;  ///< what is covered at the end
    Polyline path;                      ///< empty: none
    std::vector<OtherRunout> others;    ///< of releases with flows of their own
    double surveyed_runout = Raster::nodata, surveyed_reach = Raster::nodata;
    std::optional<DepositErrors> deposit;
    std::optional<BedChangeErrors> bed_change;
    std::vector<BedChangeStep> bed_change_steps;  ///< along the path
    Rings outline;                                ///< of the trace
    std::vector<std::string> remarks;
    bool path_is_given = false;  ///< the survey's; else it was found on the terrain
    std::string stray_path;      ///< why the survey's path is not used; "": it is, or none was given
};

/// The path, then those of the others.
std::vector<Polyline> paths_of(const Comparison& comparison);

/// Without a footprint the survey has to have a bed_change, which alone is compared.
Comparison compare(const SimulatedRun& run, const Survey& survey);

}  // namespace frana
