#include "shallow/surface.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <limits>

#include "base/simd.h"
#include "shallow/shock.h"
#include "shallow/two_cell_wave.h"

namespace frana {

void mirror_surface(Flow& flow) {
    if (!flow.walls) return;
    Nodes& nodes = flow.nodes;
    for (int axis = 0; axis < 2; ++axis)
        for_each_wall_pair(flow, axis, 1, [&](Index ghost, Index mirror) {
            nodes.depth[ghost] = nodes.depth[mirror];
            nodes.law_depth[ghost] = nodes.law_depth[mirror];
            nodes.surface[ghost] = nodes.surface[mirror];
            nodes.level[ghost] = nodes.level[mirror];
            nodes.flags[ghost] = nodes.flags[mirror];
        });
}

namespace {

/// The velocity before the grid update beyond walls: mirrored, the normal component turned round.
void mirror_velocity(Flow& flow) {
    if (!flow.walls) return;
    Nodes& nodes = flow.nodes;
    for (int axis = 0; axis < 2; ++axis)
        for_each_wall_pair(flow, axis, 1, [&](Index ghost, Index mirror) {
            nodes.before[ghost] = nodes.before[mirror];
            (axis == 0 ? nodes.before[ghost].x : nodes.before[ghost].y) *= -1.0;
        });
}

/// Wetness of a tile and two nodes around it. There is one bit a node, and bit n + 2 of row n + 2 is node (n, n). Right
/// in rows two or fewer from a node in reach, empty elsewhere.
struct WetRows {
    std::uint32_t row[kTile + 4] = {};
    WetRows(const Flow& flow, Index tile) {
        const Index i0 = flow.grid.tile_i(tile), j0 = flow.grid.tile_j(tile);
        const NodeGroups in_reach = flow.in_reach[tile];
        for (Index j = 0; j < kTile + 4; ++j) {
            const Index from = 4 * std::max<Index>(j - 4, 0), past = 4 * std::min<Index>(j + 1, kTile);
            const NodeGroups below = past < 64 ? (NodeGroups{1} << past) - 1 : kAllGroups;
            if (!((in_reach & below) >> from)) continue;
            const Index first = flow.grid.at(i0, j0 + j - 2) - 2;
            if (first < 0 || first + kTile + 4 > flow.grid.size()) continue;  // beyond the spare ring: dry
            // Depth and not the flags, which other threads write at the same time.
            const double* depth = flow.nodes.depth.data() + first;
            for (Index i = 0; i < kTile + 4; ++i) row[j] |= static_cast<std::uint32_t>(depth[i] > 0.0) << i;
        }
    }
};

/// The sixteen nodes of four groups, a bit each.
std::uint32_t nodes_in(NodeGroups groups) {
    const auto spread = static_cast<std::uint32_t>(groups | groups << 3 | groups << 6 | groups << 9) & 0x1111u;
    return spread * 0xfu;
}

constexpr int kSweeps = 3;  ///< a ragged shore is flagged three nodes deep

/// How much of the ground around a node stands above `level`, averaged as the bed is. A surface at that level comes out
/// too high there by so much at most. (The ground is taken at nodes: Jensen.) Linear shapes: no bound.
double emerging(const Flow& flow, Index k, double level) {
    const auto& w = flow.bed.averaging;
    if (w[0] == 1.0) return std::numeric_limits<double>::infinity();
    const Index up = flow.grid.stride();
    double sum = 0.0;
    for (Index dj = -2; dj <= 2; ++dj)
        for (Index di = -2; di <= 2; ++di)
            sum += w[std::abs(dj)] * w[std::abs(di)] * std::max(0.0, flow.bed.ground[k + dj * up + di] - level);
    return sum;
}

/// What a film adds to the line through its surface at p and q when that is continued to k. It bends as the ground
/// does. Of a film only, on ground that bends by more than it is deep. On what a grid resolves waves are linear at
/// shores. Nothing where the ground from q to p is next to level, as on a crest. A lake is as level there as a film.
double film_bend(const Flow& flow, Index k, Index p, Index q) {
    const double bend = flow.bed.z[k] - 2.0 * flow.bed.z[p] + flow.bed.z[q],
                 depth = std::max(flow.nodes.depth[p], flow.nodes.depth[q]);
    if (std::abs(bend) <= depth) return 0.0;
    const double rise = flow.nodes.surface[p] - flow.nodes.surface[q], ground = flow.bed.z[p] - flow.bed.z[q];
    return std::min(1.0, std::abs(bend) / depth - 1.0) * film_share(rise / flow.cell, ground / flow.cell) * bend;
}

static_assert(kWet == 1 && kMargin == 2 && kSweep == 64 && kSweeps == 3, "as below");
static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "bytes and bits count from the same end");

/// The flags of eight nodes in a row, a byte each. Storage begins, and its rows do, at a multiple of eight (TileGrid).
typedef std::uint64_t __attribute__((may_alias)) EightFlags;
constexpr std::uint64_t kEachByte = 0x0101010101010101;

/// The lowest bit of each of eight bytes.
std::uint32_t bits_of(std::uint64_t bytes) {
    return static_cast<std::uint32_t>((bytes & kEachByte) * 0x0102040810204080 >> 56);
}

/// Which of eight nodes are known before a sweep. They are wet, and not of the margin or found by an earlier sweep.
std::uint32_t known_of(std::uint64_t flags, int sweep) {
    const std::uint64_t margin = flags >> 1, odd = flags >> 6, even = flags >> 7;  // sweeps 1 and 3; 2 and 3
    std::uint64_t found = 0;
    if (sweep >= 2) found |= odd & ~even;
    if (sweep >= 3) found |= even & ~odd;
    return bits_of(flags & (~margin | found));
}

/// Margin nodes of a tile that no sweep has reached: bit i of row j is node (i, j).
struct UnknownRows {
    std::uint32_t row[kTile] = {};
    bool any = false;
    UnknownRows(const Flow& flow, Index tile) {
        const Index i0 = flow.grid.tile_i(tile), j0 = flow.grid.tile_j(tile);
        std::uint32_t columns = 0;
        for (Index i = 0; i < kTile; ++i)
            columns |= std::uint32_t{!flow.walls || (i0 + i >= 0 && i0 + i < flow.grid.nx())} << i;
        for (Index j = 0; j < kTile; ++j) {
            if (flow.walls && (j0 + j < 0 || j0 + j >= flow.grid.ny())) continue;
            const std::uint32_t here = nodes_in(flow.in_reach[tile] >> (4 * j) & 0xf);
            if (!here) continue;
            const auto* flags = reinterpret_cast<const EightFlags*>(&flow.nodes.flags[flow.grid.at(i0, j0 + j)]);
            const auto unknown = [](std::uint64_t f) { return bits_of(f >> 1 & ~(f >> 6) & ~(f >> 7)); };
            row[j] = (unknown(flags[0]) | unknown(flags[1]) << 8) & here & columns;
            any = any || row[j] != 0;
        }
    }
};

/// Nodes of a tile and three around it that are known before a sweep. Bit i + 8 of row j + 3 is node (i, j). Valid
/// within three nodes of one of `unknown`, along known nodes; elsewhere bits mean nothing.
struct KnownRows {
    std::uint32_t row[kTile + 6] = {};
    KnownRows(const Flow& flow, Index tile, int sweep, const UnknownRows& unknown) {
        const Index i0 = flow.grid.tile_i(tile), j0 = flow.grid.tile_j(tile);
        for (Index j = -3; j < kTile + 3; ++j) {
            bool asked = false;
            for (Index n = std::max<Index>(j - 3, 0); n <= std::min<Index>(j + 3, kTile - 1); ++n)
                asked = asked || unknown.row[n] != 0;
            const Index first = flow.grid.at(i0, j0 + j) - 8;
            if (!asked || first < 0 || first + 32 > flow.grid.size()) continue;  // beyond the spare ring: dry
            const auto* flags = reinterpret_cast<const EightFlags*>(&flow.nodes.flags[first]);
            // Another thread may be writing: it only adds the present sweep, which counts for none.
            for (int n = 0; n < 4; ++n)
                row[j + 3] |= known_of(__atomic_load_n(flags + n, __ATOMIC_RELAXED), sweep) << (8 * n);
        }
    }
    bool operator()(Index i, Index j) const { return row[j + 3] >> (i + 8) & 1; }
    /// Nodes of row j that have two known ones in a row in some direction.
    std::uint32_t next_to_two(Index j) const {
        std::uint32_t any = 0;
        for (Index dj = -1; dj <= 1; ++dj) {
            const std::uint32_t near = row[j + 3 + dj], far = row[j + 3 + 2 * dj];
            if (dj != 0) any |= near & far;
            any |= (near << 1 & far << 2) | (near >> 1 & far >> 2);
        }
        return any >> 8;
    }
};

/// 1 where a node rests, 0 where it moves at `creeps` or faster.
double resting(const Pair& velocity, double creeps) {
    if (std::abs(velocity.x) >= creeps || std::abs(velocity.y) >= creeps) return 0.0;  // as below, without the root
    return std::max(0.0, 1.0 - std::hypot(velocity.x, velocity.y) / creeps);
}

/// One extrapolated surface value of node (i, j) of a tile, number k in storage; or nothing. It is made from up to eight
/// directions, of nodes known before this sweep.
bool extrapolate(const Flow& flow, Index k, Index i, Index j, const KnownRows& known, double creeps, double& value) {
    const Nodes& nodes = flow.nodes;
    const Index up = flow.grid.stride();
    // The flank of what rests bends down to the level at most. Bent on under the ground, it would be steeper than it is
    // anywhere and drive the pile apart. (Not to the bed itself, or a dry neighbour as high would be a shore by
    // round-off.) A front in motion has a tip that bends so. Between the two not at once, or round-off would choose.
    const double rests = resting(nodes.before[k], creeps);
    double sum = 0.0, weights = 0.0;
    for (Index dj = -1; dj <= 1; ++dj)
        for (Index di = -1; di <= 1; ++di) {
            if (di == 0 && dj == 0) continue;
            const Index step = dj * up + di, p = k + step, q = p + step, r = q + step;
            if (!known(i + di, j + dj) || !known(i + 2 * di, j + 2 * dj)) continue;
            const double film = film_bend(flow, k, p, q);
            double e = 2.0 * nodes.surface[p] - nodes.surface[q] + film;
            const double limit = flow.scheme.margin_limit * nodes.depth[p];
            if (known(i + 3 * di, j + 3 * dj)) {
                const double bend =
                    std::clamp(nodes.surface[p] - 2.0 * nodes.surface[q] + nodes.surface[r] - film, -limit, limit);
                e += bend + rests * (std::max(bend, std::min(0.0, nodes.level[k] - e)) - bend);
            }
            const double weight = di == 0 || dj == 0 ? nodes.depth[p] : 0.25 * nodes.depth[p];
            sum += weight * e;
            weights += weight;
        }
    if (weights <= 0.0) return false;
    value = std::max(sum / weights, flow.bed.z_min[k]);
    const double level = nodes.level[k];
    if (value >= level)
        value = level;
    else  // a heap stays visible
        value = std::max(value, level - emerging(flow, k, value) - (value - flow.bed.z_min[k]));
    return true;
}

/// Extrapolates to the margin nodes inside the walls that no earlier sweep reached.
void shoreline_sweep(Flow& flow, int number) {
    Nodes& nodes = flow.nodes;
    constexpr double kCreeps = 1e-6;  // of the speed of a wave one cell deep, where it is a front
    const double creeps = kCreeps * std::sqrt(flow.gravity * flow.cell);
    const Index count = static_cast<Index>(flow.shore.size());
#pragma omp parallel for schedule(dynamic, 1) if (count >= kTilesForThreads)
    for (Index n = 0; n < count; ++n) {
        const Index tile = flow.shore[static_cast<std::size_t>(n)];
        const UnknownRows unknown(flow, tile);
        if (!unknown.any) continue;
        const KnownRows known(flow, tile, number, unknown);
        const Index first = flow.grid.at(flow.grid.tile_i(tile), flow.grid.tile_j(tile));
        for (Index j = 0; j < kTile; ++j)
            for (std::uint32_t left = unknown.row[j] & known.next_to_two(j); left != 0; left &= left - 1) {
                const Index i = __builtin_ctz(left), k = first + j * flow.grid.stride() + i;
                if (!extrapolate(flow, k, i, j, known, creeps, nodes.surface[k])) continue;
                __atomic_store_n(&nodes.flags[k], static_cast<std::uint8_t>(nodes.flags[k] | number * kSweep),
                                 __ATOMIC_RELAXED);
            }
    }
}

/// Nodes of a tile that are wet and not of the margin, and so are two each way. Bit i of row j is node (i, j). Rows far
/// from all of the groups are not set.
struct InnerRows {
    std::uint32_t along_x[kTile] = {}, along_y[kTile] = {};
    InnerRows(const Flow& flow, Index tile, NodeGroups groups) {
        const Index first = flow.grid.at(flow.grid.tile_i(tile), flow.grid.tile_j(tile)) - 8;
        std::uint32_t row[kTile + 4] = {};  // bit i + 8 of row j + 2
        for (Index j = -2; j < kTile + 2; ++j) {
            const Index from = std::max<Index>(j - 2, 0), past = std::min<Index>(j + 3, kTile);
            const NodeGroups below = past < kTile ? (NodeGroups{1} << (4 * past)) - 1 : kAllGroups;
            const Index k = first + j * flow.grid.stride();
            if (!((groups & below) >> (4 * from)) || k < 0 || k + 32 > flow.grid.size()) continue;
            const auto* flags = reinterpret_cast<const EightFlags*>(&flow.nodes.flags[k]);
            for (int n = 0; n < 4; ++n) row[j + 2] |= bits_of(flags[n] & ~(flags[n] >> 1)) << (8 * n);
        }
        for (Index j = 0; j < kTile; ++j) {
            const std::uint32_t* r = row + j;
            along_x[j] = (r[2] & r[2] << 1 & r[2] << 2 & r[2] >> 1 & r[2] >> 2) >> 8;
            along_y[j] = (r[0] & r[1] & r[2] & r[3] & r[4]) >> 8;
        }
    }
};

/// Calls body(first node of the four, bits along x, bits along y) for each of the groups of a tile.
template <class Body>
void for_each_inner_four(const Flow& flow, Index tile, Body&& body) {
    const NodeGroups groups = flow.active_nodes(tile);
    if (groups == 0) return;
    const InnerRows inner(flow, tile, groups);
    const Index i0 = flow.grid.tile_i(tile), j0 = flow.grid.tile_j(tile);
    for_each_four_of(flow.grid, tile, groups, [&](Index k, Index i, Index j) {
        body(k, inner.along_x[j - j0] >> (i - i0) & 0xf, inner.along_y[j - j0] >> (i - i0) & 0xf);
    });
}

void wave_along_x(Nodes& nodes, Index k, std::uint32_t known) {
    const double* e = nodes.level.data() + k;
    if (known == 0xf) {
        std::memset(nodes.row_known.data() + k, 1, 4);
        store(&nodes.wave_x[k], wave_along<Double4>(e, 1));
        return;
    }
    for (Index n = 0; n < 4; ++n) {
        nodes.row_known[k + n] = known >> n & 1;
        nodes.wave_x[k + n] = known >> n & 1 ? wave_along<double>(e + n, 1) : 0.0;
    }
}

/// Four nodes in a row without margin or bore nearby.
bool calm(const Nodes& nodes, Index k, Index up) {
    const std::uint8_t *f = nodes.flags.data() + k, *row = nodes.row_known.data() + k, *s = nodes.sensed.data() + k - 2;
    for (Index n = -2; n <= 2; ++n)
        if (!four_have(f + n * up, kWet, kMargin) || !four_have(row + n * up, 1, 0)) return false;
    for (Index n = -2; n <= 1; ++n)
        if (!eight_have(s + n * up, 0, 1)) return false;
    return true;
}

/// Of the depth that a filter may take or add. The mean of a depth that repeats every two cells and is nowhere negative
/// is at least a quarter of its peak. Where a filter takes more, there is no wave but the edge of a film.
constexpr double kMostOfDepth = 0.75;

/// The depth h without its wave, for the bed law.
template <class Real>
Real without_wave(Real h, Real wave) {
    return h - min(max(wave, -kMostOfDepth * h), kMostOfDepth * h);
}

/// (1 - s X)(1 - s Y) multiplied out, so that x and y may change places. Where the product is not known, two thirds of
/// each. A third of the waves along one axis and of the chequerboard is then left.
void filter_node(const Flow& flow, Nodes& nodes, Index k, Index up, bool x, bool y, bool sensed) {
    const double held = sensed ? away_from_bores(nodes, k, up) : 1.0;
    const double strength = flow.scheme.filter * held;
    const double wave_y = y ? wave_along<double>(nodes.level.data() + k, up) : 0.0;
    const std::uint8_t* row = nodes.row_known.data() + k;
    const bool all = x && y && row[up] && row[-up] && row[2 * up] && row[-2 * up];
    const double both = all ? strength * wave_along<double>(nodes.wave_x.data() + k, up) : 0.0;
    const double share = x && y && !all ? 2.0 / 3.0 : 1.0;
    nodes.surface[k] -= share * strength * (nodes.wave_x[k] + wave_y - both);
    const double* h = nodes.depth.data() + k;
    const double depth_x = x ? wave_along<double>(h, 1) : 0.0, depth_y = y ? wave_along<double>(h, up) : 0.0;
    const double depth_both = all ? strength * wave_along_both<double>(h, up) : 0.0;
    nodes.law_depth[k] = without_wave(*h, share * strength * (depth_x + depth_y - depth_both));
}

void filter_calm(const Flow& flow, Nodes& nodes, Index k, Index up) {
    const double strength = flow.scheme.filter;
    const Double4 wave_y = wave_along<Double4>(nodes.level.data() + k, up);
    const Double4 both = strength * wave_along<Double4>(nodes.wave_x.data() + k, up);
    store(&nodes.surface[k], load(&nodes.level[k]) - strength * (load(&nodes.wave_x[k]) + wave_y - both));
    const double* h = nodes.depth.data() + k;
    const Double4 depth_x = wave_along<Double4>(h, 1), depth_y = wave_along<Double4>(h, up);
    const Double4 left_y = wave_along<Double4>(h - 2, up), right_y = wave_along<Double4>(h + 2, up);
    const Double4 depth_both = strength * wave_of_row(left_y, right_y);
    store(&nodes.law_depth[k], without_wave(load(h), strength * (depth_x + depth_y - depth_both)));
}

/// Mass and momentum of a node vanish together. However little it is, the velocity is right, and points that gather
/// would miss it. Only denormal numbers are none.
constexpr double kLeastMass = 1e-200;  ///< [kg]

/// Four nodes in a row that no point touches.
void dry_four(Flow& flow, Index k) {
    Nodes& nodes = flow.nodes;
    const Double4 none = {}, z = load(&flow.bed.z[k]);
    store(&nodes.depth[k], none);
    store(&nodes.law_depth[k], none);
    store(&nodes.level[k], z);
    store(&nodes.surface[k], z);
    for (Index n = 0; n < 4; n += 2)
        for (auto* pairs : {&nodes.before, &nodes.viscous_flux, &nodes.shock}) store(&(*pairs)[k + n], none);
    for (auto* bytes : {&nodes.flags, &nodes.sensed, &nodes.row_known}) std::memset(bytes->data() + k, 0, 4);
}

/// The sums of one tile: four nodes at a time.
struct DepthSums {
    Double4 potential{}, max_depth{}, covered_area{}, front2{};
    TileSums of_tile() const { return {sum(potential), largest(max_depth), sum(covered_area), largest(front2)}; }
};

/// Depth, wetness, surface and velocity of four nodes in a row from what lies on them.
void depth_of_four(Flow& flow, const DepthRequest& request, Index k, Index i, Index j, DepthSums& sums) {
    Nodes& nodes = flow.nodes;
    const Deposit* d = nodes.deposits() + k;
    const double column = flow.density * flow.area;
    const Double4 none = {}, z = load(&flow.bed.z[k]), raw = load(&nodes.column_mass[k]) / column;
    const Double4 px = {d[0].px, d[1].px, d[2].px, d[3].px}, py = {d[0].py, d[1].py, d[2].py, d[3].py};
    const Double4 deposited = load(&nodes.mass[k]);
    const Mask4 wet = raw > flow.dry_depth(), moving = deposited > kLeastMass;
    for (int n = 0; n < 4; ++n)
        nodes.flags[k + n] = static_cast<std::uint8_t>((wet[n] ? kWet : 0) | (moving[n] ? kMoving : 0));
    const Double4 h = select(wet, raw, none), mass = select(moving, deposited, all(1.0));
    store(&nodes.depth[k], h);
    store(&nodes.law_depth[k], h);
    store(&nodes.level[k], z + h);
    store(&nodes.surface[k], z + h);
    zip(select(moving, px / mass, none), select(moving, py / mass, none), &nodes.before[k]);
    if (!any(wet)) return;
    const Double4 share = flow.share_of_four(i, j);
    sums.potential += share * column * flow.gravity * h * (z + 0.5 * h);
    sums.max_depth = max(sums.max_depth, select(share > 0.0, h, none));
    const Mask4 covered = (h > request.footprint_depth) & (share > 0.0);
    const Double4 dx = static_cast<double>(i) - request.centre.x() + Double4{0.0, 1.0, 2.0, 3.0};
    const double dy = static_cast<double>(j) - request.centre.y();
    sums.covered_area += select(covered, share * flow.area, none);
    sums.front2 = max(sums.front2, select(covered, (dx * dx + dy * dy) * flow.area, none));
}

/// THEORY, section 6: the depth that the bed law is given at a margin. Shape functions spread a front over nodes beyond it,
/// whose depth is a small part of the front's. Were it taken for the flow's own, drag that grows as depth falls would
/// hold the front too much. The flow behind would pile up on it. So the depth is that of the mass behind, if that is
/// more. It is of nodes that the node moves away from, by the cosine of twice the angle. At the sides of a flow and
/// behind it its edge is thin. What moves by round-off alone has no direction.
double depth_at_margin(const double* h, Index up, const Pair& velocity, double gravity) {
    constexpr double kStill2 = 1e-16;  // of the wave's speed, squared: a metre a year
    const double speed2 = velocity.x * velocity.x + velocity.y * velocity.y;
    const double moving2 = std::max(speed2, kStill2 * gravity * *h);
    double sum = *h, square = *h * *h;
    for (Index dj = -1; dj <= 1; ++dj)
        for (Index di = -1; di <= 1; ++di) {
            const auto x = static_cast<double>(di), y = static_cast<double>(dj);
            const double away = -(velocity.x * x + velocity.y * y), distance2 = x * x + y * y;
            const double weight = 2.0 * away * away - speed2 * distance2;  // times both squares
            if (!(away > 0.0) || !(weight > 0.0)) continue;
            const double near = h[dj * up + di], share = weight / (moving2 * distance2);
            sum += share * near, square += share * near * near;
        }
    return square > *h * sum ? square / sum : *h;
}

}  // namespace

