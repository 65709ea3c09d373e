#include "run/calibrate/search.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <nlopt.hpp>
#include <set>

namespace frana {
namespace {

// All in shares of a key's distribution.
constexpr double kFirstStep = 0.1;
constexpr double kLeastStep = 0.03;  ///< below, a footprint's change is lost in its noise
constexpr double kNextTo = 0.003;    ///< how far apart points are that tell the noise
constexpr Index kForNoise = 5;       ///< so many of them
constexpr double kEdge = 1e-6;       ///< unbounded distributions have no value at 0 and 1
constexpr Index kMostPerKey = 20;    ///< evaluations

/// Minus the logarithm of the likelihood of points, and what their runs were like.
class Misfits {
public:
    Misfits(const Calibration& calibration, const RunsAt& runs)
        : runs_(runs),
          plan_(calibration.plan),
          asked_(calibration.posterior.points().begin(), calibration.posterior.points().end()) {
        for (const double log : calibration.posterior.log_likelihood())
            if (std::isfinite(log)) worst_ = std::max(worst_, -log);
    }

    /// Not finite where a run has no answer. Nothing when an end was requested.
    std::optional<std::vector<double>> at(const std::vector<std::vector<double>>& points) {
        const auto runs = runs_(points);
        if (!runs) return std::nullopt;
        std::vector<double> all(points.size(), 0.0);
        scores_.assign(points.size(), {});
        for (std::size_t e = 0; e < runs->size(); ++e)
            for (std::size_t k = 0; k < points.size(); ++k) {
                const SurveyedEvent& event = plan_.events[e];
                const EventScores& scores = (*runs)[e][k].scores;
                all[k] -= event.weight * log_likelihood(scores, event.objective, event.errors);
                scores_[k].push_back(scores);
            }
        for (const auto& point : points) evaluations_ += asked_.insert(point).second;
        return all;
    }

    /// Of the events, at the k-th point of the last request.
    const std::vector<EventScores>& scores(std::size_t k) const { return scores_[k]; }
    /// As far off as any run that has an answer.
    double worst() const { return worst_; }
    /// Points that neither the rounds nor the search had used before. Their number does not depend on what was stored
    /// of a search that was cut off.
    Index evaluations() const { return evaluations_; }

private:
    const RunsAt& runs_;
    const CalibrationPlan& plan_;
    std::set<std::vector<double>> asked_;
    double worst_ = 0.0;
    Index evaluations_ = 0;
    std::vector<std::vector<EventScores>> scores_;
};

/// Points next to one another, the first of which is `middle`.
std::vector<std::vector<double>> neighbours(const std::vector<double>& middle) {
    std::vector<std::vector<double>> points;
    for (Index n = 0; n < kForNoise; ++n) {
        std::vector<double> point = middle;
        const double inward = static_cast<double>(n) / static_cast<double>(kForNoise - 1) * kNextTo;
        for (double& u : point) u += u > 0.5 ? -inward : inward;
        points.push_back(std::move(point));
    }
    return points;
}

/// Standard deviation of the noise on numbers along a line, by their second differences: a slope is no noise. Unknown where no
/// three neighbours are finite.
std::optional<double> noise_of(const std::vector<double>& numbers) {
    double square = 0.0, count = 0.0;
    for (std::size_t k = 1; k + 1 < numbers.size(); ++k) {
        const double bend = numbers[k - 1] - 2.0 * numbers[k] + numbers[k + 1];
        if (!std::isfinite(bend)) continue;
        square += bend * bend / 6.0, count += 1.0;  // 1 + 4 + 1 variances
    }
    return count > 0.0 ? std::optional<double>(std::sqrt(square / count)) : std::nullopt;
}

const char* reason_of(nlopt::result result) {
    switch (result) {
        case nlopt::FTOL_REACHED:
            return "the misfit gains no more than its noise";
        case nlopt::XTOL_REACHED:
            return "the steps are as short as is sensible";
        case nlopt::MAXEVAL_REACHED:
            return "as many evaluations as are allowed";
        default:
            return "no way down";
    }
}

/// Stores the best point, and the first exception, which must not pass through the library.
struct Search {
    Misfits& misfits;
    Optimum& best;
    std::exception_ptr failure;
    bool interrupted = false;

    double operator()(const std::vector<double>& point) {
        try {
            const auto misfit = misfits.at({point});
            if (!misfit) {
                interrupted = true;
                throw nlopt::forced_stop();
            }
            if (!std::isfinite(misfit->front())) return misfits.worst();
            if (misfit->front() < best.misfit)
                best.misfit = misfit->front(), best.point = point, best.scores = misfits.scores(0);
            return misfit->front();
        } catch (const nlopt::forced_stop&) {
            throw;
        } catch (...) {
            failure = std::current_exception();
            throw nlopt::forced_stop();
        }
    }
};

double call(const std::vector<double>& point, std::vector<double>& /*gradient*/, void* search) {
    return (*static_cast<Search*>(search))(point);
}

}  // namespace

std::optional<Optimum> search_optimum(const Calibration& calibration, const RunsAt& runs) {
    std::vector<double> start = calibration.posterior.points()[calibration.posterior.best()];
    for (double& u : start) u = std::clamp(u, kEdge, 1.0 - kEdge);
    Misfits misfits(calibration, runs);
    const auto around = misfits.at(neighbours(start));
    if (!around) return std::nullopt;
    Optimum best;
    best.point = start, best.misfit = std::isfinite(around->front()) ? around->front() : misfits.worst(),
    best.scores = misfits.scores(0);
    best.noise = noise_of(*around);

    Search search{misfits, best, {}, false};
    const auto keys = static_cast<unsigned>(start.size());
    nlopt::opt way_down(nlopt::LN_BOBYQA, keys);
    way_down.set_lower_bounds(kEdge);
    way_down.set_upper_bounds(1.0 - kEdge);
    way_down.set_initial_step(kFirstStep);
    way_down.set_xtol_abs(kLeastStep);
    way_down.set_ftol_abs(best.noise.value_or(0.0));
    way_down.set_maxeval(static_cast<int>(kMostPerKey * (static_cast<Index>(keys) + 1)));
    way_down.set_min_objective(call, &search);
    double least = 0.0;
    try {
        best.ended = reason_of(way_down.optimize(start, least));
    } catch (const nlopt::forced_stop&) {
        if (search.failure) std::rethrow_exception(search.failure);
        return std::nullopt;
    } catch (const nlopt::roundoff_limited&) {  // the model's equations degenerate on noise
        best.ended = reason_of(nlopt::ROUNDOFF_LIMITED);
    }
    best.evaluations = misfits.evaluations();
    return best;
}

}  // namespace frana
