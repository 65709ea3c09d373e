// `frana calibrate FILE`: what surveyed events tell of the keys of their cases.
#include "frana_calibrate.h"

#include <fmt/core.h>

#include <iostream>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "frana_calibrate_runs.h"
#include "frana_commands.h"
#include "frana_ensemble_folder.h"
#include "frana_kept_rows.h"
#include "run/folder/run_lock.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

/// Notes how near the runs came; returns the likelihood of each point, of all events.
std::vector<double> take(const std::vector<std::vector<EventRun>>& runs, Calibration& found) {
    std::vector<double> all(runs.front().size(), 0.0);
    for (std::size_t e = 0; e < runs.size(); ++e) {
        const SurveyedEvent& event = found.plan.events[e];
        for (std::size_t k = 0; k < all.size(); ++k) {
            const EventRun& run = runs[e][k];
            found.failed += !run.ended();
            found.seconds += run.seconds;
            found.fits[e].scores.push_back(run.scores);
            found.fits[e].log_likelihood.push_back(log_likelihood(run.scores, event.objective, event.errors));
            all[k] += event.weight * found.fits[e].log_likelihood.back();
        }
    }
    return all;
}

/// False when an end was asked for.
bool run_rounds(const EventRuns& runs, KeptRuns& kept, bool quiet, Calibration& found) {
    const CalibrationPlan& plan = found.plan;
    RunTeller teller(static_cast<std::size_t>(plan.samples * plan.rounds) * plan.events.size(), quiet);
    for (Index round = 0; round < plan.rounds; ++round) {
        const auto points = found.posterior.next(plan.samples);
        const auto results = runs.at(points, kept, [&](const EventRun& run) { teller.done(!run.ended()); });
        if (!results) return false;
        found.posterior.add(points, take(*results, found));
    }
    return true;
}

/// The mark of the calibration that a folder has the result of; empty without one.
std::string finished_mark(const fs::path& dir) {
    const auto json = nlohmann::json::parse(text_in(dir / "calibrate.json"), nullptr, false);
    return json.is_object() ? json.value("mark", "") : "";
}

/// False when all is there already.
bool something_to_do(const CalibrateOptions& options, const CalibrationPlan& plan) {
    const fs::path record = options.out / "calibrate.json";
    if (options.overwrite) return true;
    if (options.resume) return finished_mark(options.out) != mark_of(plan);
    if (fs::exists(record) || KeptRuns::are_in(options.out))
        throw UserError(
            fmt::format("{}: found an earlier calibration; expected a folder without; choose another one with "
                        "--out, give --resume to go on with it, or --overwrite",
                        (fs::exists(record) ? record : options.out).string()));
    return true;
}

Interrupted cut_off(const fs::path& dir) {
    return Interrupted(fmt::format("interrupted; what has run is in {}; --resume goes on", dir.string()));
}

/// Runs what is left, and writes what is found.
Calibration calibrate(const CalibrateOptions& options, const CalibrationPlan& plan) {
    Calibration found{plan, Posterior(static_cast<Index>(plan.vary.size()), plan.seed),
                      std::vector<EventFit>(plan.events.size()), 0, 0.0};
    const Interrupt interrupt(Interrupt::Listen::signals);
    const EventRuns runs(plan, options.threads, interrupt);
    const RunLock lock(options.out);
    remove_leftovers(options.out);
    if (options.overwrite) KeptRuns::remove(options.out);
    KeptRuns kept(options.out, plan);
    if (!run_rounds(runs, kept, options.quiet, found)) throw cut_off(options.out);
    if (plan.search && found.posterior.any()) {
        found.optimum = search_optimum(runs, kept, found);
        if (!found.optimum) throw cut_off(options.out);
    }
    found.files = write_calibration(options.out, found);
    return found;
}

}  // namespace

int calibrate_command(const CalibrateOptions& options) {
    const CalibrationPlan plan = read_calibration(options.file);
    if (!something_to_do(options, plan)) {
        if (!options.quiet) std::cout << fmt::format("{}: all is there\n", options.out.string());
        return 0;
    }
    const Calibration found = calibrate(options, plan);
    if (!options.quiet) {
        std::cout << calibration_section(found);
        for (const std::string& file : found.files) std::cout << (options.out / file).string() << '\n';
    }
    return 0;
}

}  // namespace frana
