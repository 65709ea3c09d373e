#pragma once
// What an ensemble says: maps, table, page and pictures.
#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include "run/end_remarks.h"
#include "run/ensemble/shard_store.h"

namespace frana {

/// How much of the terrain is in a class of hazard.
struct HazardArea {
    std::string name;
    Index number = 0;   ///< in the raster
    double area = 0.0;  ///< [m2]
    /// Where runs have no answer: had they come nowhere, and had they come wherever another one did [m2].
    std::optional<std::pair<double, double>> bounds;
};

/// How its runs went.
struct EnsembleSummary {
    Index samples = 0, run = 0, failed = 0, not_at_rest = 0, left_terrain = 0;
    double core_seconds = 0.0;           ///< of all runs [s]
    std::optional<double> wall_seconds;  ///< of this process, where it ran them [s]
    double effective = 0.0;              ///< number of equal weights that tell as much
    std::string first_failure;           ///< why the first run that failed did; "": none
    double failed_share = 0.0;           ///< of all weights, that of the runs that failed [1]
    bool weighted = false;               ///< weights differ
    bool maps_drawn = true;
    std::vector<HazardArea> hazard;  ///< from the least to the greatest; empty without classes
    std::string hazard_remark;       ///< what to mind about the classes, in sentences; empty where nothing
    RemarkTally remarks;             ///< on single runs
    std::vector<std::string> files;  ///< that were made

    /// So many fail that the maps should not be trusted.
    bool too_many_failed() const { return failed_share > 0.05; }
};

/// Writes runs.csv, rasters, outlines, pictures, report.md and ensemble.json of all runs so far. Throws UserError when
/// none has an answer, or a file cannot be written.
EnsembleSummary write_maps(const std::filesystem::path& dir, const EnsemblePlan& plan, const EnsembleBase& base,
                           const KeptResults& kept, std::optional<double> wall_seconds);

/// "share of the runs with peak flow depth above 0.5 m".
std::string meaning_of_exceedance(const PeakField& field, double threshold);

/// What rasters/probability_FIELD_THRESHOLD.tif holds or would hold, in double precision. Throws
/// UserError where no run has an answer, or the ensemble stores no such field.
Raster probability_map(const std::filesystem::path& dir, const EnsemblePlan& plan, const EnsembleBase& base,
                       const KeptResults& kept, const std::string& field, double threshold);

/// samples.csv: number, weight and the values of the keys that vary.
std::string samples_table(const EnsemblePlan& plan);

/// For people: how many runs, how many of them failed.
std::string runs_sentence(const EnsembleSummary& summary);

}  // namespace frana
