// `frana ensemble FILE`: many runs of one case, on all threads, and what they say together.
#include <fmt/core.h>

#include <algorithm>
#include <iostream>
#include <optional>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/shell_word.h"
#include "frana_commands.h"
#include "frana_progress_lines.h"
#include "frana_run_teller.h"
#include "run/ensemble/ensemble_run.h"
#include "run/ensemble/kept_rows.h"
#include "run/ensemble/run_pool.h"
#include "run/interrupt.h"
#include "scene/case_file.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

void say_result(const fs::path& dir, const EnsembleSummary& summary) {
    std::cout << runs_sentence(summary) << '\n';
    for (const std::string& remark : summary.remarks.sentences(summary.run))
        std::cout << "remark      " << remark << '\n';
    for (const std::string& file : summary.files) std::cout << (dir / file).string() << '\n';
}

/// As `frana check` has them.
void say_remarks(const EnsembleRun& ensemble) {
    for (const std::string& remark : ensemble.remarks_beforehand()) std::cout << "remark      " << remark << '\n';
}

/// The maps of all runs in the folder.
int join(const EnsembleOptions& options, const EnsembleRun& ensemble, std::optional<double> wall_seconds) {
    const EnsembleSummary summary = ensemble.join(wall_seconds);
    if (!options.quiet && options.progress.empty()) say_result(options.out, summary);
    if (!summary.too_many_failed()) return 0;
    std::cerr << fmt::format(
        "{} of {} runs failed, more than 5 % of the weight: the maps should not be trusted; the first one so: {}; the "
        "reasons are in {}\n",
        summary.failed, summary.run, summary.first_failure, (options.out / "runs.csv").string());
    return 3;
}

/// What the first samples are, and what all would take, from two of them.
int foretell(const EnsembleRun& ensemble, const EnsembleOptions& options) {
    const EnsemblePlan& plan = ensemble.plan();
    std::cout << fmt::format("{}: {} samples by \"{}\", seed {}\n", plan.file.string(), plan.samples, plan.method_name,
                             plan.seed);
    say_remarks(ensemble);
    constexpr Index shown = 5;
    for (Index i = 0; i < std::min(shown, plan.samples); ++i) {
        std::cout << fmt::format("  {}:", i);
        for (const std::string& set : plan.sets_of(i)) std::cout << "  " << set;
        std::cout << '\n';
    }
    double seconds = 0.0, bytes = 0.0;
    const std::vector<Index> pilots = {0, plan.samples / 2};
    const Interrupt never;
    std::vector<std::optional<SampleResult>> results(pilots.size());
    for_each_run(pilots.size(), 1, never, [&](std::size_t k) { results[k] = ensemble.try_out(pilots[k], never); });
    for (const auto& result : results) {
        std::cout << fmt::format("  sample {} ran: {} after {:g} s simulated, {:.3g} s{}{}\n", result->sample,
                                 result->reason, result->time, result->seconds, result->message.empty() ? "" : ": ",
                                 result->message);
        seconds += result->seconds / static_cast<double>(pilots.size());
        bytes += 4.0 * static_cast<double>(result->peaks.pixels()) * static_cast<double>(plan.fields.size());
    }
    const double count = static_cast<double>(plan.samples);
    std::cout << fmt::format(
        "about {:.3g} core seconds, {:.3g} s on {} threads; at most {:.3g} MB of peaks on disk, maps and "
        "figures come on top\n",
        seconds * count, seconds * count / threads_for_runs(options.threads), threads_for_runs(options.threads),
        0.5e-6 * bytes * count);
    return 0;
}

