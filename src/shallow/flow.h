#pragma once
// Everything the phases of a depth-averaged step share.
#include "base/error.h"
#include "base/simd.h"
#include "mpm/node_groups.h"
#include "mpm/tile_grid.h"
#include "scene/scene.h"
#include "shallow/bed_geometry.h"
#include "shallow/node_laws.h"
#include "shallow/node_rheologies.h"
#include "shallow/nodes.h"
#include "shallow/particles.h"
#include "shallow/rest.h"

namespace frana {

/// Up to four sums of one tile.
using TileSums = std::array<double, 4>;

/// What the phases need of a scene, besides its bed.
struct FlowSetup {
    GridGeometry grid;
    double density;   ///< [kg/m^3]
    double gravity;   ///< [m/s^2]
    bool walls;       ///< sides are mirrors; otherwise open
    bool steep;       ///< velocities follow the bed; otherwise they are horizontal
    bool with_force;  ///< points deposit forces besides mass and momentum
    Scheme scheme;
};

/// The state of a depth-averaged run. Phases are free functions on it (transfer.h, surface.h, grid update.h, split.h).
struct Flow {
    explicit Flow(const Scene& scene)
        : Flow({scene.bed.geometry, scene.density, scene.gravity, are_closed(scene.sides),
                scene.terrain != TerrainModel::shallow, scene.rheology.index() != 0 || scene.scheme.paper_pressure,
                scene.scheme},
               make_bed_geometry(scene, TileGrid(scene.bed.geometry))) {
        if (const auto* of_nodes = scene.bed_laws()) laws.emplace(*of_nodes, grid);
        if (const auto* of_nodes = scene.rheologies()) rheologies.emplace(*of_nodes, grid);
    }
    Flow(const FlowSetup& setup, BedGeometry of)
        : grid(setup.grid),
          bed(std::move(of)),
          nodes(grid, setup.with_force),
          density(setup.density),
          gravity(setup.gravity),
          cell(grid.cell()),
          area(cell * cell),
          walls(setup.walls),
          steep(setup.steep),
          scheme(setup.scheme),
          in_reach(grid.tiles()),
          near(grid.tiles()),
          reach(grid.tiles()),
          deposit_sums(grid.tiles()),
          depth_sums(grid.tiles()),
          speed_sums(grid.tiles()),
          rest(grid) {}

    TileGrid grid;
    BedGeometry bed;
    std::optional<NodeLaws> laws;              ///< nothing: one bed law everywhere
    std::optional<NodeRheologies> rheologies;  ///< nothing: one rheology everywhere
    Nodes nodes;
    Particles particles;
    ActiveTiles active;
    double density;  ///< [kg/m^3]
    double gravity;  ///< [m/s^2]
    double cell;     ///< [m]
    double area;     ///< of a node's cell, the same for all nodes [m^2]
    bool walls;      ///< sides are mirrors; otherwise open
    bool steep;      ///< velocities follow the bed; otherwise they are horizontal
    Scheme scheme;
    /// Of what affine points carry beyond the nodes' motion, the share that the next gather leaves them; less of flip [1].
    double carried_share = 0.0;
    /// Whether nodes store what friction leaves of velocities: points that retain some of their own need it.
    bool keeps_shares() const { return carried_share > 0.0 || scheme.transfer == Transfer::flip; }
    /// Per tile of the domain, good for tiles of the work list. It is what the points of the last deposit reached, the
    /// only nodes with material. Stale elsewhere; deposits are cleared by it.
    LazyArray<NodeGroups> in_reach;
    /// The same grown by three nodes, as far as passes read. These nodes, and no others, hold what a dry node holds.
    LazyArray<NodeGroups> near;
    LazyArray<TileReach> reach;                    ///< what the points of each tile touch
    std::vector<Index> shore;                      ///< tiles of the work list that have margin nodes (mark_margin)
    std::vector<std::uint8_t> marked;              ///< scratch of mark_margin, one per tile of the work list
    std::vector<std::vector<Departed>> departed;   ///< in the last gather, by thread
    LazyArray<TileSums> deposit_sums, depth_sums;  ///< per tile, of node_sums and depth_pass
    LazyArray<Pair> speed_sums;  ///< per tile, of update_peaks: mass [kg] and its product with speed [kg m/s]
    Rest rest;
    /// Nodes that the passes go over.
    NodeGroups active_nodes(Index tile) const { return rest.active[tile] ? in_reach[tile] : 0; }
    auto active_nodes() const {
        return [this](Index tile) { return active_nodes(tile); };
    }
    StencilMarks marks_of(Index tile) const { return {grid.tile_i(tile) + kTile, grid.tile_j(tile) + kTile}; }
    /// Whether a node is in reach.
    bool is_in_reach(Index i, Index j) const {
        const Index tile = grid.tile_of_node(i, j);
        return active.in_work[tile] && (in_reach[tile] & group_of((i + kTile) % kTile, (j + kTile) % kTile));
    }
    double dry_depth() const { return 1e-14 * cell; }  ///< round-off of a depth [m]

