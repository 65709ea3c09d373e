// `frana ensemble FILE`: many runs of one case, on all threads, and what they say together.
#include <fmt/core.h>
#include <omp.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <iostream>
#include <mutex>
#include <optional>
#include <thread>

#include "base/atomic_file.h"
#include "base/error.h"
#include "frana_commands.h"
#include "frana_ensemble_folder.h"
#include "frana_ensemble_maps.h"
#include "io/gdal_reader.h"
#include "run/folder/run_lock.h"
#include "run/interrupt.h"
#include "scene/case_file.h"
#include "scene/shared_reader.h"
#include "vtk_io/barrier_mesh.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// One run on each thread, until there are none left.
class Pool {
public:
    Pool(const EnsemblePlan& plan, const EnsembleBase& base, const GisReader& reader, const MeshReader& meshes,
         const Interrupt& interrupt, bool quiet)
        : plan_(plan), base_(base), reader_(reader), meshes_(meshes), interrupt_(interrupt), quiet_(quiet) {}

    void run(const std::vector<Index>& samples, int threads, ShardStore& store) {
        std::vector<std::thread> pool;
        for (int t = 0; t < threads; ++t) pool.emplace_back([&] { work(samples, store); });
        for (std::thread& thread : pool) thread.join();
        store.flush();
        if (failure_) std::rethrow_exception(failure_);
    }

private:
    void work(const std::vector<Index>& samples, ShardStore& store) {
        omp_set_num_threads(1);  // of this thread alone
        try {
            for (std::size_t k = next_++; k < samples.size() && !stop_ && !interrupt_.requested(); k = next_++) {
                auto result = run_sample(plan_, base_, samples[k], reader_, meshes_, interrupt_);
                if (!result) return;
                const bool failed = !result->ended();
                store.add(std::move(*result));
                tell(failed, samples.size());
            }
        } catch (...) {  // goes on in the thread that waits for this one
            const std::lock_guard<std::mutex> alone(mutex_);
            if (!failure_) failure_ = std::current_exception();
            stop_ = true;
        }
    }

    void tell(bool failed, std::size_t of) {
        const std::lock_guard<std::mutex> alone(mutex_);
        ++done_, failed_ += failed;
        constexpr double every = 5.0;  // [s]
        const double now = seconds_since(start_);
        if (quiet_ || (now - told_ < every && done_ < of)) return;
        told_ = now;
        const double left = now * static_cast<double>(of - done_) / static_cast<double>(done_);
        std::cout << fmt::format("{} of {} runs, {} failed, {:.0f} s, {:.0f} s left\n", done_, of, failed_, now, left)
                  << std::flush;
    }

    const EnsemblePlan& plan_;
    const EnsembleBase& base_;
    const GisReader& reader_;
    const MeshReader& meshes_;
    const Interrupt& interrupt_;
    const bool quiet_;
    std::atomic<std::size_t> next_{0};
    std::atomic<bool> stop_{false};
    std::mutex mutex_;
    std::exception_ptr failure_;
    std::size_t done_ = 0, failed_ = 0;
    Clock::time_point start_ = Clock::now();
    double told_ = 0.0;
};

/// Barrier meshes are read by VTK, one at a time.
MeshReader meshes_in_turn() {
    return [mutex = std::make_shared<std::mutex>()](const fs::path& file, const MeshSampling& sampling) {
        const std::lock_guard<std::mutex> alone(*mutex);
        return barrier_mesh_of(file, sampling);
    };
}

/// Those of the shard that no shard in the folder has run.
std::vector<Index> left_to_run(const EnsembleOptions& options, const EnsemblePlan& plan, const Shard& shard) {
    const fs::path rows = shard_folder(options.out, shard) / "runs.csv";
    if (fs::exists(rows) && !options.resume)
        throw UserError(
            fmt::format("{}: found the runs of an earlier ensemble; expected a folder without; choose another "
                        "one with --out, or give --resume to go on with it",
                        rows.string()));
    std::vector<bool> has(static_cast<std::size_t>(plan.samples), false);
    if (options.resume)
        for (const SampleResult& result : read_results(options.out, plan, false))
            has[static_cast<std::size_t>(result.sample)] = true;
    std::vector<Index> samples;
    for (Index i = shard.begin(plan.samples); i < shard.end(plan.samples); ++i)
        if (!has[static_cast<std::size_t>(i)]) samples.push_back(i);
    return samples;
}

int threads_of(const EnsembleOptions& options) { return options.threads > 0 ? options.threads : omp_get_max_threads(); }

void say_result(const fs::path& dir, const EnsembleSummary& summary) {
    std::cout << runs_sentence(summary) << '\n';
    for (const std::string& file : summary.files) std::cout << (dir / file).string() << '\n';
}

/// The maps of all runs in the folder.
int join(const EnsembleOptions& options, const EnsemblePlan& plan, const EnsembleBase& base,
         std::optional<double> wall_seconds) {
    const RunLock lock(options.out);
    for (const char* folder : {"", "rasters", "figures"}) remove_leftovers(options.out / folder);
    write_samples(options.out, plan);
    const EnsembleSummary summary =
        write_maps(options.out, plan, base, read_results(options.out, plan, true), wall_seconds);
    if (!options.quiet) say_result(options.out, summary);
    if (!summary.too_many_failed()) return 0;
    std::cerr << fmt::format(
        "{} of {} runs failed, more than 5 %: the maps should not be trusted; the reasons are in {}\n", summary.failed,
        summary.run, (options.out / "runs.csv").string());
    return 3;
}

