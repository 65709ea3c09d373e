#include "compare/refinement.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "compare/overlap.h"

namespace frana {
namespace {

/// Volume of `deposit` in every pixel of another grid, exact for pixels of even depth [m3].
std::vector<double> volumes_on(const GridGeometry& grid, const Raster& deposit) {
    std::vector<double> volumes(static_cast<std::size_t>(grid.size()), 0.0);
    const GridGeometry& fine = deposit.geometry;
    /// Pixels of `grid` along an axis that [low, low + fine.cell] meets, with the length in each.
    const auto for_each_part = [&](double low, double first_node, Index count, const auto& body) {
        const double edge = first_node - 0.5 * grid.cell;
        const auto pixel = [&](double x) { return static_cast<Index>(std::floor((x - edge) / grid.cell)); };
        for (Index k = std::max<Index>(0, pixel(low)); k <= std::min(count - 1, pixel(low + fine.cell)); ++k) {
            const double begin = edge + static_cast<double>(k) * grid.cell;
            const double length = std::min(begin + grid.cell, low + fine.cell) - std::max(begin, low);
            if (length > 0.0) body(k, length);
        }
    };
    for (Index j = 0; j < fine.ny; ++j)
        for (Index i = 0; i < fine.nx; ++i) {
            const double depth = deposit.at(i, j);
            if (!(depth > 0.0)) continue;
            for_each_part(fine.y(j) - 0.5 * fine.cell, grid.y0, grid.ny, [&](Index row, double height) {
                for_each_part(fine.x(i) - 0.5 * fine.cell, grid.x0, grid.nx, [&](Index column, double width) {
                    volumes[static_cast<std::size_t>(row * grid.nx + column)] += depth * width * height;
                });
            });
        }
    return volumes;
}

double relative(double value, double reference) { return std::abs(value - reference) / std::abs(reference); }

/// One way in which a run differs from the finest. It tells whether by more than the rule allows, and both as text.
struct Difference {
    bool allowed;
    std::string found, expected;
};

/// Nothing where neither has one: there is nothing to tell them apart by.
std::optional<Difference> of_runouts(const CellFigures& run, const CellFigures& finest, const ConvergenceRule& rule) {
    if (std::isnan(run.runout) && std::isnan(finest.runout)) return std::nullopt;
    const double change = std::abs(run.runout - finest.runout), most = rule.runout_cells * run.cell;
    return Difference{change <= most,
                      std::isnan(change) ? "the runout is known on one of them only"
                                         : fmt::format("the runout differs by {:.3g} m", change),
                      fmt::format("{:g} m at most", most)};
}

/// Nothing where no bed is erodible. A bed that none of the runs took of agrees.
std::optional<Difference> of_beds(const CellFigures& run, const CellFigures& finest, const ConvergenceRule& rule) {
    if (std::isnan(run.eroded_volume) && std::isnan(finest.eroded_volume)) return std::nullopt;
    const double change =
        run.eroded_volume == finest.eroded_volume ? 0.0 : relative(run.eroded_volume, finest.eroded_volume);
    return Difference{change <= rule.eroded,
                      fmt::format("the volume taken of the bed differs by {:.2g} %", 100.0 * change),
                      fmt::format("{:g} % at most", 100.0 * rule.eroded)};
}

std::vector<Difference> differences(const CellFigures& run, const CellFigures& finest, const ConvergenceRule& rule) {
    const double depth = relative(run.peak_depth, finest.peak_depth);
    const double speed = relative(run.peak_speed, finest.peak_speed);
    const auto peak = [&](const char* name, double change) {
        return Difference{change <= rule.peaks, fmt::format("the peak {} differs by {:.2g} %", name, 100.0 * change),
                          fmt::format("{:g} % at most", 100.0 * rule.peaks)};
    };
    std::vector<Difference> all = {
        {run.iou >= rule.iou, fmt::format("the footprints' IoU is {:.3f}", run.iou),
         fmt::format("{:g} or more", rule.iou)},
        {run.elsewhere <= rule.elsewhere, fmt::format("{:.2g} % of the deposit lies elsewhere", 100.0 * run.elsewhere),
         fmt::format("{:g} % at most", 100.0 * rule.elsewhere)},
        peak("depth", depth),
        peak("speed", speed)};
    if (const auto runouts = of_runouts(run, finest, rule)) all.insert(all.begin(), *runouts);
    if (const auto beds = of_beds(run, finest, rule)) all.push_back(*beds);
    return all;
}

bool agree(const CellFigures& run, const CellFigures& finest, const ConvergenceRule& rule) {
    const std::vector<Difference> found = differences(run, finest, rule);
    return std::all_of(found.begin(), found.end(), [](const Difference& d) { return d.allowed; });
}

/// "a, b and c".
std::string listed(const std::vector<std::string>& parts) {
    std::string text;
    for (std::size_t k = 0; k < parts.size(); ++k)
        text += (k == 0 ? "" : k + 1 == parts.size() ? " and " : ", ") + parts[k];
    return text;
}

/// `run`: the coarsest that is enough or, when none is, the last but one.
std::string sentence_on(const CellFigures& run, const CellFigures& finest, const ConvergenceRule& rule,
                        bool converged) {
    std::vector<std::string> parts;
    for (const Difference& d : differences(run, finest, rule))
        if (converged)
            parts.push_back(d.found);
        else if (!d.allowed)
            parts.push_back(fmt::format("{} (expected {})", d.found, d.expected));
    const char* const without =
        std::isnan(run.runout) && std::isnan(finest.runout) ? " Runouts are not known and were left out." : "";
    if (converged)
        return fmt::format("Converged, and cells of {:g} m are enough: between them and {:g} m {}.{}", run.cell,
                           finest.cell, listed(parts), without);
    return fmt::format("Not converged: between cells of {:g} and {:g} m {}; add a finer cell, such as {:g} m.{}",
                       run.cell, finest.cell, listed(parts), 0.5 * finest.cell, without);
}

}  // namespace

double covered_quantile(const Raster& values, const Raster& depth, double limit, double share) {
    expect(values.geometry == depth.geometry, "rasters of one run have the same nodes");
    std::vector<double> covered;
    for (std::size_t k = 0; k < values.values.size(); ++k)
        if (depth.values[k] > limit && !std::isnan(values.values[k])) covered.push_back(values.values[k]);
    if (covered.empty()) return Raster::nodata;
    const double rank = std::ceil(share * static_cast<double>(covered.size()));
    const auto place = covered.begin() + static_cast<std::ptrdiff_t>(std::max(rank, 1.0)) - 1;
    std::nth_element(covered.begin(), place, covered.end());
    return *place;
}

double footprints_iou(const Raster& depth, const Raster& finest, double limit) {
    return overlap(depth, limit, pixel_outline(finest, limit)).iou();
}

double share_elsewhere(const Raster& deposit, const Raster& finest) {
    const double pixel = deposit.geometry.cell * deposit.geometry.cell,
                 fine_pixel = finest.geometry.cell * finest.geometry.cell;
    double all = 0.0, shared = 0.0;
    for (const double depth : deposit.values)
        if (depth > 0.0) all += depth * pixel;
    const std::vector<double> here = volumes_on(finest.geometry, deposit);
    for (std::size_t k = 0; k < here.size(); ++k)
        if (finest.values[k] > 0.0) shared += std::min(here[k], finest.values[k] * fine_pixel);
    return all > 0.0 ? std::max(0.0, 1.0 - shared / all) : Raster::nodata;
}

std::optional<double> observed_order(const std::array<double, 3>& cells, const std::array<double, 3>& values,
                                     double resolution) {
    const double first = values[0] - values[1], second = values[1] - values[2];
    const bool seen = std::abs(first) > resolution && std::abs(second) > resolution;
    if (!seen || !(first / second > 0.0)) return std::nullopt;
    const auto ratio_at = [&](double p) {
        return (std::pow(cells[0], p) - std::pow(cells[1], p)) / (std::pow(cells[1], p) - std::pow(cells[2], p));
    };
    constexpr double lowest = 1e-3, highest = 8.0;  // beyond these the fit says nothing
    double low = lowest, high = highest;
    if (!(first / second > ratio_at(low) && first / second < ratio_at(high))) return std::nullopt;
    while (high - low > 1e-6) {  // the ratio grows with the order
        const double middle = 0.5 * (low + high);
        (ratio_at(middle) < first / second ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

std::string ConvergenceRule::text() const {
    return fmt::format(
        "A cell agrees with the finest one when the runouts differ by {:g} of the coarser cells at most, the "
        "footprints' IoU is {:g} or more, {:g} % of the deposit's volume at most lies elsewhere, and peak depth and "
        "speed (99.9th percentiles) differ by {:g} % at most, and so do volumes taken of an erodible bed by {:g} %. "
        "The answer has converged when the last cell but one "
        "agrees; enough is the coarsest cell that agrees together with all finer ones.",
        runout_cells, iou, 100.0 * elsewhere, 100.0 * peaks, 100.0 * eroded);
}

double runout_spread(const std::vector<CellFigures>& runs) {
    expect(!runs.empty(), "a spread is of runs");
    double least = runs.front().runout, most = least;
    for (const CellFigures& run : runs) {
        if (std::isnan(run.runout)) return run.runout;
        least = std::min(least, run.runout), most = std::max(most, run.runout);
    }
    return (most - least) / runs.front().cell;
}

std::string spread_sentence(const std::string& key, const std::vector<double>& values,
                            const std::vector<CellFigures>& runs, const ConvergenceRule& rule) {
    expect(values.size() == runs.size() && !runs.empty(), "a run for each value");
    std::vector<std::string> names;
    double elsewhere = 0.0, iou = 1.0;
    for (std::size_t k = 0; k < runs.size(); ++k) {
        names.push_back(fmt::format("{:g}", values[k]));
        elsewhere = std::max(elsewhere, runs[k].elsewhere), iou = std::min(iou, runs[k].iou);
    }
    const double spread = runout_spread(runs);
    const std::string apart = std::isnan(spread) ? "runouts are not known"
                              : spread <= rule.runout_cells
                                  ? fmt::format("the runouts lie {:.2g} cells apart", spread)
                                  : fmt::format(
                                        "the runouts lie {:.2g} cells apart (expected {:g} at most: so far "
                                        "the answer hangs on this choice)",
                                        spread, rule.runout_cells);
    return fmt::format(
        "With {} of {} on cells of {:g} m {}; up to {:.2g} % of the deposit lies elsewhere, and the footprints' IoU is "
        "{:.3f} or more.",
        key, listed(names), runs.front().cell, apart, 100.0 * elsewhere, iou);
}

Verdict judge(const std::vector<CellFigures>& runs, const ConvergenceRule& rule) {
    expect(runs.size() >= 2, "convergence is seen on two cells or more");
    const CellFigures& finest = runs.back();
    std::size_t first = runs.size() - 1;
    while (first > 0 && agree(runs[first - 1], finest, rule)) --first;
    Verdict verdict;
    verdict.converged = first + 1 < runs.size();
    if (verdict.converged) verdict.enough = runs[first].cell;
    verdict.sentence = sentence_on(runs[verdict.converged ? first : runs.size() - 2], finest, rule, verdict.converged);
    return verdict;
}

}  // namespace frana
