#include "terrain/connected_nodes.h"

#include <utility>

#include "terrain/places.h"

namespace frana {

std::vector<Index> take_connected(const GridGeometry& grid, std::vector<char>& marked, Index first) {
    constexpr std::pair<Index, Index> kAround[] = {{1, 0}, {-1, 0}, {0, 1},  {0, -1},
                                                   {1, 1}, {1, -1}, {-1, 1}, {-1, -1}};
    std::vector<Index> nodes;
    const auto take = [&](Index k) {
        if (std::exchange(marked[static_cast<std::size_t>(k)], char{0}) != 0) nodes.push_back(k);
    };
    take(first);
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        const Index i = nodes[n] % grid.nx, j = nodes[n] / grid.nx;
        for (const auto& [di, dj] : kAround)
            if (has_node(grid, {i + di, j + dj})) take((j + dj) * grid.nx + i + di);
    }
    return nodes;
}

}  // namespace frana
