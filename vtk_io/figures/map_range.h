#pragma once
// What a map shows: the limits of its colours, and the part of the terrain that is covered.
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "base/colour.h"
#include "terrain/raster.h"

namespace frana {

/// Limits of the colours. They are given, or go from zero (the smallest value, when negative) to a round number. That
/// is at or above the 99.5th percentile of the values shown. Symmetric about zero for the diverging map.
struct ColourRange {
    double low = 0.0, high = 1.0;
    bool more_below = false, more_above = false;
    double most = 0.0;  ///< largest value that is shown
};
/// `flow`: no further than three times what three quarters of the values are below. A thick release would turn all of the
/// runout into one colour.
enum class Top { percentile, flow };
ColourRange colour_range(const std::vector<double>& field, double shown_above, Colormap map,
                         const std::optional<std::pair<double, double>>& given, Top top = Top::percentile);

/// [xmin, ymin, xmax, ymax] of all nodes where |field| exceeds the limit, half a cell wider; nothing when
/// none.
std::optional<std::array<double, 4>> covered_extent(const GridGeometry& grid, const std::vector<double>& field,
                                                    double shown_above);
/// The smallest rectangle round both.
std::array<double, 4> united(const std::array<double, 4>& a, const std::array<double, 4>& b);
std::array<double, 4> extent_of(const Polygons& polygons);

/// The field where |outlined| exceeds the limit, elsewhere NaN; every number of it is then shown.
std::vector<double> inside_outline(std::vector<double> field, const std::vector<double>& outlined, double shown_above);
constexpr double kAll = -1.0;  ///< "shown above" that hides NaN only
/// The limits of the colours of a field that is shown where `outlined` exceeds the limit. Empty: where the field does.
ColourRange colours_within(const std::vector<double>& field, const std::vector<double>& outlined, double shown_above,
                           Colormap map, const std::optional<std::pair<double, double>>& given,
                           Top top = Top::percentile);

}  // namespace frana
