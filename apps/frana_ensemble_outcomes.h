#pragma once
// The runs of an ensemble that have an answer, with their weights, and the numbers that are told of them. Private to the files
// that write what an ensemble says.
#include <algorithm>
#include <utility>
#include <vector>

#include "ensemble/sample_run.h"
#include "ensemble/sensitivity.h"
#include "ensemble/statistics.h"
#include "frana_ensemble_maps.h"

namespace frana {

/// A number of a run and its name.
struct Outcome {
    const char *key, *name;
    double SampleResult::*value;
};
constexpr Outcome kOutcomes[] = {{"runout_m", "runout [m]", &SampleResult::runout},
                                 {"reach_m", "straight reach [m]", &SampleResult::reach},
                                 {"footprint_area_m2", "footprint [m2]", &SampleResult::footprint_area},
                                 {"volume_m3", "volume [m3]", &SampleResult::volume},
                                 {"max_depth_m", "largest depth [m]", &SampleResult::max_depth},
                                 {"max_speed_m_s", "largest speed [m/s]", &SampleResult::max_speed}};

/// Those with an answer.
class WeightedRuns {
public:
    WeightedRuns(const EnsemblePlan& plan, const std::vector<SampleResult>& results) {
        for (const SampleResult& result : results) {
            const double weight = plan.points[static_cast<std::size_t>(result.sample)].weight;
            if (!result.ended()) {
                failed_weight += weight;
                continue;
            }
            ended.push_back(&result), peaks.push_back(&result.peaks), weights.push_back(weight);
            total += weight;
        }
    }

    /// The least of an outcome that a share `q` of the weights does not exceed.
    double quantile(double SampleResult::*value, double q) const {
        const auto all = by_size(value);
        double below = 0.0;
        constexpr double round_off = 1e-9;
        for (const auto& [number, weight] : all)
            if ((below += weight) >= q * total * (1.0 - round_off)) return number;
        return all.back().first;
    }

    double mean(double SampleResult::*value) const {
        double sum = 0.0;
        for (std::size_t k = 0; k < ended.size(); ++k) sum += weights[k] * (ended[k]->*value);
        return sum / total;
    }

    /// An outcome of the runs with an answer, and their weights, ascending.
    std::vector<std::pair<double, double>> by_size(double SampleResult::*value) const {
        std::vector<std::pair<double, double>> all;
        for (std::size_t k = 0; k < ended.size(); ++k) all.emplace_back(ended[k]->*value, weights[k]);
        std::sort(all.begin(), all.end());
        return all;
    }

    /// Runs of a group of "saltelli" or "morris" share all keys but one.
    double independent(const EnsemblePlan& plan) const {
        const auto keys = static_cast<Index>(plan.vary.size());
        const double groups = static_cast<double>(ended.size()) / static_cast<double>(runs_each(plan.method, keys));
        return plan.method == Method::saltelli ? 2.0 * groups : groups;
    }

    std::vector<const SampleResult*> ended;
    std::vector<const SparseRasters*> peaks;
    std::vector<double> weights;
    double total = 0.0, failed_weight = 0.0;  ///< sums of weights
};

/// Draws runout.png, convergence.png and scatter.png; names those that were drawn.
void draw_charts(const std::filesystem::path& dir, const EnsemblePlan& plan, const EnsembleBase& base,
                 const WeightedRuns& runs, EnsembleSummary& summary);

/// Writes runs.csv.
void write_runs(const std::filesystem::path& dir, const EnsemblePlan& plan, const EnsembleBase& base,
                const std::vector<SampleResult>& results);

/// Writes report.md and ensemble.json.
void write_page(const std::filesystem::path& dir, const EnsemblePlan& plan, const EnsembleBase& base,
                const WeightedRuns& runs, const std::vector<SampleResult>& results, EnsembleSummary& summary);

}  // namespace frana
