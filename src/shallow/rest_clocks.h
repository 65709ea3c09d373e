#pragma once
// How long each node has been at rest: what a deposit goes by (THEORY.md, section 20).
#include <vector>

#include "observe/archive.h"
#include "shallow/flow.h"

namespace frana {

/// A node with material rests in a step when the grid update left it only velocity that counts as rest.
/// That is so whatever comes in from what moves next to it. Material that has only been made faster so far is about to
/// begin. Before it rests it has to be held, to get no faster, or to have been faster once. Clocks run for nodes in reach;
/// elsewhere they stand at 0.
class RestClocks {
public:
    RestClocks() = default;
    explicit RestClocks(const TileGrid& grid);

    /// After the gather of a step of `dt` [s], while the nodes are those of the deposit before it. What is no faster than
    /// `slowest` [m/s] rests.
    void tick(const Flow& flow, double dt, double slowest);
    /// What has come to a tile has not moved yet; with `anew` what rested there begins anew, too.
    void begin(const TileGrid& grid, Index tile, bool anew);
    /// Whether a node has rested for `time` [s], one step at least.
    bool have_run(Index k, double time) const { return rested_[k] > 0.0 && rested_[k] >= time; }
    /// The same for some node of a tile.
    bool any_has_run(Index tile, double time) const { return longest_[tile] > 0.0 && longest_[tile] >= time; }
    /// Those of the work list.
    void serialize(Archive& archive, const Flow& flow);
    /// Those of a part of the grid; its node (0, 0) is (east, north) here.
    void take_over(const RestClocks& from, const TileGrid& part, const TileGrid& grid, Index east, Index north);

private:
    void tick_tile(const Flow& flow, Index tile, double dt, double slowest);
    void stop(const TileGrid& grid, Index tile, NodeGroups groups);
    void stop_all(const TileGrid& grid);

    LazyArray<double> rested_;     ///< per node [s]; below 0: its material has moved since it came
    LazyArray<double> longest_;    ///< per tile of the domain, of the last tick [s]
    LazyArray<NodeGroups> known_;  ///< per tile of the domain: groups whose clocks may have run
    std::vector<Index> tiles_;     ///< those with such groups
};

}  // namespace frana
