#include "frana_calibrate_predictions.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <optional>

namespace frana {
namespace {

/// The mean distance of the outlines by weight, of the runs in which something flowed.
double mean_of(const EventFit& fit, const std::vector<double>& weights) {
    double sum = 0.0, all = 0.0;
    for (std::size_t k = 0; k < weights.size(); ++k)
        if (const auto& boundary = fit.scores[k].boundary) sum += weights[k] * *boundary, all += weights[k];
    return all > 0.0 ? sum / all : std::numeric_limits<double>::quiet_NaN();
}

/// The same of the first so many runs, and the median.
double median_of(const EventFit& fit, Index count) {
    std::vector<double> known;
    for (Index k = 0; k < count; ++k)
        if (const auto& boundary = fit.scores[static_cast<std::size_t>(k)].boundary) known.push_back(*boundary);
    if (known.empty()) return std::numeric_limits<double>::quiet_NaN();
    const auto middle = known.begin() + static_cast<std::ptrdiff_t>(known.size() / 2);
    std::nth_element(known.begin(), middle, known.end());
    return *middle;
}

/// Weights by the surveys of those events that `takes` says.
template <class Takes>
std::vector<double> weights_of(const Calibration& c, const Takes& takes) {
    std::vector<double> sum(c.posterior.points().size(), 0.0);
    for (std::size_t f = 0; f < c.fits.size(); ++f)
        for (std::size_t k = 0; takes(f) && k < sum.size(); ++k)
            sum[k] += c.plan.events[f].weight * c.fits[f].log_likelihood[k];
    return c.posterior.weights(sum);
}

/// A sentence for each event that `told` predicts worse than the median of the prior's runs.
std::string warning(const Calibration& c, const std::string& teller, std::size_t event, double told, double median) {
    if (!(told > median)) return "";
    return fmt::format(
        "\n{} predicts {} worse than the median of what was known before: outlines {:.1f} m apart "
        "instead of {:.1f} m.\n",
        teller, c.plan.events[event].name, told, median);
}

std::string pairs_section(const Calibration& c, const std::vector<Prediction>& rows) {
    std::string text = "\nOutlines apart [m], by what one survey alone tells:\n\n| Event |";
    for (const SurveyedEvent& event : c.plan.events) text += fmt::format(" by {} |", event.name);
    text += "\n|---|";
    for (std::size_t e = 0; e < rows.size(); ++e) text += "---:|";
    text += "\n";
    for (std::size_t e = 0; e < rows.size(); ++e) {
        text += fmt::format("| {} |", c.plan.events[e].name);
        for (const double told : rows[e].by_one) text += fmt::format(" {:.1f} |", told);
        text += "\n";
    }
    for (std::size_t e = 0; e < rows.size(); ++e)
        for (std::size_t f = 0; f < rows.size(); ++f)
            if (f != e)
                text += warning(c, fmt::format("What {} alone tells", c.plan.events[f].name), e, rows[e].by_one[f],
                                rows[e].prior_median);
    return text;
}

}  // namespace

std::vector<Prediction> predictions(const Calibration& c) {
    std::vector<Prediction> rows;
    const std::vector<double> all = c.posterior.weights();
    std::vector<double> first(all.size(), 0.0);
    std::fill(first.begin(), first.begin() + c.plan.samples, 1.0);  // the first round is the prior
    std::vector<std::vector<double>> alone;
    for (std::size_t f = 0; f < c.fits.size(); ++f)
        alone.push_back(weights_of(c, [&](std::size_t g) { return g == f; }));
    for (std::size_t e = 0; e < c.fits.size(); ++e) {
        const EventFit& fit = c.fits[e];
        Prediction& row = rows.emplace_back();
        row.prior = mean_of(fit, first), row.prior_median = median_of(fit, c.plan.samples);
        row.own = mean_of(fit, alone[e]), row.all = mean_of(fit, all);
        row.others = mean_of(fit, weights_of(c, [&](std::size_t g) { return g != e; }));
        for (const auto& weights : alone) row.by_one.push_back(mean_of(fit, weights));
    }
    return rows;
}

std::string predictions_section(const Calibration& c) {
    const bool several = c.fits.size() > 1;
    const std::size_t best = c.posterior.best();
    std::string text =
        "| Event | IoU of the best | outlines apart [m]: best | by the prior | its median | by its own survey |";
    text += several ? " by the other events | by all |\n|---|---:|---:|---:|---:|---:|---:|---:|\n"
                    : "\n|---|---:|---:|---:|---:|---:|\n";
    const auto rows = predictions(c);
    for (std::size_t e = 0; e < c.fits.size(); ++e) {
        const EventScores& scores = c.fits[e].scores[best];
        text += fmt::format("| {} | {:.3f} | {:.1f} | {:.1f} | {:.1f} | {:.1f} |", c.plan.events[e].name,
                            scores.iou.value_or(0.0), scores.boundary.value_or(0.0), rows[e].prior,
                            rows[e].prior_median, rows[e].own);
        text += several ? fmt::format(" {:.1f} | {:.1f} |\n", rows[e].others, rows[e].all) : "\n";
    }
    for (std::size_t e = 0; several && e < rows.size(); ++e)
        text += warning(c, "What the other events tell", e, rows[e].others, rows[e].prior_median);
    constexpr std::size_t pair = 2;  // of which each is all the others of the other one
    return text + (c.fits.size() > pair ? pairs_section(c, rows) : "");
}

}  // namespace frana
