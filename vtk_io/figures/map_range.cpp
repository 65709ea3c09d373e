#include "vtk_io/figures/map_range.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "vtk_io/figures/chart_figure_ticks.h"

namespace frana {

ColourRange colour_range(const std::vector<double>& field, double shown_above, Colormap map,
                         const std::optional<std::pair<double, double>>& given, Top top) {
    std::vector<double> shown;
    for (const double value : field)
        if (std::abs(value) > shown_above) shown.push_back(value);
    ColourRange range;
    if (given) {
        range.low = given->first;
        range.high = given->second;
    } else if (!shown.empty()) {
        std::vector<double> sorted = shown;
        if (map == Colormap::diverging)
            for (double& value : sorted) value = std::abs(value);
        const auto quantile = [&](double share) {
            const auto place = sorted.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(sorted.size()));
            std::nth_element(sorted.begin(), place, sorted.end());
            return *place;
        };
        constexpr double above_most = 3.0;  // an even spread of values, and a steep decay, stay as they are
        const double usual = quantile(0.75), high = quantile(0.995);
        const double limit = top == Top::flow && usual > 0.0 ? std::min(high, above_most * usual) : high;
        const double smallest = *std::min_element(sorted.begin(), sorted.end());
        range.high = limit > 0.0 ? round_limit(limit) : 0.0;
        range.low = smallest < 0.0 ? -round_limit(-smallest) : 0.0;
        if (map == Colormap::diverging) range.low = -range.high;
    }
    if (!(range.high > range.low)) range.high = range.low + 1.0;
    for (const double value : shown) {
        range.most = std::max(range.most, value);
        range.more_above = range.more_above || value > range.high;
        range.more_below = range.more_below || value < range.low;
    }
    return range;
}

std::optional<std::array<double, 4>> covered_extent(const GridGeometry& grid, const std::vector<double>& field,
                                                    double shown_above) {
    expect(field.size() == static_cast<std::size_t>(grid.size()), "the field of a figure has one value per node");
    std::array<Index, 4> box{grid.nx, grid.ny, -1, -1};
    for (Index j = 0; j < grid.ny; ++j)
        for (Index i = 0; i < grid.nx; ++i) {
            if (!(std::abs(field[static_cast<std::size_t>(j * grid.nx + i)]) > shown_above)) continue;
            box = {std::min(box[0], i), std::min(box[1], j), std::max(box[2], i), std::max(box[3], j)};
        }
    if (box[2] < 0) return std::nullopt;
    const double half = 0.5 * grid.cell;
    return std::array<double, 4>{grid.x(box[0]) - half, grid.y(box[1]) - half, grid.x(box[2]) + half,
                                 grid.y(box[3]) + half};
}

std::array<double, 4> united(const std::array<double, 4>& a, const std::array<double, 4>& b) {
    return {std::min(a[0], b[0]), std::min(a[1], b[1]), std::max(a[2], b[2]), std::max(a[3], b[3])};
}

std::array<double, 4> extent_of(const Polygons& polygons) {
    std::array<double, 4> box{1e300, 1e300, -1e300, -1e300};
    for (const auto& part : polygons.parts)
        for (const auto& ring : part.rings)
            for (const Vec2& v : ring) box = united(box, {v.x(), v.y(), v.x(), v.y()});
    return box;
}

std::vector<double> inside_outline(std::vector<double> field, const std::vector<double>& outlined, double shown_above) {
    for (std::size_t i = 0; i < field.size(); ++i)
        if (!(std::abs(outlined[i]) > shown_above)) field[i] = std::numeric_limits<double>::quiet_NaN();
    return field;
}

ColourRange colours_within(const std::vector<double>& field, const std::vector<double>& outlined, double shown_above,
                           Colormap map, const std::optional<std::pair<double, double>>& given, Top top) {
    if (outlined.empty()) return colour_range(field, shown_above, map, given, top);
    return colour_range(inside_outline(field, outlined, shown_above), kAll, map, given, top);
}

}  // namespace frana
