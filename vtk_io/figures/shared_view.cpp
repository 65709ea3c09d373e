#include "vtk_io/figures/shared_view.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "vtk_io/figures/map_range.h"

namespace frana {

void SharedView::add(const MapFigure& map) {
    constexpr std::size_t stride = 5;  // a fifth of the nodes says as much as all
    const std::vector<double>& outlined = map.outlined();
    for (std::size_t i = 0; i < map.field.size(); i += stride)
        if (std::abs(outlined[i]) > map.shown_above) shown_.push_back(map.field[i]);
    colormap_ = map.colormap;
    any_ = true;
    const auto hold = [&](const std::array<double, 4>& part) { covered_ = covered_ ? united(*covered_, part) : part; };
    if (const auto covered = covered_extent(map.bed.geometry, map.outlined(), map.shown_above)) hold(*covered);
    if (map.survey && !map.survey->parts.empty()) hold(extent_of(*map.survey));
}

void SharedView::apply(MapFigure& map) const {
    expect(any_, "a view shared by no maps");
    const ColourRange range = colour_range(shown_, kAll, colormap_, {});
    map.range = {range.low, range.high};
    if (!covered_ || map.focus) return;
    const auto& view = *covered_;
    const double rim = 0.08 * std::max(view[2] - view[0], view[3] - view[1]);
    map.focus = {view[0] - rim, view[1] - rim, view[2] + rim, view[3] + rim};
}

}  // namespace frana
