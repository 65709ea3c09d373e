#include "run/ensemble/kept_peaks.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <utility>

#include "base/error.h"
#include "io/hdf5_peaks.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

void require_same(const fs::path& file, const PeakBlock& block, const std::vector<std::string>& fields,
                  const GridGeometry& grid) {
    if (!(block.grid == grid))
        throw UserError(
            fmt::format("{}: found runs on {} x {} nodes of {:g} m; expected the case's {} x {} nodes of {:g} m; give "
                        "the elevation model back that these runs were made with",
                        file.string(), block.grid.nx, block.grid.ny, block.grid.cell, grid.nx, grid.ny, grid.cell));
    if (block.fields != fields)
        throw UserError(
            fmt::format("{}: found other fields than ensemble.fields names; expected the same; run the "
                        "ensemble into another folder",
                        file.string()));
}

/// The place of a run in its file.
std::size_t place_of(const KeptRun& run, const PeakBlock& block) {
    const auto found = std::find(block.samples.begin(), block.samples.end(), run.sample);
    if (found == block.samples.end())
        throw UserError(fmt::format(
            "{}: found no run {}, which the runs.csv of its folder names; expected each run with an answer; "
            "remove the folder of this file and run it again",
            run.file.string(), run.sample));
    return static_cast<std::size_t>(found - block.samples.begin());
}

/// A file whose runs are being read.
struct OpenFile {
    PeakBlock block;
    std::size_t left = 0;  ///< runs still to come
};

}  // namespace

KeptPeaks::KeptPeaks(std::vector<KeptRun> runs, std::vector<std::string> fields, const GridGeometry& grid)
    : runs_(std::move(runs)), fields_(std::move(fields)), grid_(grid) {
    std::vector<std::size_t> all;
    for (std::size_t f = 0; f < fields_.size(); ++f) all.push_back(f);
    for_each_run(all, [](std::size_t, const SparseRasters&) {});
}

void KeptPeaks::for_each_run(const std::vector<std::size_t>& fields,
                             const std::function<void(std::size_t, const SparseRasters&)>& body) const {
    std::vector<std::string> names;
    names.reserve(fields.size());
    for (const std::size_t f : fields) names.push_back(fields_.at(f));
    std::map<fs::path, std::size_t> count;
    for (const KeptRun& run : runs_) ++count[run.file];
    std::map<fs::path, OpenFile> open;
    for (std::size_t k = 0; k < runs_.size(); ++k) {
        const KeptRun& run = runs_[k];
        auto found = open.find(run.file);
        if (found == open.end()) {
            found = open.emplace(run.file, OpenFile{read_peaks(run.file, names), count[run.file]}).first;
            require_same(run.file, found->second.block, fields_, grid_);
        }
        body(k, found->second.block.peaks[place_of(run, found->second.block)]);
        if (--found->second.left == 0) open.erase(found);
    }
}

}  // namespace frana
