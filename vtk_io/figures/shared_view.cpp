#include "vtk_io/figures/shared_view.h"

#include <algorithm>

#include "base/error.h"
#include "vtk_io/figures/map_range.h"

namespace frana {

void SharedView::add(const MapFigure& map) {
    const ColourRange own = colours_within(map.field, map.outline_field, map.shown_above, map.colormap, {});
    if (!range_) range_ = {own.low, own.high};
    range_ = {std::min(range_->first, own.low), std::max(range_->second, own.high)};
    const auto hold = [&](const std::array<double, 4>& part) { covered_ = covered_ ? united(*covered_, part) : part; };
    if (const auto covered = covered_extent(map.bed.geometry, map.outlined(), map.shown_above)) hold(*covered);
    if (map.survey && !map.survey->parts.empty()) hold(extent_of(*map.survey));
}

void SharedView::apply(MapFigure& map) const {
    expect(range_.has_value(), "a view shared by no maps");
    map.range = range_;
    if (!covered_ || map.focus) return;
    const auto& view = *covered_;
    const double rim = 0.08 * std::max(view[2] - view[0], view[3] - view[1]);
    map.focus = {view[0] - rim, view[1] - rim, view[2] + rim, view[3] + rim};
}

}  // namespace frana
