#pragma once
// Values of the nodes of a terrain on the storage of a grid.
#include <algorithm>
#include <utility>
#include <vector>

#include "base/node_values.h"
#include "mpm/tile_grid.h"

namespace frana {

/// `of_nodes`: row after row from the south. Nodes beyond the grid have what the nearest one in it has.
template <class T>
LazyArray<T> on_storage(const std::vector<T>& of_nodes, const TileGrid& grid) {
    LazyArray<T> values(grid.size());
    const Index rows = grid.size() / grid.stride() - kTile, columns = grid.stride() - kTile;
    for (Index j = -kTile; j < rows; ++j)
        for (Index i = -kTile; i < columns; ++i) {
            const Index row = std::clamp<Index>(j, 0, grid.ny() - 1), column = std::clamp<Index>(i, 0, grid.nx() - 1);
            values[grid.at(i, j)] = of_nodes[static_cast<std::size_t>(row * grid.nx() + column)];
        }
    return values;
}

/// The memory behind NodeValues.
template <class T>
class OnNodes {
public:
    explicit OnNodes(const T& everywhere) : values_(1) { values_[0] = everywhere; }
    explicit OnNodes(LazyArray<T> of_nodes) : values_(std::move(of_nodes)), mask_(-1) {}
    const T& operator[](Index k) const { return values_[k & mask_]; }
    NodeValues<T> view() const { return {values_.data(), mask_}; }

private:
    LazyArray<T> values_;
    Index mask_ = 0;
};

}  // namespace frana
