#pragma once
// Numbers on a grid as a page holds them: whole numbers of one or two bytes, made small.
#include <cstdint>
#include <string>
#include <vector>

#include "terrain/raster.h"

namespace frana {

/// A raster in steps of one height: value = low + step (code - 1); code 0 is no value. Each code is predicted from its
/// neighbours to the west and south. The difference is stored modulo 65536, with the sign in the lowest bit. First come
/// all high bytes, then all low ones, deflated.
struct PackedRaster {
    GridGeometry grid;
    double low = 0.0, step = 1.0;
    std::vector<std::uint8_t> bytes;
};

/// The raster with at most 65535 steps, of `finest` or more. What is between two steps is rounded to the nearer one.
PackedRaster packed(const Raster& raster, double finest);
/// It back, to half a step.
Raster unpacked(const PackedRaster& raster);

/// Depth and speed at an output, cut to where it is wet. A byte a pixel: value = top ((byte - 1/2) / steps)^2, 0 is none; it
/// was rounded up, so thin flow is not lost. Thus a value v is known to sqrt(v top) / steps, of 255 for depth and 63 for speed.
struct PackedFrame {
    Index number = 0;                     ///< of the output
    double time = 0.0;                    ///< [s]
    GridGeometry grid;                    ///< of the stored pixels: none where nothing is wet
    double deepest = 0.0, fastest = 0.0;  ///< top: that the last step ends at [m], [m/s]
    bool has_speed = false;
    std::vector<std::uint8_t> bytes;  ///< deflated: depths, then speeds
    double lying = 0.0;               ///< of what has become bed, which is a part of the depth [m3]
};

/// Depth and speed on the nodes of a grid [m], [m/s].
struct FlowFields {
    GridGeometry grid;
    const double* depth = nullptr;
    const double* speed = nullptr;  ///< nullptr: not known
};

/// What is deeper than `wet` [m]. Frames of more than `most` pixels are made of blocks, with the largest value in each.
PackedFrame packed(const FlowFields& flow, double wet, Index most);
/// Depths and speeds back, on frame.grid.
struct UnpackedFrame {
    std::vector<double> depth, speed;
};
UnpackedFrame unpacked(const PackedFrame& frame);

/// The part of a raster that has values; of one without any its first pixel.
Raster part_with_values(const Raster& raster);
/// Blocks of k x k nodes, the means of those that have values: for terrain. Blocks without any have none.
Raster in_blocks(const Raster& raster, Index k);
/// Likewise with the largest values: for what a flow did.
Raster largest_in_blocks(const Raster& raster, Index k);
/// The smallest k with at most `most` such blocks.
Index block_for(const GridGeometry& grid, Index most);

}  // namespace frana
