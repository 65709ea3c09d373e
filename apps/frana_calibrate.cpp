// `frana calibrate FILE`: what surveyed events tell of the keys of their cases.
#include "frana_calibrate.h"

#include <fmt/core.h>

#include <iostream>
#include <nlohmann/json.hpp>

#include "base/atomic_file.h"
#include "base/error.h"
#include "ensemble/wanted_maps.h"
#include "frana_calibrate_runs.h"
#include "frana_commands.h"
#include "frana_progress_lines.h"
#include "frana_run_teller.h"
#include "run/ensemble/kept_rows.h"
#include "run/ensemble/shard_store.h"
#include "run/folder/input_sums.h"
#include "run/folder/run_folder.h"
#include "run/folder/run_lock.h"
#include "scene/build_scene.h"
#include "scene/case_file.h"

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
            if (!run.ended() && found.failed == 0) found.first_failure = run.message.empty() ? run.reason : run.message;
            found.failed += !run.ended(), found.not_at_rest += run.still_moves;
            found.seconds += run.seconds;
            found.fits[e].scores.push_back(run.scores);
            found.fits[e].log_likelihood.push_back(log_likelihood(run.scores, event.objective, event.errors));
            all[k] += event.weight * found.fits[e].log_likelihood.back();
        }
    }
    return all;
}

/// False when an end was requested.
bool run_rounds(const EventRuns& runs, KeptRuns& kept, const CalibrateOptions& options, Calibration& found) {
    const CalibrationPlan& plan = found.plan;
    RunTeller teller(static_cast<std::size_t>(plan.samples * plan.rounds) * plan.events.size(), options.quiet,
                     options.progress);
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

/// Files that no calibration has left are not taken for one's own, nor removed. One that has begun has a folder `kept`.
void require_room(const fs::path& dir) {
    if (fs::exists(dir / "calibrate.json")) return;
    require_no_others(
        dir, "kept", {"runs.csv", "posterior.csv", "posterior.png", "report.md", "run.json", "predict.toml", "predict"},
        "a calibration");
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

/// Removes what was predicted by another posterior, or of another case: first the record, which says that all is there.
void forget_prediction(const fs::path& dir) {
    const fs::path predict = dir / "predict";
    fs::remove(predict / "ensemble.json");
    for (const char* made :
         {"shards", "rasters", "figures", "states", "samples.csv", "runs.csv", "report.md", "maps.vti", "terrain.vti"})
        fs::remove_all(predict / made);
    std::vector<fs::path> outlines;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(predict, none))
        if (entry.path().filename().string().rfind("reached_by_", 0) == 0) outlines.push_back(entry.path());
    for (const fs::path& file : outlines) fs::remove(file);
    fs::remove(predict / "ensemble.path");  // last: without it what is left would be taken for others'
}

/// Removes an earlier calibration. Its record goes first: without it nothing takes the rest for whole.
void forget_calibration(const fs::path& dir) {
    fs::remove(dir / "calibrate.json");
    KeptRuns::remove(dir);
    forget_prediction(dir);
}

/// Runs what is left, and writes what is found.
Calibration calibrate(const CalibrateOptions& options, const CalibrationPlan& plan) {
    Calibration found{plan, Posterior(static_cast<Index>(plan.vary.size()), plan.seed),
                      std::vector<EventFit>(plan.events.size())};
    const Interrupt interrupt(Interrupt::Listen::signals);
    const EventRuns runs(plan, options.threads, interrupt);
    const RunLock lock(options.out);
    remove_leftovers(options.out);
    if (options.overwrite) forget_calibration(options.out);
    KeptRuns kept(options.out, plan);
    if (!run_rounds(runs, kept, options, found)) throw cut_off(options.out);
    if (plan.search && found.posterior.any()) {
        found.optimum = search_optimum(runs, kept, found);
        if (!found.optimum) throw cut_off(options.out);
    }
    forget_prediction(options.out);
    fs::remove(options.out / "calibrate.json");  // the record of another plan would take these files for its own
    found.files = write_calibration(options.out, found);
    return found;
}

void say(const CalibrateOptions& options, const Calibration& found) {
    if (options.quiet || !options.progress.empty()) return;
    std::cout << calibration_section(found);
    for (const std::string& file : found.files) std::cout << (options.out / file).string() << '\n';
}

/// Another event's case must take the keys that vary, which is better known before all the runs than after.
void try_prediction(const CalibrationPlan& plan) {
    if (!plan.predict) return;
    std::vector<std::string> middle;
    for (const Vary& vary : plan.vary) middle.push_back(vary.key + "=" + vary.distribution.text(0.5));
    const GdalReader reader;
    const Scene scene = build_scene(CaseFile::read(plan.predict->case_file, middle), reader, meshes_in_turn());
    require_kept_thresholds(*plan.predict, scene.output.footprint_depth, "predict");
}

/// predict.toml: the ensemble, and a mark of its case and the files that this names. The mark tells whether they have
/// changed.
std::string text_of_prediction(const EnsemblePlan& maps) {
    return fmt::format("# case and files {:016x}\n", sum_of(mark_of_inputs(CaseFile::read(maps.case_file)))) +
           ensemble_of_table(maps, "posterior.csv");
}

/// Maps of another event, by what the surveys tell: an ensemble of posterior.csv in a folder of its own.
int predict(const CalibrateOptions& options, const EnsemblePlan& maps) {
    const fs::path file = options.out / "predict.toml";
    const std::string text = text_of_prediction(maps);
    const RunLock lock(options.out);
    if (text_in(file) != text) {
        forget_prediction(options.out);
        write_text(file, text);
    }
    EnsembleOptions ensemble;
    ensemble.file = file, ensemble.out = options.out / "predict";
    ensemble.threads = options.threads, ensemble.quiet = options.quiet || !options.progress.empty();
    ensemble.resume = true;
    return ensemble_command(ensemble);
}

/// The maps are there, of the same case, and no calibration was run since.
bool predicted(const fs::path& dir, const EnsemblePlan& maps) {
    return fs::exists(dir / "predict" / "ensemble.json") && text_in(dir / "predict.toml") == text_of_prediction(maps);
}

int run_calibration(const CalibrateOptions& options) {
    const CalibrationPlan plan = read_calibration(options.file);
    require_room(options.out);
    const bool calibrated = !something_to_do(options, plan);
    if (calibrated && (!plan.predict || predicted(options.out, *plan.predict))) {
        if (!options.quiet && options.progress.empty())
            std::cout << fmt::format("{}: all is there\n", options.out.string());
        return 0;
    }
    try_prediction(plan);
    if (!calibrated) say(options, calibrate(options, plan));
    return plan.predict ? predict(options, *plan.predict) : 0;
}

}  // namespace

int calibrate_command(const CalibrateOptions& options) {
    ProgressLines lines(options.progress, "calibrate");
    lines.into(options.out);
    return lines.around([&] { return run_calibration(options); });
}

}  // namespace frana
