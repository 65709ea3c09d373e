#pragma once
// A case on its way from its file to a finished run folder. `frana run` and the Python module both use it.
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "run/folder/checkpoint.h"
#include "run/folder/products.h"
#include "run/folder/run_folder.h"
#include "run/folder/run_lock.h"
#include "run/folder/run_record.h"
#include "run/run_loop.h"
#include "run/simulation.h"
#include "scene/case_file.h"
#include "scene/scene.h"

namespace frana {

/// What a run needs besides its case.
struct RunWishes {
    std::filesystem::path out;      ///< folder of the run; empty: out/<case name>
    std::vector<std::string> sets;  ///< "key=value" overrides that the case was read with
    std::optional<double> until;    ///< an earlier end [s]
    bool resume = false;            ///< go on from the folder's checkpoint.h5
    bool overwrite = false;         ///< replace the files of an earlier run
    std::function<void(const std::string&)> say = [](const std::string&) {};  ///< gets remarks on barrier meshes
};

class CaseRun {
public:
    /// Builds scene and simulation, then makes room in the folder: what lies there survives a case that cannot run. Throws
    /// UserError.
    CaseRun(const CaseFile& file, const RunWishes& wishes);

    const std::filesystem::path& folder() const { return run_dir_; }
    const Scene& scene() const { return scene_; }
    Simulation& simulation() { return *simulation_; }
    const RunRecord& record() const { return record_; }

    /// Once: the run, with all that it leaves (carry_out). `more` are further observers. A failure is in the record's
    /// summary.
    RunRecord carry_out(const Interrupt& interrupt, Progress& progress, Observers more = {},
                        std::vector<ProductRaster>* rasters = nullptr);

private:
    std::filesystem::path run_dir_;
    std::optional<RunLock> lock_;
    std::optional<OpenRecord> open_;  ///< closed before the lock is let go of
    Scene scene_;
    std::unique_ptr<Simulation> simulation_;
    std::optional<CheckpointKeeper> keeper_;
    RunRecord record_;
};

/// The scene of a case, which ends at `until` [s] when that is given. Throws UserError.
Scene scene_to_run(const CaseFile& file, const std::optional<double>& until,
                   const std::function<void(const std::string&)>& say);

}  // namespace frana