NodeSums depth_pass(Flow& flow, const DepthRequest& request) {
    for_each_work_run(flow.active, [&](const TileRun& run) {
        std::array<DepthSums, kRunTiles> sums{};
        const auto dry = [&](Index tile) {
            return flow.rest.active[tile] ? flow.near[tile] & ~flow.in_reach[tile] : 0;
        };
        for_each_four_of_run(flow.grid, run, flow.active_nodes(), [&](Index n, Index k, Index i, Index j) {
            depth_of_four(flow, request, k, i, j, sums[static_cast<std::size_t>(n)]);
        });
        for_each_four_of_run(flow.grid, run, dry, [&](Index, Index k, Index, Index) { dry_four(flow, k); });
        for (Index n = 0; n < run.count; ++n)
            if (flow.rest.active[run.tile[n]])
                flow.depth_sums[run.tile[n]] = sums[static_cast<std::size_t>(n)].of_tile();
    });
    NodeSums total;
    for (const Index tile : flow.active.work) {
        const TileSums& part = flow.depth_sums[tile];
        total.potential += part[0];
        total.max_depth = std::max(total.max_depth, part[1]);
        total.covered_area += part[2];
        total.front2 = std::max(total.front2, part[3]);
    }
    mirror_surface(flow);
    mirror_velocity(flow);
    return total;
}

