#include "compare/blocks.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "compare/pixel_pairs.h"

namespace frana {
namespace {

struct Block {
    double simulated = 0.0, surveyed = 0.0;  ///< sums [m]
    Index pixels = 0;                        ///< that have both
    bool empty = true;                       ///< all of them are zero
};

}  // namespace

BlockErrors block_errors(const Raster& simulated, const Raster& surveyed, double side) {
    const GridGeometry& grid = surveyed.geometry;
    const double longest = static_cast<double>(std::max(grid.nx, grid.ny));
    const auto across = static_cast<Index>(std::clamp(std::round(side / grid.cell), 1.0, longest));
    const Index columns = (grid.nx + across - 1) / across, rows = (grid.ny + across - 1) / across;
    std::vector<Block> blocks(static_cast<std::size_t>(columns * rows));
    for_each_pair(simulated, surveyed, [&](Index i, Index j, double ours, double theirs) {
        if (std::isnan(ours) || std::isnan(theirs)) return;
        Block& block = blocks[static_cast<std::size_t>(j / across * columns + i / across)];
        block.simulated += ours, block.surveyed += theirs;
        ++block.pixels;
        if (ours != 0.0 || theirs != 0.0) block.empty = false;
    });
    BlockErrors errors;
    double square = 0.0;
    for (const Block& block : blocks) {
        if (block.empty) continue;
        const auto pixels = static_cast<double>(block.pixels);
        const double apart = (block.simulated - block.surveyed) / pixels,
                     share = pixels / static_cast<double>(across * across);
        square += share * apart * apart;
        errors.number += share;
    }
    if (errors.number > 0.0) errors.rms = std::sqrt(square / errors.number);
    return errors;
}

}  // namespace frana
