#include "run/ensemble/outcomes.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>

#include "run/ensemble/kept_peaks.h"

namespace frana {
namespace {

Outcome always(const char* key, const char* name, double SampleResult::*value) {
    return {Outcome::Never::cannot_be, key, name, [value](const SampleResult& r) { return r.*value; }};
}

}  // namespace

double Outcome::counted(const SampleResult& result) const {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    return value(result).value_or(never == Never::infinite ? infinite : 0.0);
}

ShownUnit shown_unit(const PeakField& field) {
    if (std::string(field.unit) == "Pa") return {"kPa", 1e-3};
    return {field.unit, 1.0};
}

Outcome straight_reach() { return always("reach_m", "straight reach [m]", &SampleResult::reach); }

Outcome runout() { return always("runout_m", "runout [m]", &SampleResult::runout); }

std::vector<Outcome> outcomes_of_gauge(const EnsembleBase& base, std::size_t gauge) {
    const std::string& at = base.gauges[gauge].name;
    const auto of = [&](Outcome::Never never, const char* key, const char* name,
                        std::optional<double> GaugePeak::*value) {
        return Outcome{never, fmt::format("gauge_{}_{}", at, key), fmt::format("{} at {}", name, at),
                       [gauge, value](const SampleResult& r) { return r.gauges.at(gauge).*value; }};
    };
    return {of(Outcome::Never::zero, "depth_m", "largest depth [m]", &GaugePeak::depth),
            of(Outcome::Never::zero, "speed_m_s", "largest speed [m/s]", &GaugePeak::speed),
            of(Outcome::Never::infinite, "arrival_s", "time of arrival [s]", &GaugePeak::arrival)};
}

std::vector<Outcome> outcomes_of(const EnsembleBase& base) {
    std::vector<Outcome> all = {runout(),
                                straight_reach(),
                                always("footprint_area_m2", "footprint [m2]", &SampleResult::footprint_area),
                                always("volume_m3", "volume [m3]", &SampleResult::volume),
                                always("max_depth_m", "largest depth [m]", &SampleResult::max_depth),
                                always("max_speed_m_s", "largest speed [m/s]", &SampleResult::max_speed)};
    if (base.bed_changes) {
        all.push_back(always("eroded_m3", "taken of the bed [m3]", &SampleResult::eroded));
        all.push_back(always("deposited_m3", "left behind as bed [m3]", &SampleResult::deposited));
    }
    for (std::size_t gauge = 0; gauge < base.gauges.size(); ++gauge)
        for (Outcome& outcome : outcomes_of_gauge(base, gauge)) all.push_back(std::move(outcome));
    return all;
}

WeightedRuns::WeightedRuns(const EnsemblePlan& plan, const EnsembleBase& base, const KeptResults& kept) {
    std::vector<KeptRun> runs;
    for (std::size_t k = 0; k < kept.results.size(); ++k) {
        const SampleResult& result = kept.results[k];
        const double weight = plan.points[static_cast<std::size_t>(result.sample)].weight;
        if (!result.ended()) {
            failed_weight += weight;
            continue;
        }
        ended.push_back(&result), weights.push_back(weight);
        runs.push_back({result.sample, kept.peaks_files[k]});
        total += weight;
    }
    peaks = std::make_unique<KeptPeaks>(std::move(runs), plan.fields, base.whole);
}

double WeightedRuns::quantile(const Outcome& outcome, double q) const {
    const auto all = by_size(outcome);
    double below = 0.0;
    constexpr double round_off = 1e-9;
    for (const auto& [number, weight] : all)
        if ((below += weight) >= q * total * (1.0 - round_off)) return number;
    return all.back().first;
}

std::optional<double> WeightedRuns::mean(const Outcome& outcome) const {
    double sum = 0.0, counted = 0.0;
    for (std::size_t k = 0; k < ended.size(); ++k) {
        if (outcome.never == Outcome::Never::infinite && !outcome.value(*ended[k])) continue;
        sum += weights[k] * outcome.counted(*ended[k]), counted += weights[k];
    }
    if (counted > 0.0) return sum / counted;
    return std::nullopt;
}

double WeightedRuns::share_with(const Outcome& outcome) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < ended.size(); ++k)
        if (outcome.value(*ended[k])) sum += weights[k];
    return sum / total;
}

std::vector<std::pair<double, double>> WeightedRuns::by_size(const Outcome& outcome) const {
    std::vector<std::pair<double, double>> all;
    for (std::size_t k = 0; k < ended.size(); ++k) all.emplace_back(outcome.counted(*ended[k]), weights[k]);
    std::sort(all.begin(), all.end());
    return all;
}

}  // namespace frana
