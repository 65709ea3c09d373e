// The bed of a flow follows what was taken and left (THEORY.md, section 18): slopes, the smoothed bed, its curvature.
#include <algorithm>
#include <cmath>

#include "shallow/erosion.h"
#include "shallow/tiles_around.h"

namespace frana {
namespace {

/// Change of the bed, in cells, from which on its curvature follows.
constexpr double kFollows = 0.01;

/// Adds to a tile's row of nodes what a symmetric filter makes of the values first to last steps away.
void add_filtered(const std::vector<double>& half, Index first, Index last, const double* from, Index step,
                  double* to) {
    Double4 sums[kTile / 4];
    for (Index n = 0; n < kTile / 4; ++n) sums[n] = load(to + 4 * n);
    for (Index a = first; a <= last; ++a) {
        const double w = half[static_cast<std::size_t>(std::abs(a))];
        for (Index n = 0; n < kTile / 4; ++n) sums[n] += w * load(from + a * step + 4 * n);
    }
    for (Index n = 0; n < kTile / 4; ++n) store(to + 4 * n, sums[n]);
}

}  // namespace

/// Slopes follow at once, curvature once the bed has moved far enough. Leaves the tiles where either did in `next_`.
void Erosion::follow_bed(Flow& flow) {
    refresh_moved(flow, nodes_);
    for (const Index tile : next_) changed_[tile] = 1;
    if (!bent_path_) return;
    double most = 0.0;  // of all tiles, or what is symmetric would part at their edges
    for (const Index tile : ledger_tiles_) most = std::max(most, tile_pending_[tile]);
    if (!(most > kFollows * flow.cell)) return;
    smooth_into_path(flow);
}

/// Slopes near what moved in those of the tiles that are marked. Leaves these and the tiles next to them in `next_`, none
/// marked.
void Erosion::refresh_moved(Flow& flow, const std::vector<Index>& tiles) {
    const TileGrid& grid = flow.grid;
    list_around(grid, tiles);
    for_each_in_parallel(next_, [&](Index tile) { refresh_slopes(grid, flow.bed, tile, near_moved(grid, tile)); });
    for (const Index tile : next_) moved_[tile] = {};
}

/// Lists the marked of the tiles, and those next to them, each once, and takes the marks away.
void Erosion::list_around(const TileGrid& grid, const std::vector<Index>& tiles) {
    next_.clear();
    for (const Index tile : tiles) {
        if (!(marked_[static_cast<std::size_t>(tile)] & 1)) continue;
        for_each_around(grid, tile, [&](Index to) {
            if (marked_[static_cast<std::size_t>(to)] & 2) return;
            marked_[static_cast<std::size_t>(to)] |= 2;
            next_.push_back(to);
        });
    }
    for (const Index tile : next_) marked_[static_cast<std::size_t>(tile)] = 0;
}

/// Nodes of a tile whose slopes feel what moved, in it or next to it.
TileBox Erosion::near_moved(const TileGrid& grid, Index tile) const {
    TileBox nodes;
    for_each_around(grid, tile, [&](Index from) {
        const Index rows = grid.tiles_x(), dj = tile / rows - from / rows, di = tile % rows - from % rows;
        nodes.add(moved_[from].seen_from(di, dj, kSlopeReach));
    });
    return nodes;
}

/// Smoothing is linear: that of the change is added to the smoothed bed, as far as it reaches.
void Erosion::smooth_into_path(Flow& flow) {
    const TileGrid& grid = flow.grid;
    const Index reach = static_cast<Index>(filter_.size()) - 1, up = grid.stride();
    list_reached(grid, (reach + 2 + kTile - 1) / kTile);
    const Index i_end = grid.tiles_x() * kTile - kTile, j_end = grid.tiles() / grid.tiles_x() * kTile - kTile;
    for_each_in_parallel(next_, [&](Index tile) {
        const Index i0 = grid.tile_i(tile), j0 = grid.tile_j(tile);
        const bool inside = i0 - reach >= -kTile && i0 + kTile + reach <= i_end;
        for (Index j = j0; j < j0 + kTile; ++j) {
            double* const to = &rows_[grid.at(i0, j)];
            const double* const middle = pending_.data() + grid.at(i0, j);
            if (inside) {
                add_filtered(filter_, -reach, reach, middle, 1, to);
                continue;
            }
            for (Index a = -reach; a <= reach; ++a) {
                const Index first = std::max<Index>(0, -kTile - i0 - a), past = std::min(kTile, i_end - i0 - a);
                for (Index i = first; i < past; ++i)
                    to[i] += filter_[static_cast<std::size_t>(std::abs(a))] * middle[i + a];
            }
        }
    });
    for_each_in_parallel(next_, [&](Index tile) {
        const Index i0 = grid.tile_i(tile), j0 = grid.tile_j(tile);
        for (Index j = j0; j < j0 + kTile; ++j)
            add_filtered(filter_, std::max(-reach, -kTile - j), std::min(reach, j_end - 1 - j),
                         rows_.data() + grid.at(i0, j), up, &flow.bed.smoothed[grid.at(i0, j)]);
    });
    for_each_in_parallel(next_, [&](Index tile) {
        for_each_node_of(grid, tile, [&](Index k, Index, Index) { pending_[k] = rows_[k] = 0.0; });
        refresh_path(grid, flow.bed, tile);
    });
    for (const Index tile : next_) {
        marked_[static_cast<std::size_t>(tile)] = 0, changed_[tile] = 1;
        tile_pending_[tile] = 0.0;
    }
}

/// Lists the tiles that are so many away from one whose bed has sunk.
void Erosion::list_reached(const TileGrid& grid, Index far) {
    next_.clear();
    for (const Index tile : ledger_tiles_) {
        if (!(tile_pending_[tile] > 0.0)) continue;
        const Index width = grid.tiles_x(), column = tile % width;
        for (Index dj = -far; dj <= far; ++dj)
            for (Index di = -far; di <= far; ++di) {
                const Index to = tile + dj * width + di;
                if (column + di < 0 || column + di >= width || to < 0 || to >= grid.tiles()) continue;
                if (marked_[static_cast<std::size_t>(to)]) continue;
                marked_[static_cast<std::size_t>(to)] = 1;
                next_.push_back(to);
            }
    }
}

/// Slopes where z is not what it was, curvature where the smoothed bed is not. They are of tiles that have been
/// restored.
void Erosion::refresh_taken_up(Flow& flow, const std::vector<Index>& tiles, const std::vector<std::uint8_t>& bent) {
    for (const Index tile : tiles) marked_[static_cast<std::size_t>(tile)] = !moved_[tile].empty();
    refresh_moved(flow, tiles);
    if (!bent_path_) return;
    for (std::size_t n = 0; n < tiles.size(); ++n) marked_[static_cast<std::size_t>(tiles[n])] = bent[n];
    list_around(flow.grid, tiles);
    for_each_in_parallel(next_, [&](Index tile) { refresh_path(flow.grid, flow.bed, tile); });
}

}  // namespace frana
