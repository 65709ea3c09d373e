// Other material on the nodes of a depth-averaged run: particles feel how high it stands, not its motion.
#include "base/error.h"
#include "shallow/depth_averaged.h"
#include "shallow/sides.h"

namespace frana {

void DepthAveraged::set_adjacent(const std::vector<double>& depth) {
    expect(static_cast<Index>(depth.size()) == flow_.grid.geometry().size(),
           "every node of the grid has a depth of other material");
    flow_.scheme.sleep = false;  // what is adjacent to sleeping particles may stir them
    for (const Index tile : flow_.active.tile) flow_.active.quiet[tile] = 0;
    timed_("ghost particles", [&] {
        stress_power_ = transfer_->deposit(flow_, 0.5 * (status_.dt + longest_step())).stress_power;
        fold_walls(flow_);
        add_adjacent(depth);
    });
    raise_surface();
}

/// Adds its volume to what the depth is made of, not to the mass that is driven. Its nodes count as in reach.
void DepthAveraged::add_adjacent(const std::vector<double>& depth) {
    const Index nx = flow_.grid.nx(), ny = flow_.grid.ny();
    const double column = flow_.density * flow_.area;
    for_each_work_tile(flow_.active, [&](Index, Index tile) {
        const Index i0 = flow_.grid.tile_i(tile), j0 = flow_.grid.tile_j(tile);
        for_each_node_of(flow_.grid, tile, [&](Index k, Index i, Index j) {
            if (i < 0 || j < 0 || i >= nx || j >= ny) return;
            const double more = depth[static_cast<std::size_t>(j * nx + i)];
            if (!(more > 0.0)) return;
            flow_.nodes.column_mass[k] += column * more;
            flow_.in_reach[tile] |= group_of(i - i0, j - j0);
        });
    });
    activate_all(flow_);
}

}  // namespace frana