/// A sample as a case of its own.
int run_again(const EnsembleOptions& options, const EnsemblePlan& plan) {
    const Index sample = *options.again;
    if (sample < 0 || sample >= plan.samples)
        throw UserError(fmt::format("--again: found {}; expected a sample from 0 to {}; see samples.csv", sample,
                                    plan.samples - 1));
    const fs::path folder = options.out / fmt::format("sample_{}", sample), file = folder / "case.toml";
    const std::string text = resolved_toml(CaseFile::read(plan.case_file, plan.sets_of(sample)));
    if (!has_runs_of(options.out, plan) && fs::exists(file) && text_in(file) != text)
        throw UserError(
            fmt::format("{}: found another case there, and no runs of this ensemble beside it; expected none, or that "
                        "of sample {}; choose another folder with --out, or move it away",
                        file.string(), sample));
    fs::create_directories(folder);
    write_text(file, text);
    std::cout << fmt::format("frana run {} --out {}\n", shell_word(file.string()),
                             shell_word((folder / "run").string()));
    return 0;
}

/// A job array for Slurm: a shard a job, then the maps.
int print_job(const EnsembleOptions& options) {
    const std::string file = shell_word(fs::absolute(options.file).string()),
                      out = shell_word(fs::absolute(options.out).string());
    std::cout << fmt::format(
        "#!/bin/sh\n#SBATCH --array=0-{0} --cpus-per-task=8 --signal=B:TERM@120 --requeue\n"
        "# afterwards: sbatch --dependency=afterany:JOB --wrap {4}\n"
        "exec frana ensemble {1} --out {2} --shard \"$SLURM_ARRAY_TASK_ID/{3}\" \\\n"
        "     --threads \"$SLURM_CPUS_PER_TASK\" --resume\n",
        options.slurm - 1, file, out, options.slurm, shell_word(fmt::format("frana ensemble {} --join {}", file, out)));
    return 0;
}

void require_names(const EnsembleOptions& options) {
    if (options.join.empty() && options.file.empty())
        throw UserError("FILE: found none; expected the ensemble's file; see apps/README.md for an example");
    if (!options.join.empty() && !options.shard.empty())
        throw UserError("--shard: found it beside --join; expected one of both; all shards in the folder are joined");
    if (options.join.empty() && options.out.empty())
        throw UserError("--out: found none; expected a folder for the runs and maps; name one");
}

int run_shard(const EnsembleOptions& options, const EnsembleRun& ensemble) {
    const auto start = Clock::now();
    const Shard shard = options.shard.empty() ? Shard{} : read_shard(options.shard);
    const std::vector<Index> samples = ensemble.left_to_run(shard, options.resume);
    if (!options.quiet && options.progress.empty()) say_remarks(ensemble);
    const Interrupt interrupt(Interrupt::Listen::signals);
    RunTeller teller(samples.size(), options.quiet, options.progress);
    ensemble.run(shard, samples, options.threads, interrupt, [&](bool failed) { teller.done(failed); });
    if (interrupt.requested())
        throw Interrupted(fmt::format("interrupted; what has run is in {}; --resume goes on",
                                      shard_folder(options.out, shard).string()));
    return options.shard.empty() ? join(options, ensemble, seconds_since(start)) : 0;
}

int run_ensemble(EnsembleOptions options, ProgressLines& lines) {
    require_names(options);
    if (!options.join.empty()) options.out = options.join;
    if (options.file.empty()) options.file = origin_of_ensemble(options.join);
    if (!options.out.empty()) lines.into(options.out);
    EnsemblePlan plan = read_ensemble(options.file);
    for (const std::string& wish : options.exceed) add_exceedance(plan, wish);
    if (options.slurm > 0) return print_job(options);
    for (const Vary& vary : plan.vary)
        if (!vary.prior.empty()) std::cerr << vary.prior << '\n';
    if (options.again) return run_again(options, plan);
    const EnsembleRun ensemble(std::move(plan), options.out);
    if (options.check) return foretell(ensemble, options);
    if (!options.join.empty()) return join(options, ensemble, std::nullopt);
    return run_shard(options, ensemble);
}

}  // namespace

int ensemble_command(const EnsembleOptions& options) {
    ProgressLines lines(options.progress, "ensemble");
    return lines.around([&] { return run_ensemble(options, lines); });
}

}  // namespace frana
