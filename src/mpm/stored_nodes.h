#pragma once
// What a model saves of the nodes of some tiles, each node's numbers beside one another.
#include <array>
#include <string>
#include <tuple>
#include <vector>

#include "mpm/stored_points.h"
#include "mpm/tile_grid.h"

namespace frana {

/// at(k): where node k has them, k its index on the storage, as std::array<double*, N>. The tiles are those of `grid`.
template <class At>
void serialize_nodes(Archive& archive, const std::string& name, const TileGrid& grid, const std::vector<Index>& tiles,
                     const At& at) {
    constexpr std::size_t kNumbers = std::tuple_size_v<decltype(at(Index{}))>, kNodes = kTile * kTile;
    const auto each = [&](const auto& body) {
        for (const Index tile : tiles)
            for (Index j = 0; j < kTile; ++j) {
                const Index row = grid.at(grid.tile_i(tile), grid.tile_j(tile) + j);
                for (Index i = 0; i < kTile; ++i)
                    for (double* number : at(row + i)) body(number);
            }
    };
    const std::size_t count = tiles.size() * kNodes * kNumbers;
    std::vector<double> values;
    values.reserve(archive.loading() ? 0 : count);
    if (!archive.loading()) each([&](const double* number) { values.push_back(*number); });
    archive.array(name, values);
    if (values.size() != count) throw misfit("its nodes are not those of the tiles");
    const double* from = values.data();
    if (archive.loading()) each([&](double* number) { *number = *from++; });
}

}  // namespace frana
