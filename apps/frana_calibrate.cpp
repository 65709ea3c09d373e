// `frana calibrate FILE`: what surveyed events tell of the keys of their cases.
#include <fmt/core.h>

#include <iostream>

#include "frana_commands.h"
#include "frana_progress_lines.h"
#include "frana_run_teller.h"
#include "run/calibrate/calibration_run.h"
#include "run/calibrate/predict_folder.h"
#include "run/calibrate/results.h"
#include "run/interrupt.h"

namespace frana {
namespace {

void calibrate(const CalibrateOptions& options, const CalibrationPlan& plan) {
    const Interrupt interrupt(Interrupt::Listen::signals);
    const CalibrationRun run(plan, options.out, options.threads, interrupt);
    RunTeller teller(run.runs(), options.quiet, options.progress);
    const Calibration found = run.carry_out(options.overwrite, [&](bool failed) { teller.done(failed); });
    if (options.quiet || !options.progress.empty()) return;
    std::cout << calibration_section(found);
    for (const std::string& file : found.files) std::cout << (options.out / file).string() << '\n';
}

/// Maps of another event: an ensemble like any other.
int predict(const CalibrateOptions& options, const EnsemblePlan& maps) {
    const PredictFolder predicted(options.out, maps);
    EnsembleOptions ensemble;
    ensemble.file = predicted.file(), ensemble.out = predicted.folder();
    ensemble.threads = options.threads, ensemble.quiet = options.quiet || !options.progress.empty();
    ensemble.resume = true;
    return ensemble_command(ensemble);
}

int run_calibration(const CalibrateOptions& options) {
    const CalibrationPlan plan = read_calibration(options.file);
    const CalibrationWork left = left_to_calibrate(options.out, plan, options.resume, options.overwrite);
    if (!left.any() && !options.quiet && options.progress.empty())
        std::cout << fmt::format("{}: all is there\n", options.out.string());
    if (left.runs) calibrate(options, plan);
    return left.maps ? predict(options, *plan.predict) : 0;
}

}  // namespace

int calibrate_command(const CalibrateOptions& options) {
    ProgressLines lines(options.progress, "calibrate");
    lines.into(options.out);
    return lines.around([&] { return run_calibration(options); });
}

}  // namespace frana
