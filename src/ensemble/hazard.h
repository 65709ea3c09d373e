#pragma once
// Classes of hazard: how strong a flow comes to a place, and how seldom.
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "terrain/sparse_rasters.h"

namespace frana {

/// A class of hazard, and the colour it is drawn in.
struct HazardClass {
    std::string name;
    std::array<std::uint8_t, 3> colour{};  ///< red, green, blue
};

/// How strong a flow is: it has come, and each of these peaks is reached.
struct HazardLevel {
    std::string name;
    std::map<std::string, double> at_least;  ///< by field, in its unit
    std::vector<std::size_t> classes;        ///< by column of years; 0: none
};

/// Which strength, how often, is which class.
struct HazardTable {
    std::string preset;                 ///< its name; empty: the user's own
    std::vector<HazardClass> classes;   ///< from the least to the greatest hazard; class n has the number n + 1
    std::vector<HazardLevel> levels;    ///< from the weakest to the strongest
    std::vector<double> years;          ///< ascending; column k is up to years[k], one more column is beyond
    double share = 0.5;                 ///< of a scenario's runs, that makes a strength the scenario's
    std::optional<double> event_years;  ///< return period of what all runs are of, where they are no scenarios

    std::size_t column_of(double return_period) const;
};

/// Published tables, by name. Sources stand in apps/README.md.
const std::vector<HazardTable>& hazard_presets();

/// Where a run came, and how strong.
struct ReachedLevels {
    std::vector<SparseRasters::Row> rows;
    std::vector<std::uint16_t> strongest;  ///< by pixel: one more than the number of the strongest level; 0: none
};

/// Of a run's peaks, whose fields are `fields`; those of the table are among them.
ReachedLevels reached_levels(const HazardTable& table, const std::vector<std::string>& fields,
                             const SparseRasters& peaks);

/// What the classes need of a run.
struct HazardRun {
    const ReachedLevels* reached = nullptr;  ///< none: it has no answer
    double weight = 1.0;
    double return_period = 0.0;  ///< of its scenario [years]; not used with `event_years`
};

/// What runs without an answer are taken for: left out, or one of two ends. Those that came everywhere did so where any
/// other run came, as strong as the highest level of the table. The ends bound the class if a table's never falls with
/// strength and never rises with years.
enum class Unanswered { left_out, came_nowhere, came_everywhere };

/// The number of the class on each pixel, 0 for none. The runs' levels are those of the table.
/// Scenarios: each has the strength that at least `share` of its runs reach. The class is the greatest of all
/// scenarios'. Otherwise each strength comes back after event_years over the share of the runs that reach it. The class
/// is the greatest of all strengths'.
std::vector<std::uint8_t> hazard_classes(const HazardTable& table, const std::vector<HazardRun>& runs, Index pixels,
                                         Unanswered unanswered = Unanswered::left_out);

}  // namespace frana
