#include "ensemble/predictions.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "ensemble/statistics.h"

namespace frana {
namespace {

constexpr double kFewTell = 10.0;  ///< points of equal weight below which what they tell may be chance
constexpr double kNone = 1e-6;  ///< a share of the weight that is as good as none, and the rounding of a sum of shares

/// Of numbers with weights, sorted. Where half of the weight lies below a number and half above the one before, their
/// mean.
double median_of(const std::vector<std::pair<double, double>>& sorted, double all) {
    double below = 0.0;
    for (std::size_t k = 0; k < sorted.size(); ++k) {
        below += sorted[k].second;
        if (below > (0.5 + kNone) * all) return sorted[k].first;
        if (below >= (0.5 - kNone) * all)
            return 0.5 * (sorted[k].first + sorted[std::min(k + 1, sorted.size() - 1)].first);
    }
    return sorted.back().first;
}

Nearness nearness_of(const EventFit& fit, const std::vector<double>& weights) {
    std::vector<std::pair<double, double>> known;
    double sum = 0.0, flowing = 0.0, all = 0.0;
    for (std::size_t k = 0; k < weights.size(); ++k) {
        all += weights[k];
        const auto& boundary = fit.scores[k].boundary;
        if (!boundary || !(weights[k] > 0.0)) continue;
        known.emplace_back(*boundary, weights[k]);
        sum += weights[k] * *boundary, flowing += weights[k];
    }
    constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
    const double effective = effective_number(weights);
    if (!(flowing > kNone * all)) return {nothing, nothing, effective};
    std::sort(known.begin(), known.end());
    return {sum / flowing, median_of(known, flowing), effective};
}

/// A distance in a table; a dash where there is none.
std::string cell(double distance) { return std::isnan(distance) ? " - |" : fmt::format(" {:.1f} |", distance); }

/// Weights by the surveys of those events that `takes` says.
template <class Takes>
std::vector<double> weights_of(const Calibration& c, const Takes& takes) {
    std::vector<double> sum(c.posterior.points().size(), 0.0);
    for (std::size_t f = 0; f < c.fits.size(); ++f)
        for (std::size_t k = 0; takes(f) && k < sum.size(); ++k)
            sum[k] += c.plan.events[f].weight * c.fits[f].log_likelihood[k];
    return c.posterior.weights(sum);
}

/// A sentence where `told` predicts the event worse than what was known before. Medians are compared. A few runs far
/// off move the mean of a wide prior, and hardly that of a survey.
std::string warning(const Calibration& c, const std::string& teller, std::size_t event, const Nearness& told,
                    const Nearness& prior) {
    const std::string& name = c.plan.events[event].name;
    if (std::isnan(prior.median)) return "";
    const std::string few = told.effective < kFewTell
                                ? fmt::format(" By {:.0f} points of equal weight: it may be chance.", told.effective)
                                : "";
    if (std::isnan(told.median))
        return fmt::format("\n{} predicts no flow for {}, and so misleads.{}\n", teller, name, few);
    if (!(told.median > prior.median)) return "";
    return fmt::format(
        "\n{} predicts {} worse than what was known before: by the medians, outlines {:.1f} m apart "
        "instead of {:.1f} m.{}\n",
        teller, name, told.median, prior.median, few);
}

std::string pairs_section(const Calibration& c, const std::vector<Prediction>& rows) {
    std::string text = "\nOutlines apart [m], by what one survey alone tells:\n\n| Event |";
    for (const SurveyedEvent& event : c.plan.events) text += fmt::format(" by {} |", event.name);
    text += "\n|---|";
    for (std::size_t e = 0; e < rows.size(); ++e) text += "---:|";
    text += "\n";
    for (std::size_t e = 0; e < rows.size(); ++e) {
        text += fmt::format("| {} |", c.plan.events[e].name);
        for (const Nearness& told : rows[e].by_one) text += cell(told.mean);
        text += "\n";
    }
    for (std::size_t e = 0; e < rows.size(); ++e)
        for (std::size_t f = 0; f < rows.size(); ++f)
            if (f != e)
                text += warning(c, fmt::format("What {} alone tells", c.plan.events[f].name), e, rows[e].by_one[f],
                                rows[e].prior);
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
        row.prior = nearness_of(fit, first), row.own = nearness_of(fit, alone[e]), row.all = nearness_of(fit, all);
        row.others = nearness_of(fit, weights_of(c, [&](std::size_t g) { return g != e; }));
        for (const auto& weights : alone) row.by_one.push_back(nearness_of(fit, weights));
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
        text += fmt::format("| {} | {:.3f} |", c.plan.events[e].name, scores.iou.value_or(0.0));
        text += cell(scores.boundary.value_or(std::numeric_limits<double>::quiet_NaN())) + cell(rows[e].prior.mean) +
                cell(rows[e].prior.median) + cell(rows[e].own.mean);
        text += (several ? cell(rows[e].others.mean) + cell(rows[e].all.mean) : "") + "\n";
    }
    for (std::size_t e = 0; several && e < rows.size(); ++e)
        text += warning(c, "What the other events tell", e, rows[e].others, rows[e].prior);
    constexpr std::size_t pair = 2;  // of which each is all the others of the other one
    return text + (c.fits.size() > pair ? pairs_section(c, rows) : "");
}

}  // namespace frana