/// What the first samples are, and what all would take, from two of them.
int foretell(const EnsemblePlan& plan, const EnsembleBase& base, const GisReader& reader, const MeshReader& meshes,
             const EnsembleOptions& options) {
    std::cout << fmt::format("{}: {} samples by \"{}\", seed {}\n", plan.file.string(), plan.samples, plan.method_name,
                             plan.seed);
    constexpr Index shown = 5;
    for (Index i = 0; i < std::min(shown, plan.samples); ++i) {
        std::cout << fmt::format("  {}:", i);
        for (const std::string& set : plan.sets_of(i)) std::cout << "  " << set;
        std::cout << '\n';
    }
    double seconds = 0.0, bytes = 0.0;
    const std::vector<Index> pilots = {0, plan.samples / 2};
    const Interrupt never;
    for (const Index sample : pilots) {
        const auto result = run_sample(plan, base, sample, reader, meshes, never);
        std::cout << fmt::format("  sample {} ran: {} after {:g} s simulated, {:.3g} s{}{}\n", sample, result->reason,
                                 result->time, result->seconds, result->message.empty() ? "" : ": ", result->message);
        seconds += result->seconds / static_cast<double>(pilots.size());
        bytes += 4.0 * static_cast<double>(result->peaks.pixels()) * static_cast<double>(plan.fields.size());
    }
    const double count = static_cast<double>(plan.samples);
    std::cout << fmt::format("about {:.3g} core seconds, {:.3g} s on {} threads; at most {:.3g} MB on disk\n",
                             seconds * count, seconds * count / threads_of(options), threads_of(options),
                             0.5e-6 * bytes * count);
    return 0;
}

/// A sample as a case of its own.
int run_again(const EnsembleOptions& options, const EnsemblePlan& plan) {
    const Index sample = *options.again;
    if (sample < 0 || sample >= plan.samples)
        throw UserError(fmt::format("--again: found {}; expected a sample from 0 to {}; see samples.csv", sample,
                                    plan.samples - 1));
    const fs::path folder = options.out / fmt::format("sample_{}", sample);
    fs::create_directories(folder);
    write_text(folder / "case.toml", resolved_toml(CaseFile::read(plan.case_file, plan.sets_of(sample))));
    std::cout << fmt::format("frana run {} --out {}\n", (folder / "case.toml").string(), (folder / "run").string());
    return 0;
}

/// A job array for Slurm: a shard a job, then the maps.
int print_job(const EnsembleOptions& options) {
    const std::string file = fs::absolute(options.file).string(), out = fs::absolute(options.out).string();
    std::cout << fmt::format(
        "#!/bin/sh\n#SBATCH --array=0-{0} --cpus-per-task=8 --signal=B:TERM@120 --requeue\n"
        "# afterwards: sbatch --dependency=afterany:JOB --wrap \"frana ensemble '{1}' --join '{2}'\"\n"
        "exec frana ensemble '{1}' --out '{2}' --shard \"$SLURM_ARRAY_TASK_ID/{3}\" \\\n"
        "     --threads \"$SLURM_CPUS_PER_TASK\" --resume\n",
        options.slurm - 1, file, out, options.slurm);
    return 0;
}

/// Where the file of an ensemble is, for who joins its runs later.
constexpr const char* kOrigin = "ensemble.path";

fs::path origin_of(const fs::path& dir) {
    std::ifstream stream(dir / kOrigin);
    std::string name;
    if (!std::getline(stream, name))
        throw UserError(
            fmt::format("{}: found no {}; expected the folder of an ensemble; name the folder, or the ensemble's "
                        "file before --join",
                        dir.string(), kOrigin));
    return name;
}

void require_names(const EnsembleOptions& options) {
    if (options.join.empty() && options.file.empty())
        throw UserError("FILE: found none; expected the ensemble's file; see apps/README.md for an example");
    if (options.join.empty() && options.out.empty())
        throw UserError("--out: found none; expected a folder for the runs and maps; name one");
}

int run_shard(const EnsembleOptions& options, const EnsemblePlan& plan, const EnsembleBase& base,
              const GisReader& reader, const MeshReader& meshes) {
    const auto start = Clock::now();
    const Shard shard = options.shard.empty() ? Shard{} : read_shard(options.shard);
    const fs::path folder = shard_folder(options.out, shard);
    const std::vector<Index> samples = left_to_run(options, plan, shard);
    const RunLock lock(folder);
    remove_leftovers(folder);
    write_samples(options.out, plan);
    write_text(options.out / kOrigin, fs::absolute(plan.file).string() + "\n");
    const Interrupt interrupt(Interrupt::Listen::signals);
    ShardStore store(folder, plan, base);
    Pool(plan, base, reader, meshes, interrupt, options.quiet).run(samples, threads_of(options), store);
    if (interrupt.requested())
        throw Interrupted(fmt::format("interrupted; what has run is in {}; --resume goes on", folder.string()));
    return options.shard.empty() ? join(options, plan, base, seconds_since(start)) : 0;
}

}  // namespace

int ensemble_command(const EnsembleOptions& given) {
    EnsembleOptions options = given;
    require_names(options);
    if (!options.join.empty()) options.out = options.join;
    if (options.file.empty()) options.file = origin_of(options.join);
    EnsemblePlan plan = read_ensemble(options.file);
    for (const std::string& wish : options.exceed) add_exceedance(plan, wish);
    if (options.slurm > 0) return print_job(options);
    if (options.again) return run_again(options, plan);
    const GdalReader files;
    const SharedReader reader(files);
    const MeshReader meshes = meshes_in_turn();
    const EnsembleBase base = ensemble_base(plan, reader, meshes);
    if (options.check) return foretell(plan, base, reader, meshes, options);
    if (!options.join.empty()) return join(options, plan, base, std::nullopt);
    return run_shard(options, plan, base, reader, meshes);
}

}  // namespace frana
