#pragma once
// Runs of a surveyed event held against its survey, as `frana compare` does.
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "compare/comparison.h"
#include "ensemble/calibration_plan.h"
#include "ensemble/sample_run.h"
#include "observe/observer.h"

namespace frana {

/// What was surveyed of an event, read once.
class EventSurvey {
public:
    /// `base` is the event's case. Throws UserError for what is not there, or has no place on the terrain.
    EventSurvey(const SurveyedEvent& event, const EnsembleBase& base);

    /// Observes while the event's case runs; at the end `scores` has how near it came. Must not outlive this.
    std::unique_ptr<Observer> watch(EventScores& scores) const;

private:
    class Watch;
    bool counts(Evidence evidence) const;
    void require_on_survey(const SurveyedEvent& event, double cell) const;
    void require_visible(const SurveyedEvent& event, const SeenAtGauge& seen) const;
    void read_gauges(const SurveyedEvent& event);

    std::vector<Evidence> objective_;
    std::string crs_wkt_;
    std::optional<Raster> bed_;    ///< under a path that was drawn, which may be uphill; nothing without one
    std::optional<Raster> later_;  ///< 1: a release may enter there after the start
    Survey survey_;
    double limit_ = 0.1;             ///< deeper counts as covered [m]
    double correlation_ = 1.0;       ///< [m]
    double perimeter_ = 0.0;         ///< of the surveyed outline [m]
    std::vector<Gauge> gauges_;      ///< of the case, where something was seen
    std::vector<SeenAtGauge> seen_;  ///< what, by gauge
};

}  // namespace frana
