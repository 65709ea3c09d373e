#include "run/calibrate/calibration_run.h"

#include <fmt/core.h>

#include <utility>

#include "base/error.h"
#include "ensemble/sample_run.h"
#include "observe/left_terrain.h"
#include "run/calibrate/predict_folder.h"
#include "run/calibrate/results.h"
#include "run/calibrate/search.h"
#include "run/ensemble/shard_store.h"
#include "run/folder/record_file.h"
#include "run/folder/run_folder.h"
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
            if (!run.ended() && found.failed == 0) found.first_failure = run.message.empty() ? run.reason : run.message;
            found.failed += !run.ended(), found.not_at_rest += run.still_moves;
            found.seconds += run.seconds;
            found.left_terrain += run.ended() && run.left_share > kNoticeablyLeft;
            found.fits[e].left_share.push_back(run.left_share);
            found.fits[e].remarks.add(static_cast<Index>(found.fits[e].scores.size()), run.remarks);
            found.fits[e].scores.push_back(run.scores);
            found.fits[e].log_likelihood.push_back(log_likelihood(run.scores, event.objective, event.errors));
            all[k] += event.weight * found.fits[e].log_likelihood.back();
        }
    }
    return all;
}

/// The mark of the calibration that a folder has the result of; empty without one.
std::string finished_mark(const fs::path& dir) {
    const auto json = json_in(dir / "calibrate.json");
    return json.is_object() ? json.value("mark", "") : "";
}

/// Files that no calibration has left are not taken for one's own, nor removed. One that has begun has a folder `kept`.
void require_room(const fs::path& dir) {
    if (fs::exists(dir / "calibrate.json")) return;
    require_no_others(
        dir, "kept", {"runs.csv", "posterior.csv", "posterior.png", "report.md", "run.json", "predict.toml", "predict"},
        "a calibration");
}

/// Whether runs are left, or may be. Throws UserError where an earlier calibration lies that is to stay.
bool runs_are_left(const fs::path& dir, const CalibrationPlan& plan, bool resume, bool overwrite) {
    const fs::path record = dir / "calibrate.json";
    if (overwrite) return true;
    if (resume) return finished_mark(dir) != mark_of(plan);
    if (fs::exists(record) || KeptRuns::are_in(dir))
        throw UserError(
            fmt::format("{}: found an earlier calibration; expected a folder without; choose another one with "
                        "--out, give --resume to go on with it, or --overwrite",
                        (fs::exists(record) ? record : dir).string()));
    return true;
}

/// Removes an earlier calibration. Its record goes first: without it nothing takes the rest for whole.
void forget_calibration(const fs::path& dir) {
    fs::remove(dir / "calibrate.json");
    KeptRuns::remove(dir);
    forget_prediction(dir);
}

}  // namespace

CalibrationWork left_to_calibrate(const fs::path& dir, const CalibrationPlan& plan, bool resume, bool overwrite) {
    require_room(dir);
    CalibrationWork work;
    work.runs = runs_are_left(dir, plan, resume, overwrite);
    work.maps = plan.predict && (work.runs || !is_predicted(dir, *plan.predict));
    if (work.any()) try_prediction(plan);
    return work;
}

CalibrationRun::CalibrationRun(const CalibrationPlan& plan, fs::path dir, int threads, const Interrupt& interrupt)
    : plan_(plan), dir_(std::move(dir)), runs_(plan, threads, interrupt) {}

std::size_t CalibrationRun::runs() const {
    return static_cast<std::size_t>(plan_.samples * plan_.rounds) * plan_.events.size();
}

Calibration CalibrationRun::carry_out(bool overwrite, const std::function<void(bool failed)>& done) const {
    Calibration found{plan_, Posterior(static_cast<Index>(plan_.vary.size()), plan_.seed),
                      std::vector<EventFit>(plan_.events.size())};
    for (const SurveyedEvent& event : plan_.events)
        for (const std::string& remark : remarks_on_zones(event.runs, CaseFile::read(event.runs.case_file)))
            found.remarks.push_back(fmt::format("{}: {}", event.name, remark));
    const auto cut_off = [&] {
        return Interrupted(fmt::format("interrupted; what has run is in {}; --resume goes on", dir_.string()));
    };
    const RunLock lock(dir_);
    remove_leftovers(dir_);
    if (overwrite) forget_calibration(dir_);
    KeptRuns kept(dir_, plan_);
    for (Index round = 0; round < plan_.rounds; ++round) {
        const auto points = found.posterior.next(plan_.samples);
        const auto results = runs_.at(points, kept, [&](const EventRun& run) { done(!run.ended()); });
        if (!results) throw cut_off();
        found.posterior.add(points, take(*results, found));
    }
    if (plan_.search && found.posterior.any()) {
        found.optimum =
            search_optimum(found, [&](const auto& points) { return runs_.at(points, kept, [](const EventRun&) {}); });
        if (!found.optimum) throw cut_off();
    }
    forget_prediction(dir_);
    fs::remove(dir_ / "calibrate.json");  // the record of another plan would take these files for its own
    found.files = write_calibration(dir_, found);
    return found;
}

}  // namespace frana
