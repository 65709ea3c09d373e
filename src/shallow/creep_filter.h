#pragma once
// More passes of the surface filter where a flow creeps that is deep beside its cells. THEORY.md, section 6.
#include <cstdint>
#include <vector>

#include "shallow/flow.h"

namespace frana {

/// Slow material on cells much smaller than its depth is filtered again. Otherwise waves of particles that are shorter
/// than two cells would grow there.
class CreepFilter {
public:
    /// `resisted`: the flow has friction or stress. Without them nothing creeps for long, and nothing is done.
    CreepFilter(bool resisted, const TileGrid& grid) : resisted_(resisted), creeps_(grid.size()) {}

    /// After filter(), before shoreline(). `max_depth`: of the flow [m]; below 1.5 cells nothing is done.
    void pass(Flow& flow, double max_depth);

private:
    void find_tiles(const Flow& flow);

    bool resisted_;
    LazyArray<double> creeps_;        ///< how much more of the filter nodes get, whatever their depth [1]
    std::vector<std::uint8_t> some_;  ///< by position in the work list: has such nodes
    std::vector<Index> tiles_;        ///< those that have
};

}  // namespace frana
