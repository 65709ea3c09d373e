#include "ensemble/hazard.h"

#include <algorithm>
#include <limits>

#include "base/error.h"

namespace frana {
namespace {

constexpr double kRoundOff = 1e-9;  ///< of sums of weights, and of their quotients

/// A level's demands on the fields of a run, in the order that these have there.
struct Demand {
    std::size_t field;
    float at_least;
};

std::vector<std::vector<Demand>> demands_of(const HazardTable& table, const std::vector<std::string>& fields) {
    expect(table.levels.size() <= std::numeric_limits<std::uint16_t>::max(), "so many levels can be numbered");
    std::vector<std::vector<Demand>> all;
    for (const HazardLevel& level : table.levels) {
        std::vector<Demand> demands;
        for (const auto& [name, least] : level.at_least) {
            const auto found = std::find(fields.begin(), fields.end(), name);
            expect(found != fields.end(), "the fields of a table of hazard are kept");
            demands.push_back({static_cast<std::size_t>(found - fields.begin()), static_cast<float>(least)});
        }
        all.push_back(demands);
    }
    return all;
}

/// One more than the number of the strongest level whose demands the n-th pixel meets; 0: none.
std::uint16_t strongest(const std::vector<std::vector<Demand>>& levels, const SparseRasters& peaks, std::size_t n) {
    for (std::size_t level = levels.size(); level > 0; --level) {
        const auto& demands = levels[level - 1];
        if (std::all_of(demands.begin(), demands.end(),
                        [&](const Demand& d) { return peaks.values[d.field][n] >= d.at_least; }))
            return static_cast<std::uint16_t>(level);
    }
    return 0;
}

/// By pixel and level, the weight of the runs that reach that level or a stronger one.
class Reached {
public:
    Reached(Index pixels, std::size_t levels, Unanswered unanswered)
        : levels_(levels), unanswered_(unanswered), weights_(static_cast<std::size_t>(pixels) * levels, 0.0) {}

    void add(const HazardRun& run) {
        if (!run.reached) return add_unanswered(run.weight);
        all_ += run.weight;
        SparseRasters::for_each_pixel(run.reached->rows, [&](Index pixel, std::size_t n) {
            for (std::size_t level = run.reached->strongest[n]; level > 0; --level)
                weights_[static_cast<std::size_t>(pixel) * levels_ + level - 1] += run.weight;
        });
    }
    double share(Index pixel, std::size_t level) const {
        const double weight = weights_[static_cast<std::size_t>(pixel) * levels_ + level] + everywhere_;
        return all_ > 0.0 ? weight / all_ : 0.0;
    }

private:
    void add_unanswered(double weight) {
        if (unanswered_ != Unanswered::left_out) all_ += weight;
        if (unanswered_ == Unanswered::came_everywhere) everywhere_ += weight;
    }

    std::size_t levels_;
    Unanswered unanswered_;
    std::vector<double> weights_;
    double all_ = 0.0, everywhere_ = 0.0;
};

/// The class of a scenario's strength, the strongest that enough of its runs reach.
std::size_t class_of_scenario(const HazardTable& table, const Reached& reached, Index pixel, double return_period) {
    std::size_t levels = 0;
    while (levels < table.levels.size() && reached.share(pixel, levels) >= table.share * (1.0 - kRoundOff)) ++levels;
    return levels > 0 ? table.levels[levels - 1].classes[table.column_of(return_period)] : 0;
}

/// The greatest class of all strengths, each as seldom as it is.
std::size_t class_by_frequency(const HazardTable& table, const Reached& reached, Index pixel) {
    std::size_t most = 0;
    for (std::size_t level = 0; level < table.levels.size() && reached.share(pixel, level) > 0.0; ++level) {
        const double years = *table.event_years / reached.share(pixel, level);
        most = std::max(most, table.levels[level].classes[table.column_of(years)]);
    }
    return most;
}

/// Where any run came.
std::vector<char> pixels_reached(const std::vector<HazardRun>& runs, Index pixels) {
    std::vector<char> reached(static_cast<std::size_t>(pixels), 0);
    for (const HazardRun& run : runs)
        if (run.reached)
            SparseRasters::for_each_pixel(
                run.reached->rows, [&](Index pixel, std::size_t) { reached[static_cast<std::size_t>(pixel)] = 1; });
    return reached;
}

}  // namespace

std::size_t HazardTable::column_of(double return_period) const {
    const auto column = std::find_if(years.begin(), years.end(),
                                     [&](double up_to) { return return_period <= up_to * (1.0 + kRoundOff); });
    return static_cast<std::size_t>(column - years.begin());
}

ReachedLevels reached_levels(const HazardTable& table, const std::vector<std::string>& fields,
                             const SparseRasters& peaks) {
    const auto demands = demands_of(table, fields);
    ReachedLevels reached{peaks.rows, {}};
    peaks.for_each([&](Index, std::size_t n) { reached.strongest.push_back(strongest(demands, peaks, n)); });
    return reached;
}

std::vector<std::uint8_t> hazard_classes(const HazardTable& table, const std::vector<HazardRun>& runs, Index pixels,
                                         Unanswered unanswered) {
    std::map<double, std::vector<const HazardRun*>> scenarios;
    for (const HazardRun& run : runs) scenarios[table.event_years ? 0.0 : run.return_period].push_back(&run);
    std::vector<std::uint8_t> classes(static_cast<std::size_t>(pixels), 0);
    const std::vector<char> came = pixels_reached(runs, pixels);
    for (const auto& [return_period, members] : scenarios) {
        Reached reached(pixels, table.levels.size(), unanswered);
        for (const HazardRun* run : members) reached.add(*run);
        for (Index pixel = 0; pixel < pixels; ++pixel) {
            if (!came[static_cast<std::size_t>(pixel)]) continue;
            const std::size_t found = table.event_years ? class_by_frequency(table, reached, pixel)
                                                        : class_of_scenario(table, reached, pixel, return_period);
            std::uint8_t& most = classes[static_cast<std::size_t>(pixel)];
            most = std::max(most, static_cast<std::uint8_t>(found));
        }
    }
    return classes;
}

const std::vector<HazardTable>& hazard_presets() {
    static const std::vector<HazardClass> classes = {
        {"residual", {255, 255, 170}}, {"low", {255, 221, 0}}, {"medium", {60, 120, 220}}, {"high", {216, 30, 40}}};
    constexpr std::size_t residual = 1, low = 2, medium = 3, high = 4;
    static const std::vector<double> years = {30.0, 100.0, 300.0};
    static const std::vector<HazardTable> presets = {
        {"swiss_avalanche",
         classes,
         {{"below 30 kPa", {}, {high, medium, medium, residual}},
          {"30 kPa or more", {{"peak_dynamic_pressure", 30e3}}, {high, high, high, residual}}},
         years,
         0.5,
         std::nullopt},
        {"swiss_debris_flow",
         classes,
         {{"medium", {}, {medium, medium, low, residual}},
          {"strong", {{"peak_depth", 1.0}, {"peak_speed", 1.0}}, {high, high, high, residual}}},
         years,
         0.5,
         std::nullopt}};
    return presets;
}

}  // namespace frana
