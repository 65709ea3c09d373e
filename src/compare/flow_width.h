#pragma once
// How wide a flow is: across its footprint, where its two sides face each other.
#include <string>

#include "terrain/raster.h"

namespace frana {

/// Cells across a flow below which it is not resolved: of six, two are its margins. Pixels draw either side a quarter
/// of a cell off, on average. Together this is a twelfth of the width, so that two footprints agree to an IoU of about
/// 0.9.
constexpr double least_cells_across = 6.0;

/// Median width of the footprint across the flow [m]; NaN when nothing is deeper than `limit` [m]. The footprint is
/// all nodes that are deeper, their pixels filled. Holes of up to nine nodes have no banks. The middle of the flow runs
/// between neighbouring nodes whose nearest banks lie in directions more than 120 degrees apart. So ends, corners and
/// ragged edges are none of it. At each such place the width is the length of the section across, averaged over three
/// cells along the flow. The median over these places weights the flow's length, not its area. A footprint that is
/// wider than long is measured along, its narrower way. Area that these sections do not stand for, as in a rhombus, is
/// as wide as the largest circle in the footprint.
double flow_width(const Raster& depth, double limit);

/// The largest of 1, 2, 2.5, 5, 10, ... m, cells of which resolve a flow of this width [m].
double cell_that_resolves(double width);

/// What to tell of a flow with too few cells across it. Empty when they are enough, or when there is no width.
/// `particles`: there are some, whose number counts as well.
std::string width_remark(double width, double cell, bool particles);

}  // namespace frana