    /// Share of a node that lies inside walls: 1, 1/2 on a wall, 1/4 in a corner, 0 beyond. 1 at open sides.
    double share(Index i, Index j) const {
        if (!walls) return 1.0;
        const auto along = [](Index k, Index n) { return k < 0 || k >= n ? 0.0 : k == 0 || k == n - 1 ? 0.5 : 1.0; };
        return along(i, grid.nx()) * along(j, grid.ny());
    }
    Double4 share_of_four(Index i, Index j) const {
        if (!walls) return all(1.0);
        const Double4 shares = {share(i, j), share(i + 1, j), share(i + 2, j), share(i + 3, j)};
        return shares;
    }
};

/// Calls body(storage index, i, j) for the nodes of a tile.
template <class Body>
void for_each_node_of(const TileGrid& grid, Index tile, Body&& body) {
    const Index i0 = grid.tile_i(tile), j0 = grid.tile_j(tile);
    for (Index j = j0; j < j0 + kTile; ++j) {
        const Index row = grid.at(i0, j);
        for (Index n = 0; n < kTile; ++n) body(row + n, i0 + n, j);
    }
}

/// Calls body(ghost, mirror) for the node pairs on both ends of one axis (0: x, 1: y), layers `first` to kGhosts. Layer
/// 0 is the wall node with itself. Only near material, and only where the ghosts' tile is near material too. (Elsewhere
/// they hold what an earlier step left.) Serial, since a side has few nodes.
template <class Body>
void for_each_wall_pair(const Flow& flow, int axis, Index first, Body&& body) {
    const TileGrid& grid = flow.grid;
    const Index last = (axis == 0 ? grid.nx() : grid.ny()) - 1;
    const Index step = axis == 0 ? 1 : grid.stride();
    for (const Index tile : flow.active.work) {
        const Index from = axis == 0 ? grid.tile_i(tile) : grid.tile_j(tile);
        const auto along_wall = [&](Index wall, Index inward) {
            if (wall < from || wall >= from + kTile) return;
            const Index ghosts = wall - inward * kGhosts < from ? -1 : wall - inward * kGhosts >= from + kTile ? 1 : 0;
            const Index beyond = tile + ghosts * (axis == 0 ? 1 : grid.tiles_x());
            if (!flow.active.in_work[beyond]) return;
            for (Index n = 0; n < kTile; ++n) {
                const Index k = axis == 0 ? grid.at(wall, grid.tile_j(tile) + n) : grid.at(grid.tile_i(tile) + n, wall);
                for (Index layer = first; layer <= kGhosts; ++layer)
                    body(k - inward * layer * step, k + inward * layer * step);
            }
        };
        along_wall(0, 1);
        along_wall(last, -1);
    }
}

}  // namespace frana
