#pragma once
// The folder of an ensemble: what its runs left, shard by shard.
#include <chrono>
#include <filesystem>
#include <mutex>
#include <string>
#include <vector>

#include "ensemble/sample_run.h"
#include "run/ensemble/value_sums.h"

namespace frana {

/// The part of an ensemble's samples that one process runs: a block of neighbours.
struct Shard {
    Index number = 0, of = 1;

    Index begin(Index samples) const { return samples * number / of; }
    Index end(Index samples) const { return samples * (number + 1) / of; }
};

/// "3/40". Throws UserError.
Shard read_shard(const std::string& text);

/// DIR/shards/NUMBER_of_COUNT.
std::filesystem::path shard_folder(const std::filesystem::path& dir, const Shard& shard);

/// What an ensemble's rows belong to: version, seed, and sums of what decides its runs.
std::string mark_of(const EnsemblePlan& plan);

/// Whether the folder has runs of an ensemble. Throws UserError where they are another's (what differs is said).
bool has_runs_of(const std::filesystem::path& dir, const EnsemblePlan& plan);

/// Stores results as they come, from any thread, many at a time. Their peaks go to an HDF5 file, then their rows to
/// runs.csv. A row is what counts: however the program ends, a run is stored whole or not at all.
class ShardStore {
public:
    ShardStore(std::filesystem::path folder, const EnsemblePlan& plan, const EnsembleBase& base);

    void add(SampleResult result);
    /// Writes what is not written yet.
    void flush();

private:
    void write();
    std::string new_peaks_file(Index first) const;

    std::filesystem::path folder_;
    const EnsemblePlan& plan_;
    const EnsembleBase& base_;
    ValueSums sums_;  ///< as the files are before the first run
    std::string rows_;
    bool broken_ = false;
    std::vector<SampleResult> waiting_;
    std::chrono::steady_clock::time_point written_ = std::chrono::steady_clock::now();
    std::mutex mutex_;
};

/// Removes what processes that were killed were writing in a folder that no other process now writes to.
void remove_leftovers(const std::filesystem::path& folder);

/// A text as a field of a table with commas.
std::string csv_field(const std::string& text);

/// A number as a field of a table; empty where it is not known.
std::string text_of_known(const std::optional<double>& number);

/// What is stored of all runs so far, by sample.
struct KeptResults {
    std::vector<SampleResult> results;               ///< without their peaks
    std::vector<std::filesystem::path> peaks_files;  ///< of each: where its peaks are; empty: it has no answer
};

/// Rows of all shards in a folder. Throws UserError when a file cannot be read, or belongs to another ensemble (what differs is
/// said). So it does for a run whose values name a file that has changed, and for more runs than there are samples.
KeptResults read_results(const std::filesystem::path& dir, const EnsemblePlan& plan, const EnsembleBase& base);

}  // namespace frana
