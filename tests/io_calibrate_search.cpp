// The search of a calibration on misfits whose least is known, without a run.
#include <cmath>
#include <set>
#include <stdexcept>
#include <vector>

#include "catch.h"
#include "run/calibrate/search.h"

using namespace frana;

namespace {

using Points = std::vector<std::vector<double>>;
using Runs = std::vector<std::vector<EventRun>>;

/// An outline so far from the surveyed one [m], in one place. With a standard deviation of 1 m the misfit is half of
/// its square.
EventRun run_off_by(double distance) {
    EventRun run;
    run.reason = "end";
    run.scores.misfits[static_cast<std::size_t>(Evidence::outline)] = Misfit{distance, 1.0};
    return run;
}

/// Two events, of the weights 1 and 3, that are met at two points of the unit square.
class TwoEvents {
public:
    TwoEvents() {
        for (const double weight : {1.0, 3.0}) {
            SurveyedEvent& event = found_.plan.events.emplace_back();
            event.weight = weight, event.objective = {Evidence::outline}, event.errors.outline = 1.0;
        }
        std::vector<double> logs;
        for (std::size_t k = 0; k < begin_.size(); ++k) logs.push_back(-misfit_of(begin_[k]));
        found_.posterior.next(static_cast<Index>(begin_.size()));
        found_.posterior.add(begin_, logs);
    }

    /// Ten metres for all of a key's distribution.
    static Runs at(const Points& points) {
        Runs runs(2);
        for (const auto& point : points)
            for (std::size_t e = 0; e < 2; ++e)
                runs[e].push_back(run_off_by(10.0 * std::hypot(point[0] - kMet[e][0], point[1] - kMet[e][1])));
        return runs;
    }
    static double misfit_of(const std::vector<double>& point) {
        double sum = 0.0;
        for (std::size_t e = 0; e < 2; ++e)
            sum += (e == 0 ? 0.5 : 1.5) * 100.0 *
                   (std::pow(point[0] - kMet[e][0], 2) + std::pow(point[1] - kMet[e][1], 2));
        return sum;
    }
    const Calibration& found() const { return found_; }
    const Points& begin() const { return begin_; }

private:
    static constexpr double kMet[2][2] = {{0.2, 0.8}, {0.6, 0.4}};
    const Points begin_ = {{0.9, 0.1}, {0.8, 0.7}, {0.1, 0.1}};
    Calibration found_{{}, Posterior(2, 1), std::vector<EventFit>(2)};
};

}  // namespace

TEST_CASE("the search finds the least misfit of two events by their weights", "[ensemble]") {
    const TwoEvents events;
    std::set<std::vector<double>> asked;
    const auto best = search_optimum(events.found(), [&](const Points& points) {
        asked.insert(points.begin(), points.end());
        return std::optional<Runs>(TwoEvents::at(points));
    });
    REQUIRE(best);
    // The mean of both by weight. Steps end at 3 % of a distribution; on a parabola the last ones are far better.
    CHECK(best->point[0] == Approx(0.5).margin(0.03));
    CHECK(best->point[1] == Approx(0.5).margin(0.03));
    CHECK(best->misfit == Approx(TwoEvents::misfit_of(best->point)));
    for (const auto& point : asked) CHECK(best->misfit <= TwoEvents::misfit_of(point));
    REQUIRE(best->scores.size() == 2);
    const auto& first = best->scores[0].misfits[static_cast<std::size_t>(Evidence::outline)];
    const Runs there = TwoEvents::at({best->point});
    REQUIRE(first);
    CHECK(first->rms == there[0][0].scores.misfits[static_cast<std::size_t>(Evidence::outline)]->rms);
    for (const auto& point : events.begin()) asked.erase(point);
    CHECK(best->evaluations == static_cast<Index>(asked.size()));
    CHECK_FALSE(best->ended.empty());
    // A parabola has no noise, but bends: all second differences of neighbours are the same.
    const double apart = 0.003 / 4.0, bend = 800.0 * apart * apart;
    CHECK(best->noise.value() == Approx(bend / std::sqrt(6.0)).epsilon(1e-6));
}

TEST_CASE("runs without an answer do not lead the search astray", "[ensemble]") {
    const TwoEvents events;
    const auto best = search_optimum(events.found(), [&](const Points& points) {
        Runs runs = TwoEvents::at(points);
        for (std::size_t k = 0; k < points.size(); ++k)
            if (points[k][0] < 0.55) runs[0][k] = EventRun{"numerics", "burst", 0.0, {}, false};
        return std::optional<Runs>(runs);
    });
    REQUIRE(best);
    CHECK(best->point[0] >= 0.55);
    CHECK(best->misfit < TwoEvents::misfit_of({0.8, 0.7}));
}

TEST_CASE("the search ends at once when asked to, and lets exceptions through", "[ensemble]") {
    const TwoEvents events;
    for (const int allowed : {0, 1, 3}) {  // the first request is for the neighbours that tell the noise
        CAPTURE(allowed);
        int calls = 0;
        const auto best = search_optimum(events.found(), [&](const Points& points) {
            return calls++ < allowed ? std::optional<Runs>(TwoEvents::at(points)) : std::nullopt;
        });
        CHECK_FALSE(best);
        CHECK(calls == allowed + 1);
    }
    int calls = 0;
    const auto broken = [&](const Points& points) {
        if (calls++ == 2) throw std::runtime_error("the disk is full");
        return std::optional<Runs>(TwoEvents::at(points));
    };
    CHECK_THROWS_WITH(search_optimum(events.found(), broken), "the disk is full");
}
