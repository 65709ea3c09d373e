#include "run/ensemble/ensemble_run.h"

#include <fmt/core.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <utility>

#include "base/atomic_file.h"
#include "base/error.h"
#include "run/ensemble/kept_rows.h"
#include "run/ensemble/run_pool.h"
#include "run/folder/run_folder.h"
#include "run/folder/run_lock.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

/// Where the file of an ensemble is, for shards that join its runs later.
constexpr const char* kOrigin = "ensemble.path";

/// What an ensemble makes besides its shards: files, and folders of files. Its record comes first.
const std::vector<std::string>& names_made() {
    static const std::vector<std::string> names = {
        "ensemble.json",       "samples.csv", "runs.csv", "report.md", "maps.vti",
        "probability.geojson", "terrain.vti", "rasters",  "figures",   "states"};
    return names;
}

/// Shards of one ensemble would all write the same.
void write_once(const fs::path& file, const std::string& text) {
    if (text_in(file) != text) write_text(file, text);
}

}  // namespace

void require_room_for_ensemble(const fs::path& dir) {
    std::vector<std::string> names = names_made();
    names.emplace_back("run.json");  // that of a run
    require_no_others(dir, kOrigin, names, "an ensemble");
}

void remove_ensemble(const fs::path& dir) {
    for (const std::string& made : names_made()) fs::remove_all(dir / made);
    fs::remove_all(dir / "shards");
    fs::remove(dir / kOrigin);  // last: without it what is left would be taken for others'
}

fs::path origin_of_ensemble(const fs::path& dir) {
    std::ifstream stream(dir / kOrigin);
    std::string name;
    if (!std::getline(stream, name))
        throw UserError(
            fmt::format("{}: found no {}; expected the folder of an ensemble; name the folder, or the ensemble's "
                        "file before --join",
                        dir.string(), kOrigin));
    return name;
}

EnsembleRun::EnsembleRun(EnsemblePlan plan, fs::path dir)
    : plan_(std::move(plan)),
      dir_(std::move(dir)),
      reader_(files_),
      meshes_(meshes_in_turn()),
      base_(ensemble_base(plan_, reader_, meshes_)) {}

std::vector<std::string> EnsembleRun::remarks_beforehand() const {
    std::vector<std::string> remarks = base_.remarks;
    for (std::string& remark : remarks_of_sample(plan_, base_, 0, reader_, meshes_))
        remarks.push_back(std::move(remark));
    return remarks;
}

std::vector<Index> EnsembleRun::left_to_run(const Shard& shard, bool resume) const {
    require_room_for_ensemble(dir_);
    const fs::path rows = shard_folder(dir_, shard) / "runs.csv";
    if (fs::exists(rows) && !resume)
        throw UserError(
            fmt::format("{}: found the runs of an earlier ensemble; expected a folder without; choose another "
                        "one with --out, or give --resume to go on with it",
                        rows.string()));
    std::vector<bool> has(static_cast<std::size_t>(plan_.samples), false);
    for (const SampleResult& result : read_results(dir_, plan_, base_).results)
        has[static_cast<std::size_t>(result.sample)] = resume && result.reason != "refused";
    std::vector<Index> samples;
    for (Index i = shard.begin(plan_.samples); i < shard.end(plan_.samples); ++i)
        if (!has[static_cast<std::size_t>(i)]) samples.push_back(i);
    return samples;
}

void EnsembleRun::run(const Shard& shard, const std::vector<Index>& samples, int threads, const Interrupt& interrupt,
                      const std::function<void(bool)>& done) const {
    const fs::path folder = shard_folder(dir_, shard);
    const RunLock lock(folder);
    remove_leftovers(folder);
    write_once(dir_ / "samples.csv", samples_table(plan_));
    write_once(dir_ / kOrigin, fs::absolute(plan_.file).string() + "\n");
    ShardStore store(folder, plan_, base_);
    for_each_run(samples.size(), threads_for_runs(threads), interrupt, [&](std::size_t k) {
        auto result = run_sample(plan_, base_, samples[k], reader_, meshes_, interrupt);
        if (!result) return;
        const bool failed = !result->ended();
        store.add(std::move(*result));
        done(failed);
    });
    store.flush();
}

std::optional<SampleResult> EnsembleRun::try_out(Index sample, const Interrupt& interrupt) const {
    return run_sample(plan_, base_, sample, reader_, meshes_, interrupt);
}

EnsembleSummary EnsembleRun::join(std::optional<double> wall_seconds) const {
    require_room_for_ensemble(dir_);
    const RunLock lock(dir_);
    for (const char* folder : {"", "rasters", "figures"}) remove_leftovers(dir_ / folder);
    write_once(dir_ / "samples.csv", samples_table(plan_));
    return write_maps(dir_, plan_, base_, read_results(dir_, plan_, base_), wall_seconds);
}

Raster EnsembleRun::probability(const std::string& field, double threshold) const {
    return probability_map(dir_, plan_, base_, read_results(dir_, plan_, base_), field, threshold);
}

}  // namespace frana
