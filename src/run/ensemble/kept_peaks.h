#pragma once
// The peaks of an ensemble's runs, in the files that its shards left.
#include <filesystem>
#include <string>
#include <vector>

#include "ensemble/peak_source.h"

namespace frana {

/// Where the peaks of a run are.
struct KeptRun {
    Index sample = 0;
    std::filesystem::path file;
};

/// Reads a file at the first request for one of its runs, and forgets it after the last one. So it holds some 64 runs
/// for each process that ran the ensemble.
class KeptPeaks final : public PeakSource {
public:
    /// Reads all of the files once. Throws UserError when one of them cannot be read, lacks a run, or has other fields or
    /// another grid.
    KeptPeaks(std::vector<KeptRun> runs, std::vector<std::string> fields, const GridGeometry& grid);

    std::size_t runs() const override { return runs_.size(); }

    void for_each_run(const std::vector<std::size_t>& fields,
                      const std::function<void(std::size_t, const SparseRasters&)>& body) const override;

private:
    std::vector<KeptRun> runs_;
    std::vector<std::string> fields_;
    GridGeometry grid_;
};

}  // namespace frana
