// `frana calibrate FILE`: what surveyed events tell of the keys of their cases.
#include "frana_calibrate.h"

#include <fmt/core.h>

#include <cmath>
#include <iostream>
#include <limits>

#include "base/error.h"
#include "ensemble/sample_run.h"
#include "frana_commands.h"
#include "io/gdal_reader.h"
#include "run/folder/run_lock.h"
#include "run_pool.h"
#include "scene/shared_reader.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

double perimeter_of(const Rings& rings) {
    double sum = 0.0;
    for (const auto& ring : rings)
        for (std::size_t k = 0; k < ring.size(); ++k) sum += (ring[(k + 1) % ring.size()] - ring[k]).norm();
    return sum;
}

/// Runs rounds of all events, and weighs them.
class Rounds {
public:
    Rounds(Calibration& found, const CalibrateOptions& options, const Interrupt& interrupt)
        : found_(found), options_(options), interrupt_(interrupt), reader_(files_), meshes_(meshes_in_turn()) {
        for (const SurveyedEvent& event : found.plan.events) {
            bases_.push_back(ensemble_base(event.runs, reader_, meshes_));
            if (!bases_.back().survey)
                throw UserError(fmt::format(
                    "{}: survey.footprint: found none; expected the surveyed footprint of the event; name it "
                    "there",
                    event.runs.case_file.string()));
            found_.fits.emplace_back().perimeter = perimeter_of(*bases_.back().survey);
        }
    }

    /// False when an end was asked for.
    bool run() {
        RunTeller teller(static_cast<std::size_t>(found_.plan.samples * found_.plan.rounds) * found_.fits.size(),
                         options_.quiet);
        for (Index round = 0; round < found_.plan.rounds; ++round) {
            const auto points = found_.posterior.next(found_.plan.samples);
            place(points);
            std::vector<std::optional<SampleResult>> results(points.size() * found_.fits.size());
            for_each_run(results.size(), threads_for_runs(options_.threads), interrupt_, [&](std::size_t k) {
                run_one(k, points.size(), results);
                teller.done(!results[k] || !results[k]->ended());
            });
            if (interrupt_.requested()) return false;
            found_.posterior.add(points, take(points.size(), results));
        }
        return true;
    }

private:
    void place(const std::vector<std::vector<double>>& points) {
        for (SurveyedEvent& event : found_.plan.events)
            for (const auto& u : points) {
                SamplePoint& point = event.runs.points.emplace_back();
                for (std::size_t k = 0; k < u.size(); ++k)
                    point.values.push_back(found_.plan.vary[k].distribution.text(u[k]));
            }
    }

    void run_one(std::size_t k, std::size_t points, std::vector<std::optional<SampleResult>>& results) const {
        const std::size_t event = k / points, sample = found_.posterior.points().size() + k % points;
        results[k] = run_sample(found_.plan.events[event].runs, bases_[event], static_cast<Index>(sample), reader_,
                                meshes_, interrupt_);
        if (results[k]) results[k]->peaks = {};
    }

    /// Notes how near the runs came; returns the likelihood of each point, of all events.
    std::vector<double> take(std::size_t points, const std::vector<std::optional<SampleResult>>& results) {
        std::vector<double> all(points, 0.0);
        for (std::size_t k = 0; k < results.size(); ++k) {
            EventFit& fit = found_.fits[k / points];
            const std::optional<SampleResult>& result = results[k];
            const bool ended = result && result->ended();
            found_.failed += !ended;
            if (result) found_.seconds += result->seconds;
            fit.rms.push_back(ended ? result->boundary_rms : std::nullopt);
            fit.mean.push_back(ended ? result->boundary : std::nullopt);
            fit.iou.push_back(ended ? result->iou : std::nullopt);
            const auto& rms = fit.rms.back();
            fit.log_likelihood.push_back(rms ? log_likelihood(*rms, fit.perimeter, found_.plan)
                                             : -std::numeric_limits<double>::infinity());
            all[k % points] += found_.plan.events[k / points].weight * fit.log_likelihood.back();
        }
        return all;
    }

    Calibration& found_;
    const CalibrateOptions& options_;
    const Interrupt& interrupt_;
    const GdalReader files_;
    const SharedReader reader_;
    const MeshReader meshes_;
    std::vector<EnsembleBase> bases_;
};

}  // namespace

int calibrate_command(const CalibrateOptions& options) {
    CalibrationPlan plan = read_calibration(options.file);
    const fs::path record = options.out / "calibrate.json";
    if (fs::exists(record) && !options.overwrite)
        throw UserError(
            fmt::format("{}: found an earlier calibration; expected a folder without; choose another one with "
                        "--out, or give --overwrite",
                        record.string()));
    Calibration found{plan, Posterior(static_cast<Index>(plan.vary.size()), plan.seed), {}, 0, 0.0};
    const Interrupt interrupt(Interrupt::Listen::signals);
    Rounds rounds(found, options, interrupt);
    const RunLock lock(options.out);
    if (!rounds.run())
        throw Interrupted(fmt::format("interrupted; {} has no result of these runs", options.out.string()));
    const std::vector<std::string> files = write_calibration(options.out, found);
    if (!options.quiet) {
        std::cout << calibration_section(found);
        for (const std::string& file : files) std::cout << (options.out / file).string() << '\n';
    }
    return 0;
}

}  // namespace frana
