// figures/view.html of an ensemble: how likely more than any threshold is, on the terrain, in a browser.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/atomic_file.h"
#include "base/number_text.h"
#include "run/ensemble/outcomes.h"
#include "run/web/web_page.h"
#include "scene/parameters.h"
#include "terrain/places.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

// Of the maps. Probabilities at all thresholds of three fields then fill some 10 MB.
constexpr Index kMostPlaces = 60'000;

/// Round thresholds from `low` to the first that none of the values exceeds, 32 a decade, and those in `asked`. So that
/// the page shows exact shares of the runs wherever its slider stands.
std::vector<double> thresholds_between(double low, double high, const std::vector<double>& asked) {
    std::vector<double> all = asked;
    if (low > 0.0) all.push_back(low);
    if (!(high > 0.0)) high = low;  // nowhere more than nothing
    double last = low;
    const double least = std::max(low, 1e-3 * high);
    for (int ten = least > 0.0 ? static_cast<int>(std::floor(std::log10(least))) - 1 : 0; last < high; ++ten)
        for (int tenths = 10; tenths < 100 && last < high; tenths += tenths < 20 ? 1 : tenths < 40 ? 2 : 5) {
            const double value =
                number_in(fmt::format("{}e{}", tenths, ten)).value();  // as people write it, to the last bit
            if (value > low) all.push_back(last = value);
        }
    if (all.empty()) all.push_back(0.0);
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
}

/// The places of the page: the part of the maps that runs came to, in blocks where that is large.
class Places {
public:
    explicit Places(const Raster& reached) : whole_(reached.geometry) {
        Raster came = reached;
        for (double& share : came.values)
            if (!(share > 0.0)) share = Raster::nodata;
        const Raster part = part_with_values(came);
        k_ = blocks_for(part);
        const NodeAt first = first_node(part.geometry, whole_);
        i0_ = first.i, j0_ = first.j;
        raster = largest_in_blocks(part, k_);
        for (const double share : raster.values) rows_.push_back(std::isnan(share) ? -1 : count++);
    }
    /// Row of a pixel; -1 where only runs without weight came.
    Index row(Index pixel) const {
        const Index i = pixel % whole_.nx - i0_, j = pixel / whole_.nx - j0_;
        const GridGeometry& g = raster.geometry;
        if (i < 0 || j < 0 || i / k_ >= g.nx || j / k_ >= g.ny) return -1;
        return rows_[static_cast<std::size_t>(j / k_ * raster.geometry.nx + i / k_)];
    }
    Index block() const { return k_; }
    Raster table(std::size_t columns) const {
        return Raster::filled({static_cast<Index>(columns), count, 0.0, 0.0, 1.0}, Raster::nodata);
    }

    Raster raster;
    Index count = 0;

private:
    /// The smallest blocks of which few enough hold something, and few enough are drawn.
    static Index blocks_for(const Raster& part) {
        constexpr Index kMostDrawn = 1'000'000;
        for (Index k = block_for(part.geometry, kMostDrawn);; ++k) {
            const std::vector<double> blocks = largest_in_blocks(part, k).values;
            const auto held = std::count_if(blocks.begin(), blocks.end(), [](double share) { return share > 0.0; });
            if (static_cast<Index>(held) <= kMostPlaces) return k;
        }
    }

    GridGeometry whole_;
    Index k_ = 1, i0_ = 0, j0_ = 0;
    std::vector<Index> rows_;  ///< by pixel of the raster; -1: none
};

void keep_largest(double& kept, double value) {
    if (!(kept >= value)) kept = value;
}

class ViewMaker {
public:
    ViewMaker(const EnsemblePlan& plan, const EnsembleBase& base, const WeightedRuns& runs,
              const EnsembleSummary& summary)
        : plan_(plan), base_(base), runs_(runs), summary_(summary) {}

    WebPage page() {
        WebPage page;
        page.title = base_.title, page.bed = base_.bed;
        page.caption = "Probabilities of many runs: " + runs_sentence(summary_);
        page.facts = facts();
        page.footprint_depth = base_.footprint_depth;
        page.survey = base_.footprint;
        if (!base_.path.empty()) page.lines.push_back({"runout path", base_.path});
        for (const Gauge& gauge : base_.gauges) page.gauges.push_back({gauge.name, gauge.point});
        page.runs = runs();
        page.remarks = remarks();
        return page;
    }

private:
    PageRuns runs() {
        PageRuns told;
        PixelValues pixels(base_.whole);
        pixels.gather(*runs_.peaks, runs_.weights, 0);
        const Places places(pixels.reached());
        block_ = places.block();
        told.reached = places.raster;
        const auto [least, most] = std::minmax_element(runs_.weights.begin(), runs_.weights.end());
        told.count = *least == *most ? static_cast<double>(runs_.weights.size()) : 0.0;
        told.effective = summary_.effective;
        told.failed_share = summary_.failed_share;
        told.start = base_.start;
        told.shares = plan_.quantiles;
        for (std::size_t f = 0; f < plan_.fields.size(); ++f) {
            const PeakField& field = peak_field(plan_.fields[f]);
            if (field.is_time) continue;
            if (f > 0) pixels.gather(*runs_.peaks, runs_.weights, f);
            if (field.of_bed && !(pixels.largest() > 0.0)) continue;  // nothing to exceed
            told.ladders.push_back(ladder(f, field, pixels, places));
        }
        return told;
    }

