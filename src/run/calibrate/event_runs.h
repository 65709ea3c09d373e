#pragma once
// Runs of all events of a calibration at any points of the keys that vary.
#include <optional>
#include <string>
#include <vector>

#include "io/gdal_reader.h"
#include "run/calibrate/event_survey.h"
#include "run/calibrate/kept_runs.h"
#include "run/ensemble/run_pool.h"
#include "run/interrupt.h"
#include "scene/shared_reader.h"

namespace frana {

class EventRuns {
public:
    /// Builds the case of each event once. Throws UserError.
    EventRuns(const CalibrationPlan& plan, int threads, const Interrupt& interrupt);

    /// Runs all events at all points, each a place in the unit cube: results by event, then point. What `kept` has is not run
    /// again, and it gets the others. `done` hears of each run, on any thread. Nothing when an end was requested.
    std::optional<std::vector<std::vector<EventRun>>> at(const std::vector<std::vector<double>>& points, KeptRuns& kept,
                                                         const std::function<void(const EventRun&)>& done) const;

private:
    std::vector<EnsemblePlan> plans_at(const std::vector<std::vector<double>>& points) const;
    std::optional<EventRun> run(std::size_t event, const EnsemblePlan& points, std::size_t point) const;

    const CalibrationPlan& plan_;
    const int threads_;
    const Interrupt& interrupt_;
    const GdalReader files_;
    const SharedReader reader_;
    const MeshReader meshes_;
    std::vector<EnsembleBase> bases_;
    std::vector<EventSurvey> surveys_;
};

}  // namespace frana
