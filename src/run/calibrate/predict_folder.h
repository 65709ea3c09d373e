#pragma once
// Maps of another event, by what the surveys tell: an ensemble of posterior.csv in a folder of a calibration's own.
#include <filesystem>

#include "ensemble/calibration_plan.h"
#include "run/folder/run_lock.h"

namespace frana {

/// Another event's case must take the keys that vary, which is better known before all the runs than after. Throws
/// UserError.
void try_prediction(const CalibrationPlan& plan);

/// Whether the maps are there, of the same case, and no calibration was run since.
bool is_predicted(const std::filesystem::path& dir, const EnsemblePlan& maps);

/// Removes what was predicted by another posterior, or of another case.
void forget_prediction(const std::filesystem::path& dir);

/// Holds a calibration's folder while its ensemble runs.
class PredictFolder {
public:
    /// Writes predict.toml. Where it was of another case, its maps are removed first. Throws UserError.
    PredictFolder(const std::filesystem::path& dir, const EnsemblePlan& maps);

    std::filesystem::path file() const;    ///< of the ensemble
    std::filesystem::path folder() const;  ///< of its runs and maps

private:
    std::filesystem::path dir_;
    RunLock lock_;
};

}  // namespace frana
