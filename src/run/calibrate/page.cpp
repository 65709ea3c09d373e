// What a calibration says to people.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <tuple>

#include "ensemble/predictions.h"
#include "ensemble/statistics.h"
#include "observe/left_terrain.h"
#include "run/calibrate/results.h"

namespace frana {
namespace {

constexpr double kFewSamples = 50.0;   ///< below, quantiles are guesses
constexpr double kFewForAnEnd = 20.0;  ///< points of equal weight, of which a twentieth of a range has one
constexpr double kAtAnEnd = 2.0;       ///< a density at an end, over the prior's, that is worth a sentence
constexpr double kTogether = 0.5;      ///< a correlation that is worth a sentence
constexpr double kNoSpread = 5.0;      ///< points of equal weight below which a spread is that of single runs
constexpr double kMissed = 3.0;        ///< standard deviations beyond which a best run is no fit

std::string optimum_cell(const Calibration& c, std::size_t key) {
    return c.optimum ? fmt::format(" {:.4g} |", c.plan.vary[key].distribution.number(c.optimum->point[key])) : "";
}

/// What the search found, and what that is worth.
std::string optimum_section(const Calibration& c, double best) {
    if (!c.optimum) return "";
    const Optimum& optimum = *c.optimum;
    const std::string noise =
        optimum.noise ? fmt::format("is {:.2g}", *optimum.noise) : "is not known, since its neighbours have no answers";
    const std::string before = fmt::format("{:.4g}", -best), after = fmt::format("{:.4g}", optimum.misfit);
    const std::string way = before == after ? fmt::format("did not fall from {}", before)
                                            : fmt::format("fell from {} to {}", before, after);
    return fmt::format(
               "\nThe optimum was searched from the best point, {} more points of all events: the misfit {}, where its "
               "noise {}. The end: {}.\n",
               optimum.evaluations, way, noise, optimum.ended) +
           (optimum.noise.value_or(0.0) > 1.0
                ? "\nA noise above 1 is much: which of two neighbours has the weight is chance. "
                  "Give a larger sigma, or more samples.\n"
                : "");
}

/// Which keys the surveys tell only one by another. A correlation of few points is chance: of n, 1 / sqrt(n) is its error.
std::string pairs_section(const Calibration& c, double effective) {
    constexpr double errors = 2.5;
    std::string text;
    for (const KeyPair& pair : pairs_of(c))
        if (std::abs(pair.correlation.value_or(0.0)) > std::max(kTogether, errors / std::sqrt(effective)))
            text += fmt::format(
                "\n`{}` and `{}` go together (correlation {:.2f}). Take both of one row of `posterior.csv`, and "
                "not the mean of each.\n",
                pair.first, pair.second, *pair.correlation);
    return text;
}

/// Keys whose range is favoured most at one of its ends: values beyond may be likelier still.
std::string ends_section(const Calibration& c, double effective) {
    if (effective < kFewForAnEnd) return "";
    std::string text;
    for (std::size_t k = 0; k < c.plan.vary.size(); ++k) {
        const std::vector<double> density = density_of(c, k);
        const Distribution& prior = c.plan.vary[k].distribution;
        const double most = *std::max_element(density.begin(), density.end());
        if (most < kAtAnEnd) continue;
        for (const auto& [upper, end, at] :
             {std::tuple{false, prior.low, density.front()}, std::tuple{true, prior.high, density.back()}})
            if (std::isfinite(end) && at == most)
                text += fmt::format(
                    "\nThe surveys favour `{}` most at the {} end of its range, {:.4g}. Values beyond may do "
                    "better. Widen the range, unless they are impossible.\n",
                    c.plan.vary[k].key, upper ? "upper" : "lower", end);
    }
    return text;
}

/// What of the best point's runs no survey can judge.
std::string unsurveyed_section(const Calibration& c, std::size_t best) {
    std::string text;
    for (std::size_t e = 0; e < c.fits.size(); ++e)
        for (const Evidence evidence : c.plan.events[e].objective) {
            const auto& misfit = c.fits[e].scores[best].misfits[static_cast<std::size_t>(evidence)];
            if (is_raster(evidence) && misfit && misfit->unsurveyed > 0.0)
                text += fmt::format(
                    "{}: {:.6g} m3 of the simulated {} of the best point lie where the survey has no data and are in "
                    "none of "
                    "its errors; if no data means that nothing changed there, write zeros.\n\n",
                    c.plan.events[e].name, misfit->unsurveyed,
                    evidence == Evidence::deposit ? "deposit" : "changes of the bed");
        }
    return text;
}

/// How far off a kind of evidence is at the best point, or at the optimum where that is nearer [standard deviations].
std::optional<double> sigmas_off(const Calibration& c, std::size_t best, std::size_t e, Evidence evidence) {
    const auto kind = static_cast<std::size_t>(evidence);
    std::optional<Misfit> least = c.fits[e].scores[best].misfits[kind];
    if (c.optimum) {
        const std::optional<Misfit>& found = c.optimum->scores[e].misfits[kind];
        if (found && (!least || found->rms < least->rms)) least = found;
    }
    return least ? std::optional(least->rms / c.plan.events[e].errors.of(evidence)) : std::nullopt;
}

/// A sentence for each event that no run comes near to.
std::string missed_section(const Calibration& c, std::size_t best) {
    std::string text;
    for (std::size_t e = 0; e < c.fits.size(); ++e) {
        std::string off;
        for (const Evidence evidence : c.plan.events[e].objective) {
            const std::optional<double> sigmas = sigmas_off(c, best, e, evidence);
            if (sigmas && *sigmas > kMissed)
                off +=
                    fmt::format("{}{:.2g} sigma off in {}", off.empty() ? "" : ", ", *sigmas, kind_of(evidence).word);
        }
        if (!off.empty())
            text += fmt::format(
                "{}: the best run is {}. The model with these keys does not reach the survey; their spread says "
                "nothing of what is known.\n\n",
                c.plan.events[e].name, off);
    }
    return text;
}

/// Events whose flow left the terrain at the best point: a survey beyond its edge cannot be met.
std::string left_section(const Calibration& c, std::size_t best) {
    std::string text;
    for (std::size_t e = 0; e < c.fits.size(); ++e)
        if (const double share = c.fits[e].left_share[best]; share > kNoticeablyLeft)
            text += fmt::format(
                "{}: at the best point {:.3g} % of all that flowed left the terrain. Smaller misfits may lie beyond "
                "its "
                "edge.\n\n",
                c.plan.events[e].name, 100.0 * share);
    return text;
}

/// How far the best point's runs are off in all that counts, with what was expected of them.
std::string misfits_section(const Calibration& c, std::size_t best) {
    std::string text = "| Event | what counts | best point | sigma | independent errors |\n|---|---|---:|---:|---:|\n";
    for (std::size_t e = 0; e < c.fits.size(); ++e) {
        const SurveyedEvent& event = c.plan.events[e];
        for (const Evidence evidence : event.objective) {
            const EvidenceKind& kind = kind_of(evidence);
            const auto& misfit = c.fits[e].scores[best].misfits[static_cast<std::size_t>(evidence)];
            if (!misfit) continue;  // the best point has an answer to all of them
            text += fmt::format("| {} | {} [{}] | {:.3g} | {:.3g} | {:.3g} |\n", event.name, kind.meaning, kind.unit,
                                misfit->rms, event.errors.of(evidence), misfit->number);
        }
    }
    return text + "\n" + left_section(c, best) + missed_section(c, best) + unsurveyed_section(c, best);
}

}  // namespace

std::string calibration_section(const Calibration& c) {
    const std::vector<double> w = c.posterior.weights();
    const std::size_t best = c.posterior.best();
    const double effective = effective_number(w);
    std::string page =
        fmt::format("| Key | best |{} mean | sd | 5 % | 50 % | 95 % |\n|---|---:|{}---:|---:|---:|---:|---:|\n",
                    c.optimum ? " optimum |" : "", c.optimum ? "---:|" : "");
    for (std::size_t k = 0; k < c.plan.vary.size(); ++k) {
        const std::vector<double> values = values_of(c, k);
        const Marginal of = marginal_of(values, w);
        page +=
            fmt::format("| `{}` | {:.4g} |{} {:.4g} |", c.plan.vary[k].key, values[best], optimum_cell(c, k), of.mean);
        page += effective < kNoSpread
                    ? " - | - | - | - |\n"
                    : fmt::format(" {:.2g} | {:.4g} | {:.4g} | {:.4g} |\n", of.sd, of.q05, of.q50, of.q95);
    }
    page += pairs_section(c, effective) + ends_section(c, effective);
    page += optimum_section(c, c.posterior.log_likelihood()[best]);
    page += fmt::format("\n{} points, {} runs, {} failed; the points tell as much as {:.0f} of equal weight.", w.size(),
                        w.size() * c.fits.size(), c.failed, effective);
    if (c.failed > 0) page += " Where one failed, the surveys have no say: its values count as if they were excluded.";
    if (c.not_at_rest > 0)
        page += fmt::format(" {} still moved at time.end, and were held against the surveys as they were then.",
                            c.not_at_rest);
    if (c.left_terrain > 0)
        page += fmt::format(
            " Of {} a noticeable share left the terrain: their runout, outline and deposit are lower bounds, and "
            "misfits "
            "that grow no more there cannot tell one from another. Give a wider elevation model or terrain.window.",
            c.left_terrain);
    if (effective < kNoSpread) page += " Fewer than 5 have no spread that means anything, so it is left out.";
    if (effective < kFewSamples) page += " Fewer than 50 are few: give more samples or rounds, or a larger sigma.";
    for (const std::string& remark : c.remarks) page += fmt::format("\n\n{}.", remark);
    for (std::size_t e = 0; e < c.fits.size(); ++e)
        for (const std::string& remark : c.fits[e].remarks.sentences(static_cast<Index>(w.size())))
            page += fmt::format("\n\n{}: {}.", c.plan.events[e].name, remark);
    return page + "\n\n" + misfits_section(c, best) + predictions_section(c);
}

}  // namespace frana
