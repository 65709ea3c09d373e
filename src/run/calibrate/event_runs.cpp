#include "run/calibrate/event_runs.h"

namespace frana {

EventRuns::EventRuns(const CalibrationPlan& plan, int threads, const Interrupt& interrupt)
    : plan_(plan), threads_(threads), interrupt_(interrupt), reader_(files_), meshes_(meshes_in_turn()) {
    for (const SurveyedEvent& event : plan.events) {
        bases_.push_back(ensemble_base(event.runs, reader_, meshes_));
        surveys_.emplace_back(event, bases_.back());
        bases_.back().survey.reset();  // runs are held against it here
    }
}

/// The plan of each event, with the values of the keys at these points.
std::vector<EnsemblePlan> EventRuns::plans_at(const std::vector<std::vector<double>>& points) const {
    std::vector<EnsemblePlan> plans;
    for (const SurveyedEvent& event : plan_.events) {
        EnsemblePlan& runs = plans.emplace_back(event.runs);
        for (const auto& u : points) {
            SamplePoint& point = runs.points.emplace_back();
            for (std::size_t k = 0; k < u.size(); ++k) point.values.push_back(plan_.vary[k].distribution.text(u[k]));
        }
    }
    return plans;
}

std::optional<std::vector<std::vector<EventRun>>> EventRuns::at(
    const std::vector<std::vector<double>>& points, KeptRuns& kept,
    const std::function<void(const EventRun&)>& done) const {
    const std::vector<EnsemblePlan> plans = plans_at(points);
    std::vector<std::vector<EventRun>> results(plans.size(), std::vector<EventRun>(points.size()));
    std::vector<std::pair<std::size_t, std::size_t>> left;  // event and point
    for (std::size_t event = 0; event < plans.size(); ++event)
        for (std::size_t point = 0; point < points.size(); ++point)
            if (const EventRun* known = kept.find(event, plans[event].points[point].values))
                done(results[event][point] = *known);
            else
                left.emplace_back(event, point);
    for_each_run(left.size(), threads_for_runs(threads_), interrupt_, [&](std::size_t k) {
        const auto [event, point] = left[k];
        const auto result = run(event, plans[event], point);
        if (!result) return;
        kept.add(event, plans[event].points[point].values, *result);
        done(*result);
        results[event][point] = *result;
    });
    kept.flush();
    if (interrupt_.requested()) return std::nullopt;
    return results;
}

std::optional<EventRun> EventRuns::run(std::size_t event, const EnsemblePlan& points, std::size_t point) const {
    EventScores scores;
    const auto result = run_sample(points, bases_[event], static_cast<Index>(point), reader_, meshes_, interrupt_,
                                   surveys_[event].watch(scores));
    if (!result) return std::nullopt;
    return EventRun{result->reason,      result->message,    result->seconds, result->ended() ? scores : EventScores{},
                    result->still_moves, result->left_share, result->remarks};
}

}  // namespace frana
