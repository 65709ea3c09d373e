#pragma once
// Material at rest sleeps, tile by tile. What cannot change is not computed again, and the run has the same bits.
//
// A tile sleeps when kAsleep gathers (mpm/tile_grid.h) in a row found all its points without velocity and gradient.
// Splitting and merging, which come every few steps, must have found nothing to do there since. Its points then stay as
// they are, and so does what they deposit. While any tile sleeps, a step goes over
// - the points of tiles awake and of tiles that reach a node in motion or deposited anew (`gathers`),
// - the points of tiles that reach a node which a tile awake reaches (`deposits`): its sums are made again, in their
//   order,
// - the nodes near such nodes (`active`).
// All others stay as they were, and sums over tiles count them as they are.
#include <vector>

#include "mpm/node_groups.h"
#include "shallow/nodes.h"

namespace frana {

struct Flow;
class GridUpdateKernel;

/// A group's deposits, put aside.
struct SavedGroup {
    Deposit deposit[4];
    double mass[4], column_mass[4];
};

/// What a step may skip. Arrays hold one entry per tile of the domain, good for tiles of the work list.
struct Rest {
    explicit Rest(const TileGrid& grid)
        : moving(grid.tiles()),
          changed(grid.tiles()),
          frozen(grid.tiles()),
          active(grid.tiles()),
          known(grid.tiles()) {}

    LazyArray<NodeGroups> moving;    ///< groups with a node in motion after the last grid update
    LazyArray<NodeGroups> changed;   ///< groups that the last deposit made anew
    LazyArray<NodeGroups> frozen;    ///< groups that sleeping points touch a second time and that must not change
    LazyArray<std::uint8_t> active;  ///< 1: the passes go over this tile
    LazyArray<std::uint8_t> known;   ///< 1: was on the work list of the last deposit
    std::vector<std::uint8_t> gathers, deposits;  ///< by position in ActiveTiles
    bool some_asleep = false;                     ///< in the present deposit; otherwise it is of all points
    bool settled = false;                         ///< points were split and merged after the last gather
    std::vector<Index> work_before;               ///< work list of the last deposit
    std::vector<SavedGroup> saved;
};

/// Before a gather, after the grid update: which tiles' points can change.
void choose_gathers(Flow& flow);

/// After the gather of the n-th tile: whether all its points are at rest.
void note_rest(Flow& flow, Index n, bool at_rest);

/// After a gather, before points change tiles: what tiles awake had in reach will change.
void note_changed(Flow& flow);

/// Between a gather and the next deposit. A tile's points will not stay as they are, and what they reached will change.
void wake(Flow& flow, Index tile);

/// Whether tiles sleep at this moment.
bool some_asleep(const Flow& flow);

/// Before a deposit: which tiles' points deposit, and which nodes change. Points touch nodes from `before` before the first
/// of their quadratic stencil to `after` behind it. Clears those nodes; puts aside what sleeping points would double.
void start_deposit(Flow& flow, int before, int after);

/// After a deposit: puts back what was put aside, and marks nodes in reach and near (Flow).
void finish_deposit(Flow& flow);

/// Before the passes over nodes: which tiles they visit. A change is felt 15 nodes away at most, that is in the next
/// tile. (The margin's flags make 2, the filter 2, each of three sweeps along the shore 3, the grid update 2. Where no
/// shore is near, the filter's four more passes make 8.) A tile that falls still is left only when friction holds it whatever the length of a step.
void choose_active(Flow& flow, const GridUpdateKernel& grid_update);

/// What follows from Flow::in_reach when nothing sleeps: which nodes are near, and that passes visit all tiles.
void activate_all(Flow& flow);

/// Takes all nodes of the work list for in reach and active.
void reach_all(Flow& flow);

}  // namespace frana