    PageLadder ladder(std::size_t f, const PeakField& field, const PixelValues& pixels, const Places& places) const {
        const auto found = plan_.exceed.find(field.name);
        const std::vector<double> asked = found == plan_.exceed.end() ? std::vector<double>() : found->second;
        const double high = pixels.largest();
        const double low = f == 0 ? base_.footprint_depth : 1e-2 * high;
        PageLadder ladder;
        const std::vector<double> thresholds = thresholds_between(low, high, asked);
        if (!asked.empty())
            ladder.first = static_cast<std::size_t>(std::find(thresholds.begin(), thresholds.end(), asked.front()) -
                                                    thresholds.begin());
        ladder.probabilities = places.table(thresholds.size());
        pixels.for_each_curve(thresholds, [&](Index pixel, const std::vector<double>& shares) {
            const Index row = places.row(pixel);
            if (row < 0) return;
            for (std::size_t k = 0; k < shares.size(); ++k)
                keep_largest(ladder.probabilities.at(static_cast<Index>(k), row), shares[k]);
        });
        const ShownUnit unit = shown_unit(field);
        ladder.name = field.name, ladder.label = field.meaning, ladder.unit = unit.name;
        for (const double threshold : thresholds) ladder.thresholds.push_back(threshold * unit.factor);
        ladder.quantiles = quantiles(pixels, places, unit.factor);
        return ladder;
    }

    Raster quantiles(const PixelValues& pixels, const Places& places, double factor) const {
        Raster table = places.table(plan_.quantiles.size());
        const Raster reached = pixels.reached();
        pixels.for_each_quantile(plan_.quantiles, [&](std::size_t k, const Raster& map) {
            for (std::size_t n = 0; n < map.values.size(); ++n)
                if (reached.values[n] > 0.0)
                    keep_largest(table.at(static_cast<Index>(k), places.row(static_cast<Index>(n))),
                                 factor * map.values[n]);
        });
        return table;
    }

    /// "2 to 6 m", or how many values: where the distribution lacks an end, both are those of the samples.
    std::string range_of(std::size_t key) const {
        double low = INFINITY, high = -INFINITY;
        for (const SamplePoint& point : plan_.points) {
            if (!(point.weight > 0.0)) continue;  // in none of the maps
            const std::string& text = point.values[key];
            const std::optional<double> number = number_in(text);
            if (!number) return choices_of(key);
            low = std::min(low, *number), high = std::max(high, *number);
        }
        const Distribution& drawn = plan_.vary[key].distribution;
        const bool known = plan_.method != Method::table && drawn.kind != Distribution::Kind::discrete;
        if (known && std::isfinite(drawn.low) && std::isfinite(drawn.high)) low = drawn.low, high = drawn.high;
        const Parameter* parameter = find_parameter(plan_.vary[key].key);
        const std::string unit = parameter == nullptr || parameter->unit == "1" ? "" : parameter->unit;
        return fmt::format("{:.6g} to {:.6g}{}{}", low, high, unit.empty() ? "" : "\u2009", unit);
    }

    std::string choices_of(std::size_t key) const {
        std::set<std::string> values;
        for (const SamplePoint& point : plan_.points)
            if (point.weight > 0.0) values.insert(point.values[key]);
        return fmt::format("{} choices", values.size());
    }

    std::vector<std::pair<std::string, std::string>> facts() const {
        std::vector<std::pair<std::string, std::string>> facts = {
            {"Runs", fmt::format("{} of {}", summary_.run, summary_.samples)},
            {"Failed", fmt::format("{}", summary_.failed)}};
        for (std::size_t k = 0; k < plan_.vary.size(); ++k) facts.emplace_back(plan_.vary[k].key, range_of(k));
        const bool seeded = plan_.method != Method::table && plan_.method != Method::grid;
        facts.emplace_back("Samples by",
                           seeded ? fmt::format("{}, seed {}", plan_.method_name, plan_.seed) : plan_.method_name);
        const Outcome far = runout();
        for (const double q : plan_.quantiles)
            facts.emplace_back(fmt::format("Runout, {:g} % of the runs at most", 100.0 * q),
                               fmt::format("{:.0f}\u2009m", runs_.quantile(far, q)));
        return facts;
    }

    std::vector<std::string> remarks() const {
        std::vector<std::string> all = {
            "A share of runs is the probability of an event only as far as what varies, and how, is known."};
        if (plan_.method != Method::random)
            all.emplace_back(
                "The 95 % bounds are those of independent runs (Wilson). Samples that are spread evenly err less.");
        if (block_ > 1)
            all.push_back(fmt::format(
                "Probabilities are shown in blocks of {0} x {0} cells, each with its largest. So areas are too large.",
                block_));
        return all;
    }

    const EnsemblePlan& plan_;
    const EnsembleBase& base_;
    const WeightedRuns& runs_;
    const EnsembleSummary& summary_;
    Index block_ = 1;
};

}  // namespace

void write_view(const fs::path& dir, const EnsemblePlan& plan, const EnsembleBase& base, const WeightedRuns& runs,
                EnsembleSummary& summary) {
    if (!(base.whole == base.bed.geometry) || !no_page_reason().empty()) return;
    write_text(dir / "figures" / "view.html", web_page(ViewMaker(plan, base, runs, summary).page()));
    summary.files.emplace_back("figures/view.html");
}

}  // namespace frana
