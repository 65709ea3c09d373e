#pragma once
// From pixels to nodes of another spacing, one axis at a time. Free of GDAL, so that it can be tested by
// itself.
#include <functional>
#include <vector>

#include "base/types.h"

namespace frana {

/// Pixels along one axis: pixel k covers [start + k size, start + (k + 1) size].
struct PixelAxis {
    Index count = 0;
    double start = 0.0;  ///< [m]
    double size = 1.0;   ///< [m]
};

/// Weights of the pixels that make one node's value, all on the pixels from `first` on. `fine` is exact for
/// linear fields and may hold small negative numbers; `plain` is non-negative and used next to nodata. Both sum to 1.
/// Where nodes are means, fine is plain plus `moment` times the slope of each pixel.
struct NodeWeights {
    Index first = 0;
    std::vector<double> fine;  ///< empty: the node lies outside the pixels
    std::vector<double> plain;
    std::vector<double> moment;  ///< zero where nodes are interpolated
};

/// Weights for `count` nodes, the first at `x0`, `cell` apart.
///
/// Nodes at least as far apart as pixels take the mean of a field over their own cell. It is linear in each pixel, with
/// the slope of its neighbours. This is the second-order conservative remapping of Jones (1999, Mon. Weather Rev. 127,
/// 2204). Where cells consist of whole pixels it is the plain mean; a field of equal cells is copied. Closer nodes take
/// cubic convolution with a = -1/2 (Keys 1981, IEEE Trans. ASSP 29, 1153), next to nodata linear interpolation. Between
/// the outermost pixel centres and edges the field goes on linearly. Nodes whose cell lies outside the pixels by more
/// than half get no weights. Otherwise the mean is that of the part inside.
std::vector<NodeWeights> axis_weights(const PixelAxis& pixels, double x0, double cell, Index count);

/// An array of pixels that is read by rows: all columns of [first, first + rows). Row 0 = south, NaN where there is no
/// data.
struct PixelRows {
    Index columns = 0, rows = 0;
    std::function<std::vector<double>(Index first, Index count)> read;
};

/// Node values, row 0 = south, x fastest: sum of weights times pixels. Next to NaN the plain weights serve, over what
/// is left. A node is NaN when less than half of its weight is left. Where pixels and all their neighbours are
/// non-negative, slopes are limited so that nothing in the pixel is negative. Depths stay depths, and their volume
/// stays the same. Reads the pixels in strips of bounded size.
std::vector<double> resample(const std::vector<NodeWeights>& in_x, const std::vector<NodeWeights>& in_y,
                             const PixelRows& pixels);

}  // namespace frana
