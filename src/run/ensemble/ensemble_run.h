#pragma once
// An ensemble from its file to its maps: what `frana ensemble` and the Python module share.
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "ensemble/sample_run.h"
#include "io/gdal_reader.h"
#include "run/ensemble/maps.h"
#include "run/ensemble/shard_store.h"
#include "scene/shared_reader.h"

namespace frana {

/// Refuses a folder in which files lie that an ensemble writes and no ensemble has left there. Throws UserError.
void require_room_for_ensemble(const std::filesystem::path& dir);

/// Removes what an ensemble has left in a folder: first its record, which says that all is there.
void remove_ensemble(const std::filesystem::path& dir);

/// The file of the ensemble whose runs are in a folder. Throws UserError where it is none.
std::filesystem::path origin_of_ensemble(const std::filesystem::path& dir);

class EnsembleRun {
public:
    /// Builds the case of the plan once. Throws UserError where it cannot run.
    EnsembleRun(EnsemblePlan plan, std::filesystem::path dir);
    EnsembleRun(const EnsembleRun&) = delete;
    EnsembleRun& operator=(const EnsembleRun&) = delete;

    const EnsemblePlan& plan() const { return plan_; }
    const EnsembleBase& base() const { return base_; }
    const std::filesystem::path& folder() const { return dir_; }

    /// Those on the case, and on the first sample. What other samples are told is among the results.
    std::vector<std::string> remarks_beforehand() const;

    /// Those of the shard that no shard in the folder has run; what was refused is tried again. Throws UserError where the
    /// shard has run before, unless it is to go on. So too where an ensemble has no room.
    std::vector<Index> left_to_run(const Shard& shard, bool resume) const;

    /// Runs these samples of a shard on so many threads (0: as OMP_NUM_THREADS or the machine says). Saves their
    /// results in the folder. An interrupt leaves what has run. `done` hears of each run, on any thread: whether it
    /// failed.
    void run(const Shard& shard, const std::vector<Index>& samples, int threads, const Interrupt& interrupt,
             const std::function<void(bool)>& done) const;

    /// A sample on this thread that leaves nothing. Nothing when the interrupt was requested meanwhile.
    std::optional<SampleResult> try_out(Index sample, const Interrupt& interrupt) const;

    /// The maps of all runs in the folder. Throws UserError where no run has an answer.
    EnsembleSummary join(std::optional<double> wall_seconds) const;

    /// Share of the folder's runs with more than `threshold` of a stored field [1], as in the map of ensemble.exceed.
    /// Throws UserError.
    Raster probability(const std::string& field, double threshold) const;

private:
    EnsemblePlan plan_;
    std::filesystem::path dir_;
    GdalReader files_;
    SharedReader reader_;
    MeshReader meshes_;
    EnsembleBase base_;
};

}  // namespace frana