void mark_margin(Flow& flow) {
    flow.marked.assign(flow.active.work.size(), 0);
    for_each_work_tile(flow.active, [&](Index n, Index tile) {
        const NodeGroups in_reach = flow.active_nodes(tile);
        if (!in_reach) return;
        const WetRows wet(flow, tile);
        std::uint8_t any = 0;
        std::uint32_t across[kTile + 4];  // this node and two each way in x
        for (Index j = 0; j < kTile + 4; ++j) {
            const std::uint32_t r = wet.row[j];
            across[j] = r & (r << 1) & (r << 2) & (r >> 1) & (r >> 2);
        }
        const Index i0 = flow.grid.tile_i(tile), j0 = flow.grid.tile_j(tile), up = flow.grid.stride();
        for (Index j = 0; j < kTile; ++j) {
            const std::uint32_t here = nodes_in(in_reach >> (4 * j) & 0xf);
            if (!here) continue;
            const std::uint32_t* r = wet.row + j;
            const std::uint32_t wide_y = r[0] & r[1] & r[2] & r[3] & r[4];
            const std::uint32_t* a = across + j;
            const std::uint32_t inner = a[0] & a[1] & a[2] & a[3] & a[4];
            const Index first = flow.grid.at(i0, j0 + j);
            std::uint8_t* flags = flow.nodes.flags.data() + first;
            const double* depth = flow.nodes.depth.data() + first;
            for (Index i = 0; i < kTile; ++i) {
                const std::uint32_t bit = 1u << (i + 2);
                if (!(r[2] & here << 2 & bit)) continue;
                std::uint8_t flag = flags[i] & (kWet | kMoving);
                if (!(inner & bit)) {
                    flag |= kMargin;
                    if (flow.scheme.margin)
                        flow.nodes.law_depth[first + i] =
                            depth_at_margin(depth + i, up, flow.nodes.before[first + i], flow.gravity);
                }
                any |= flag;
                if (a[2] & bit) flag |= kWideX;
                if (wide_y & bit) flag |= kWideY;
                flags[i] = flag;
            }
        }
        flow.marked[n] = any & kMargin;
    });
    flow.shore.clear();
    flow.shore.reserve(flow.active.work.capacity());  // grows with the list of tiles, not some steps later
    for (std::size_t n = 0; n < flow.marked.size(); ++n)
        if (flow.marked[n]) flow.shore.push_back(flow.active.work[n]);
    mirror_surface(flow);
}

