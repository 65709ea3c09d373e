#include "vtk_io/figures/shared_view.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "vtk_io/figures/map_range.h"

namespace frana {

void SharedView::add(const MapFigure& map) {
    constexpr std::size_t stride = 5;  // a fifth of the nodes says as much as all
    const std::vector<double>& outlined = map.outlined();
    std::size_t wet = 0;
    for (std::size_t i = 0; i < map.field.size(); ++i) {
        if (!(std::abs(outlined[i]) > map.shown_above)) continue;
        most_ = std::max(most_, map.field[i]);
        if (wet++ % stride == 0) shown_.push_back(static_cast<float>(map.field[i]));
    }
    range_.reset();
    top_ = map.thick_release ? Top::flow : Top::percentile;
    colormap_ = map.colormap;
    any_ = true;
    const auto hold = [&](const std::array<double, 4>& part) { covered_ = covered_ ? united(*covered_, part) : part; };
    if (const auto covered = covered_extent(map.bed.geometry, map.outlined(), map.shown_above)) hold(*covered);
    if (map.survey && !map.survey->parts.empty()) hold(extent_of(*map.survey));
}

const ColourRange& SharedView::range() const {
    if (range_) return *range_;
    range_ = colour_range({shown_.begin(), shown_.end()}, kAll, colormap_, {}, top_);
    range_->most = most_;
    range_->more_above = most_ > range_->high;
    return *range_;
}

void SharedView::apply(MapFigure& map) const {
    expect(any_, "a view shared by no maps");
    map.range = {range().low, range().high};
    if (!covered_ || map.focus) return;
    const auto& view = *covered_;
    const double rim = 0.08 * std::max(view[2] - view[0], view[3] - view[1]);
    map.focus = {view[0] - rim, view[1] - rim, view[2] + rim, view[3] + rim};
}

}  // namespace frana
