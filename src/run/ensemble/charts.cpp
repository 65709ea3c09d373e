// Charts of an ensemble: how far the flow comes, how that settles with more runs, what it depends on.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "run/ensemble/outcomes.h"
#include "vtk_io/figures/chart_figure.h"

namespace frana {
namespace {

struct Charts {
    const std::filesystem::path& dir;
    const EnsemblePlan& plan;
    const EnsembleBase& base;
    const WeightedRuns& runs;
    EnsembleSummary& summary;
};

void draw(const Charts& of, const ChartFigure& figure, const std::string& name) {
    std::string why_not;
    if (render_chart(figure, of.dir / "figures" / name, why_not)) of.summary.files.push_back("figures/" + name);
}

/// How likely an outcome is larger than a number.
Curve larger(const WeightedRuns& runs, const std::string& name, const Outcome& outcome) {
    Curve curve;
    curve.name = name;
    double left = runs.total;
    for (const auto& [number, weight] : runs.by_size(outcome)) {
        curve.x.push_back(number), curve.y.push_back(left / runs.total);
        left -= weight;
        curve.x.push_back(number), curve.y.push_back(std::max(0.0, left / runs.total));
    }
    return curve;
}

/// How likely the flow has come by a time, until the last run ended.
Curve come_by(const WeightedRuns& runs, const std::string& name, const Outcome& arrival) {
    double end = 0.0;
    for (const SampleResult* run : runs.ended) end = std::max(end, run->time);
    Curve curve;
    curve.name = name;
    for (const Vec2& corner : growing_share(runs.by_size(arrival), runs.total, end))
        curve.x.push_back(corner.x()), curve.y.push_back(corner.y());
    return curve;
}

void draw_outcomes(const Charts& of) {
    ChartFigure figure;
    figure.title = of.base.title + ": how far the runs come";
    figure.x_label = "distance [m]";
    std::vector<Curve> curves = {larger(of.runs, "straight from the release", straight_reach())};
    if (!of.base.path.empty()) curves.push_back(larger(of.runs, "along the steepest path", runout()));
    figure.panels.push_back({"share of the runs that come farther [1]", curves, false, std::pair{0.0, 1.0}, 1.0});
    figure.footer = runs_sentence(of.summary);
    draw(of, figure, "runout.png");
}

/// What the runs bring to each gauge: a picture for each of the three, since their axes differ.
void draw_gauges(const Charts& of) {
    const std::pair<const char*, const char*> axes[] = {
        {"depth", "largest depth [m]"}, {"speed", "largest speed [m/s]"}, {"arrival", "time [s]"}};
    for (std::size_t which = 0; which < std::size(axes) && !of.base.gauges.empty(); ++which) {
        const bool arrival = which == 2;
        ChartFigure figure;
        figure.title = fmt::format("{}: {} at the gauges", of.base.title, arrival ? "arrival" : axes[which].first);
        figure.x_label = axes[which].second;
        ChartPanel panel{arrival ? "share of the runs that have come [1]" : "share of the runs with more [1]",
                         {},
                         false,
                         std::pair{0.0, 1.0},
                         1.0};
        for (std::size_t gauge = 0; gauge < of.base.gauges.size(); ++gauge) {
            const Outcome outcome = outcomes_of_gauge(of.base, gauge)[which];
            const std::string& name = of.base.gauges[gauge].name;
            panel.curves.push_back(arrival ? come_by(of.runs, name, outcome) : larger(of.runs, name, outcome));
        }
        const auto empty = [](const Curve& curve) { return curve.x.empty(); };
        if (std::all_of(panel.curves.begin(), panel.curves.end(), empty)) continue;  // no run came to any of them
        figure.panels.push_back(panel);
        figure.footer = runs_sentence(of.summary);
        draw(of, figure, fmt::format("gauges_{}.png", axes[which].first));
    }
}

/// How the middle of the runs settles with their number. Of a grid and of a table the order has a meaning.
void draw_convergence(const Charts& of) {
    const bool alike = of.summary.effective > 0.999 * static_cast<double>(of.runs.ended.size());
    const bool ordered = of.plan.method == Method::grid || of.plan.method == Method::table;
    if (!alike || ordered || of.plan.quantiles.empty() || of.runs.ended.size() < 2) return;
    ChartFigure figure;
    figure.title = of.base.title + ": straight reach of the first runs";
    figure.x_label = "number of runs";
    std::vector<Curve> curves;
    for (const double q : of.plan.quantiles)
        curves.push_back({fmt::format("{:g} % of the runs stay below", 100.0 * q), {}, {}});
    std::vector<double> sorted;
    for (std::size_t k = 0; k < of.runs.ended.size(); ++k) {
        sorted.insert(std::upper_bound(sorted.begin(), sorted.end(), of.runs.ended[k]->reach), of.runs.ended[k]->reach);
        for (std::size_t n = 0; n < curves.size(); ++n) {
            // As WeightedRuns::quantile: the least that so many do not exceed.
            const double so_many = std::ceil(of.plan.quantiles[n] * static_cast<double>(k + 1) - 1e-9);
            const auto below = static_cast<std::size_t>(std::max(0.0, so_many - 1.0));
            curves[n].x.push_back(static_cast<double>(k + 1)), curves[n].y.push_back(sorted[below]);
        }
    }
    figure.panels.push_back({"straight reach [m]", curves, false, {}, 1.0});
    figure.footer = runs_sentence(of.summary);
    draw(of, figure, "convergence.png");
}

/// Each run as a mark, over where it stands in the distribution of each key.
void draw_scatter(const Charts& of) {
    if (of.plan.design.points.empty()) return;  // of a table nothing is known but its values
    ChartFigure figure;
    figure.title = of.base.title + ": straight reach by what varies";
    figure.x_label = "share of the key's distribution below the run's value [1]";
    figure.x_range = {0.0, 1.0};
    constexpr std::size_t at_most = 4;  // panels that can still be read
    const std::size_t keys = of.plan.vary.size(), shown = std::min(at_most, keys);
    if (shown < keys) figure.title += fmt::format(" (the first {} of {} keys)", shown, keys);
    for (std::size_t k = 0; k < shown; ++k) {
        Curve curve;
        curve.name = of.plan.vary[k].key;
        curve.marks = true;
        for (const SampleResult* run : of.runs.ended) {
            curve.x.push_back(of.plan.design.points[static_cast<std::size_t>(run->sample)][k]);
            curve.y.push_back(run->reach);
            curve.x.push_back(Raster::nodata), curve.y.push_back(Raster::nodata);  // no line to the next
        }
        figure.panels.push_back({"straight reach [m]", {curve}, false, {}, 1.0});
    }
    figure.footer = runs_sentence(of.summary);
    draw(of, figure, "scatter.png");
}

}  // namespace

std::vector<Vec2> growing_share(const std::vector<std::pair<double, double>>& by_size, double total, double end) {
    std::vector<Vec2> corners;
    double share = 0.0, sum = 0.0;
    for (const auto& [number, weight] : by_size) {
        if (!std::isfinite(number)) break;
        corners.emplace_back(number, share);
        sum += weight;
        share = std::min(1.0, sum / total);
        corners.emplace_back(number, share);
    }
    if (!corners.empty() && end > corners.back().x()) corners.emplace_back(end, share);
    return corners;
}

void draw_charts(const std::filesystem::path& dir, const EnsemblePlan& plan, const EnsembleBase& base,
                 const WeightedRuns& runs, EnsembleSummary& summary) {
    const Charts of{dir, plan, base, runs, summary};
    draw_outcomes(of);
    draw_convergence(of);
    draw_scatter(of);
    draw_gauges(of);
}

}  // namespace frana