void shoreline(Flow& flow) {
    for (int sweep = 1; sweep <= (flow.scheme.margin ? kSweeps : 0); ++sweep) {
        shoreline_sweep(flow, sweep);
        mirror_surface(flow);
    }
}

void filter(Flow& flow) {
    if (flow.scheme.filter <= 0.0) return;
    Nodes& nodes = flow.nodes;
    const Index up = flow.grid.stride();
    const bool sensed = senses_bores(flow.scheme);
    for_each_work_tile(flow.active, [&](Index, Index tile) {
        for_each_inner_four(flow, tile, [&](Index k, std::uint32_t x, std::uint32_t) { wave_along_x(nodes, k, x); });
    });
    for_each_work_tile(flow.active, [&](Index, Index tile) {
        for_each_inner_four(flow, tile, [&](Index k, std::uint32_t x, std::uint32_t y) {
            if ((x & y) == 0xf && calm(nodes, k, up)) return filter_calm(flow, nodes, k, up);
            for (std::uint32_t left = x | y; left != 0; left &= left - 1) {
                const Index n = __builtin_ctz(left);
                filter_node(flow, nodes, k + n, up, x >> n & 1, y >> n & 1, sensed);
            }
        });
    });
    mirror_surface(flow);
}

}  // namespace frana
