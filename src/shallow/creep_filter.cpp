#include "shallow/creep_filter.h"

#include <algorithm>
#include <cmath>

#include "base/simd.h"
#include "shallow/shock.h"
#include "shallow/surface.h"
#include "shallow/tiles_around.h"
#include "shallow/two_cell_wave.h"

namespace frana {
namespace {

constexpr double kCellsAPass = 1.5;  ///< each pass begins at so many cells of depth more, and is whole as many later
constexpr double kCreeps = 0.1;      ///< Froude number up to which flow creeps; from twice that on it does not
constexpr Index kNear = 3;           ///< so many nodes from walls and margins it is left out
/// Each pass reads two nodes farther. With more a change could be felt beyond the next tile (rest.h).
constexpr int kMostPasses = 4;

/// Whether no node within three is dry or of the margin. So a surface next to the margin is never filtered again.
bool far_inside(const Nodes& nodes, Index k, Index up) {
    for (Index n = -kNear; n <= kNear; ++n) {
        const std::uint8_t* flags = nodes.flags.data() + k + n * up;
        if (!four_have(flags - kNear, kWet, kMargin) || !four_have(flags, kWet, kMargin)) return false;
    }
    return true;
}

/// How much more of the filter four nodes in a row get, whatever their depth [1].
Double4 creep_of_four(const Flow& flow, Index k, Double4 depth, bool bores) {
    const Nodes& nodes = flow.nodes;
    const Index up = flow.grid.stride();
    Double4 creeps = {};
    for (int lane = 0; lane < 4; ++lane) {
        if (!(depth[lane] > kCellsAPass * flow.cell)) continue;
        const Pair& v = nodes.before[k + lane];
        const double froude = std::sqrt((v.x * v.x + v.y * v.y) / (flow.gravity * depth[lane]));
        const double share = std::clamp(2.0 - froude / kCreeps, 0.0, 1.0);
        if (share > 0.0 && far_inside(nodes, k + lane, up))
            creeps[lane] = bores ? share * away_from_bores(nodes, k + lane, up) : share;
    }
    return creeps;
}

/// Whether node i of `count` between walls is not next to one. There nothing goes across, so a lump without a pressure
/// gradient would stay.
bool away_from_walls(Index i, Index count) { return i >= kNear && i + kNear < count; }

/// The wave of two cells of four nodes far inside, as the first pass has it, but across walls next to one.
Double4 wave_of_four(const Flow& flow, Index k, Index i, Index j) {
    const Index up = flow.grid.stride();
    const double* e = flow.nodes.surface.data() + k;
    const Double4 x = wave_along<Double4>(e, 1), y = wave_along<Double4>(e, up);
    const Double4 both = wave_of_row(wave_along<Double4>(e - 2, up), wave_along<Double4>(e + 2, up));
    if (!flow.walls) return x + y - both;
    Double4 along_x = {};
    for (int lane = 0; lane < 4; ++lane) along_x[lane] = away_from_walls(i + lane, flow.grid.nx());
    const double along_y = away_from_walls(j, flow.grid.ny());
    return along_x * x + along_y * (y - along_x * both);
}

}  // namespace

void CreepFilter::find_tiles(const Flow& flow) {
    some_.assign(flow.active.work.size(), 0), tiles_.clear();
    const bool bores = senses_bores(flow.scheme);
    for_each_work_tile(flow.active, [&](Index n, Index tile) {
        Mask4 some = {};
        for_each_four_of(flow.grid, tile, flow.active_nodes(tile), [&](Index k, Index, Index) {
            const Double4 none = {}, depth = load(&flow.nodes.depth[k]);
            const bool deep = any(depth > kCellsAPass * flow.cell);
            const Double4 creeps = deep ? creep_of_four(flow, k, depth, bores) : none;
            store(&creeps_[k], creeps), some |= creeps > none;
        });
        some_[static_cast<std::size_t>(n)] = any(some);
    });
    for (std::size_t n = 0; n < some_.size(); ++n)
        if (some_[n]) tiles_.push_back(flow.active.work[n]);
}

void CreepFilter::pass(Flow& flow, double max_depth) {
    const int passes = std::min(kMostPasses, static_cast<int>(max_depth / (kCellsAPass * flow.cell)));
    if (passes < 1 || !resisted_ || !(flow.scheme.filter > 0.0)) return;
    find_tiles(flow);
    if (tiles_.empty()) return;
    Nodes& nodes = flow.nodes;
    const double per_pass = 1.0 / (kCellsAPass * flow.cell);
    for (int pass = 1; pass <= passes; ++pass) {
        for_each_in_parallel(tiles_, [&](Index tile) {
            for_each_four_of(flow.grid, tile, flow.active_nodes(tile), [&](Index k, Index i, Index j) {
                const Double4 none = {}, one = all(1.0), layers = load(&nodes.depth[k]) * per_pass;
                const Double4 share = load(&creeps_[k]) * min(max(layers - double(pass), none), one);
                const bool some = any(share > none);
                store(&nodes.wave_x[k], some ? flow.scheme.filter * share * wave_of_four(flow, k, i, j) : none);
            });
        });
        for_each_in_parallel(tiles_, [&](Index tile) {
            for_each_four_of(flow.grid, tile, flow.active_nodes(tile), [&](Index k, Index, Index) {
                store(&nodes.surface[k], load(&nodes.surface[k]) - load(&nodes.wave_x[k]));
            });
        });
        mirror_surface(flow);
    }
}

}  // namespace frana
