#pragma once
// Level lines of a raster, and their labels.
#include <functional>
#include <string>
#include <vector>

#include "base/types.h"
#include "terrain/raster.h"

namespace frana {

/// Lines along which the raster, linear between its nodes, has the given value, in map coordinates. Closed
/// lines repeat their first point. Cells with a NaN corner have none.
std::vector<Polyline> level_lines(const Raster& raster, double level);

/// A label set into a line, and what is left of the line around it.
struct LabelledLine {
    std::vector<std::vector<Vec2>> pieces;
    bool labelled = false;
    Vec2 at{0, 0};       ///< middle of the label [px]
    double angle = 0.0;  ///< in (-90, 90] [degrees]
};

/// Finds the straightest stretch of the line [px] that takes a label of that width [px] and where `free`
/// holds. Without one the line stays whole.
LabelledLine with_label(const std::vector<Vec2>& line, double label_width,
                        const std::function<bool(const Vec2&)>& free);

}  // namespace frana
