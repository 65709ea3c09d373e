#pragma once
// The runs of an ensemble that have an answer, with their weights, and the numbers that are told of them. Private to the files
// that write what an ensemble says.
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ensemble/sample_run.h"
#include "ensemble/sensitivity.h"
#include "ensemble/statistics.h"
#include "run/ensemble/maps.h"

namespace frana {

/// A number of a run and its name.
struct Outcome {
    /// What counts for a run that has no such number, since the flow never came there.
    enum class Never { cannot_be, zero, infinite } never = Never::cannot_be;
    std::string key, name;
    std::function<std::optional<double>(const SampleResult&)> value;

    /// In statistics over runs.
    double counted(const SampleResult& result) const;
};

/// Those of all ensembles, then those of the gauges.
std::vector<Outcome> outcomes_of(const EnsembleBase& base);
/// The three of a gauge: largest depth, largest speed, time of arrival.
std::vector<Outcome> outcomes_of_gauge(const EnsembleBase& base, std::size_t gauge);
/// How far the flow comes, straight from the start.
Outcome straight_reach();
/// Along the path.
Outcome runout();

/// Those with an answer.
class WeightedRuns {
public:
    /// Reads the files of their peaks once. Throws UserError when one cannot be read.
    WeightedRuns(const EnsemblePlan& plan, const EnsembleBase& base, const KeptResults& kept);

    /// The least of an outcome that a share `q` of the weights does not exceed; infinite where fewer have one.
    double quantile(const Outcome& outcome, double q) const;
    /// Of the runs that have one, or count as zero; nothing without such a run.
    std::optional<double> mean(const Outcome& outcome) const;
    /// Weight of the runs that have a number of their own, over all [1].
    double share_with(const Outcome& outcome) const;
    /// An outcome of the runs with an answer, and their weights, ascending.
    std::vector<std::pair<double, double>> by_size(const Outcome& outcome) const;

    /// Runs of a group of "saltelli" or "morris" share all keys but one.
    double independent(const EnsemblePlan& plan) const {
        const auto keys = static_cast<Index>(plan.vary.size());
        const double groups = static_cast<double>(ended.size()) / static_cast<double>(runs_each(plan.method, keys));
        return plan.method == Method::saltelli ? 2.0 * groups : groups;
    }

    /// Numbers of those with an answer.
    std::vector<Index> samples() const {
        std::vector<Index> all;
        for (const SampleResult* run : ended) all.push_back(run->sample);
        return all;
    }

    std::vector<const SampleResult*> ended;
    std::unique_ptr<PeakSource> peaks;  ///< theirs
    std::vector<double> weights;
    double total = 0.0, failed_weight = 0.0;  ///< sums of weights
};

/// Writes the classes of hazard, where the plan has them: raster and picture. Notes their areas.
void write_hazard(const std::filesystem::path& dir, const EnsemblePlan& plan, const EnsembleBase& base,
                  const WeightedRuns& runs, EnsembleSummary& summary);

/// A share that grows by each weight, over `total`, at its number: corners of its steps, on to `end`. `by_size`
/// ascends; what is infinite never comes. Empty where nothing comes.
std::vector<Vec2> growing_share(const std::vector<std::pair<double, double>>& by_size, double total, double end);

/// Draws runout.png, convergence.png, scatter.png and, of a case with gauges, gauges_*.png; names those that were drawn.
void draw_charts(const std::filesystem::path& dir, const EnsemblePlan& plan, const EnsembleBase& base,
                 const WeightedRuns& runs, EnsembleSummary& summary);

/// Writes figures/view.html: the probabilities in a browser. Nothing where a part of the terrain is held only, or the build
/// has no three.js.
void write_view(const std::filesystem::path& dir, const EnsemblePlan& plan, const EnsembleBase& base,
                const WeightedRuns& runs, EnsembleSummary& summary);

/// A unit for people, and how many of it a unit of the field is: pressures in kPa.
struct ShownUnit {
    std::string name;
    double factor = 1.0;
};
ShownUnit shown_unit(const PeakField& field);

/// Writes runs.csv.
void write_runs(const std::filesystem::path& dir, const EnsemblePlan& plan, const EnsembleBase& base,
                const std::vector<SampleResult>& results);

/// Writes report.md and ensemble.json.
void write_page(const std::filesystem::path& dir, const EnsemblePlan& plan, const EnsembleBase& base,
                const WeightedRuns& runs, const std::vector<SampleResult>& results, EnsembleSummary& summary);

}  // namespace frana
