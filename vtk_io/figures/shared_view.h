#pragma once
// Maps of one terrain at several times that can be compared by eye.
#include <array>
#include <optional>
#include <vector>

#include "vtk_io/figures/map_figure.h"
#include "vtk_io/figures/map_range.h"

namespace frana {

/// One colour range and one view for maps of the same terrain. They hold all the maps that were added.
class SharedView {
public:
    void add(const MapFigure& map);
    /// Sets the map's range, and its focus unless it has one. At least one map must have been added.
    void apply(MapFigure& map) const;
    /// The colours of all maps together, for the bar that they share.
    const ColourRange& range() const;

private:
    std::vector<float> shown_;  ///< some of the values of all maps
    double most_ = 0.0;
    Top top_ = Top::percentile;
    mutable std::optional<ColourRange> range_;  ///< after its first use
    Colormap colormap_ = Colormap::depth;
    bool any_ = false;
    std::optional<std::array<double, 4>> covered_;  ///< [m]; nothing where no map shows anything
};

}  // namespace frana
