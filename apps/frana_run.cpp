#include <fmt/core.h>
#include <omp.h>

#include <iostream>
#include <optional>

#include "base/error.h"
#include "frana_commands.h"
#include "frana_progress_lines.h"
#include "run/folder/run_case.h"
#include "run/folder/run_job.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

void say_what_runs(const RunRecord& record, const fs::path& run_dir) {
    std::cout << fmt::format("{}: {} x {} nodes of {:.6g} m, {} particles, {:.6g} m3, {:.6g} s, {} thread{}; into {}\n",
                             record.title, record.grid.nx, record.grid.ny, record.grid.cell, record.particles,
                             record.release_volume, record.end, record.threads, record.threads == 1 ? "" : "s",
                             run_dir.string());
    for (const std::string& remark : record.warnings) std::cout << "  " << remark << '\n';
    std::cout << std::flush;
}

/// What people are told goes to the console only without --quiet and --progress json.
bool for_people(const RunOptions& options) { return !options.quiet && options.progress.empty(); }

void say_what_came(const RunRecord& record, const fs::path& run_dir, const RunOptions& options, ProgressLines& lines) {
    lines.result(record);
    if (for_people(options)) std::cout << closing_lines(record, run_dir) << std::flush;
}

Progress::Style style_of(const RunOptions& options) {
    return options.progress == "json" ? Progress::Style::json : Progress::fitting(options.quiet);
}

int run_case(const RunOptions& options, ProgressLines& lines) {
    if (options.threads > 0) omp_set_num_threads(options.threads);
    const CaseFile file = CaseFile::read(options.case_file, options.sets);
    RunWishes wishes{options.out, options.sets, options.until, options.resume, options.overwrite};
    wishes.say = [&](const std::string& line) {
        if (for_people(options)) std::cout << line << std::endl;
    };
    lines.into(options.out.empty() ? fs::path("out") / file.name() : options.out);
    CaseRun run(file, wishes);
    lines.scene(run.record());
    if (for_people(options)) say_what_runs(run.record(), run.folder());

    std::optional<Interrupt> own;
    if (!options.interrupt) own.emplace(Interrupt::Listen::signals);
    const Interrupt& interrupt = options.interrupt ? *options.interrupt : *own;
    Progress progress(std::cout, style_of(options), run.scene().density);
    const RunRecord record = run.carry_out(interrupt, progress);

    say_what_came(record, run.folder(), options, lines);
    if (record.summary.failure) std::rethrow_exception(record.summary.failure);
    if (record.pictures_cut_off) throw Interrupted(cutoff_sentence(run.folder()));
    return record.summary.reason == "interrupted" ? 130 : 0;
}

}  // namespace

int run_command(const RunOptions& options) {
    ProgressLines lines(options.progress, "run");
    return lines.around([&] { return run_case(options, lines); });
}

}  // namespace frana
