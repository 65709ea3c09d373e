// The loops over the columns in a step of structured solids: four go side by side, and sums over nodes have one order.
#include <algorithm>
#include <cmath>

#include "grid/stencils.h"
#include "solver/sub_points_of_four.h"
#include "structured/structured_flow.h"

namespace frana {
namespace {

using Push = StructuredBody::Push;
using Moved = StructuredBody::Moved;

/// Calls work(grains, water), types that say what there is in a run: asked once a loop, and not of every column.
template <class Work>
void with_kinds(const StructuredBody& body, Work&& work) {
    const auto with_water = [&](auto grains) {
        if (body.water)
            work(grains, std::true_type{});
        else
            work(grains, std::false_type{});
    };
    if (body.grains)
        with_water(std::true_type{});
    else
        with_water(std::false_type{});
}

/// What a column gives its nodes: of momentum w (base + affine d) + force grad w, d in cells.
struct Gift {
    double mass;
    Double4 base, along_x, along_y, force_x, force_y;
};

[[gnu::always_inline]] inline void give(Deposit* nodes, double* masses, Index stride, const Reach& r, double f, double g,
                                        const Gift& gift) {
    const Double4 mass = gift.mass * Double4{r.wx[0], r.wx[1], r.wx[2], 0.0};
    for (int j = 0; j < 3; ++j) {
        double* const row_mass = masses + r.node + j * stride;
        store(row_mass, load(row_mass) + r.wy[j] * mass);
        const Double4 row = r.wy[j] * (gift.base + (j - g) * gift.along_y) + r.sy[j] * gift.force_y;
        const Double4 along = r.wy[j] * gift.along_x, force = r.wy[j] * gift.force_x;
        Deposit* const first = nodes + r.node + j * stride;
        for (int i = 0; i < 3; ++i)
            store(first + i, load(first + i) + r.wx[i] * row + (r.wx[i] * (i - f)) * along + r.sx[i] * force);
    }
}

/// The same of grains: m (1 - f) K.
template <class Four>
[[gnu::always_inline]] inline void give(Four* nodes, Index stride, const Reach& r, Double4 k) {
    for (int j = 0; j < 3; ++j)
        for (int i = 0; i < 3; ++i) {
            Four* const node = nodes + r.node + j * stride + i;
            store(node, load(node) + (r.wx[i] * r.wy[j]) * k);
        }
}

Gift gift_of(const StructuredPoints& q, Index p, const Gradient& c, double share, double dt, double cell) {
    const double m = q.mass[p], pulls = -dt * q.volume[p] * share * (1.0 - q.damage[p]) / cell;
    return {m,
            Double4{m * q.vx[p], m * q.vy[p], 0.0, 0.0},
            Double4{m * cell * c.xx, m * cell * c.yx, 0.0, 0.0},
            Double4{m * cell * c.xy, m * cell * c.yy, 0.0, 0.0},
            Double4{pulls * q.xx[p], pulls * q.xy[p], 0.0, 0.0},
            Double4{pulls * q.xy[p], pulls * q.yy[p], 0.0, 0.0}};
}

/// The same of what a column is made of.
Double4 bound_of(const StructuredBody& body, Index p) {
    const StructuredPoints& q = body.points;
    const double solids = q.solids[p];
    return Double4{q.volume[p], q.released[p], solids, solids * body.share * (1.0 - q.damage[p])};
}

[[gnu::always_inline]] inline Domains domains(const StructuredPoints& q, Index p, int lanes) {
    return {load(&q.r1x[p], lanes), load(&q.r1y[p], lanes), load(&q.r2x[p], lanes), load(&q.r2y[p], lanes)};
}

/// What the grains of four columns give their nodes, column by column: m (1 - f) K, m (1 - f). False if none has any.
[[gnu::always_inline]] inline bool grain_pushes(const StructuredBody& body, Index p, int lanes, Double4 push[4]) {
    const StructuredPoints& q = body.points;
    const Double4 grains = load(&q.mass[p], lanes) * (1.0 - body.share * (1.0 - load(&q.damage[p], lanes)));
    if (!any(grains != 0.0)) return false;
    const Sym2Of<Double4> rate{load(&q.cxx[p], lanes), load(&q.cyy[p], lanes),
                               0.5 * (load(&q.cxy[p], lanes) + load(&q.cyx[p], lanes))};
    const Double4 pull = load(&q.pull[p], lanes), none = {};
    // Nothing presses on the bed where water bears all: then nothing pushes either.
    const Double4 layer = select(pull > 0.0, load(&q.layer[p], lanes), none), across = select(pull > 0.0, pull, all(1.0));
    const Sym2Of<Double4> k = earth_pressure_of<Double4>(rate, layer, across, body.rankine);
    transpose(grains * k.xx, grains * k.yy, grains * k.xy, grains, push);
    return true;
}

/// The columns of four points on the nodes, from their sub-points. What was released is water already.
template <bool kWater>
void spread(StructuredBody& body, Index p, int lanes, bool at_side) {
    const StructuredPoints& q = body.points;
    const Double4 x = load(&q.x[p], lanes), y = load(&q.y[p], lanes);
    Double4 mass = load(&q.mass[p], lanes);
    if constexpr (kWater) mass = body.density * (load(&q.volume[p], lanes) - load(&q.released[p], lanes));
    if (!at_side && spread_four(body.flow, lanes, x, y, mass, domains(q, p, lanes))) return;
    for (int n = 0; n < lanes; ++n)
        spread_column<Quadratic>(body.flow, {x[n], y[n], mass[n]}, edges_of(q, p + n));
}

/// Whether sub-points of a tile's columns may lie beyond the grid's sides.
bool near_side(const TileGrid& grid, Index tile) {
    const Index i = grid.tile_i(tile), j = grid.tile_j(tile);
    return i <= 0 || j <= 0 || i + 2 * kTile > grid.nx() || j + 2 * kTile > grid.ny();
}

/// What a column takes from its nodes, and how it changes there [1/cell].
struct Taken {
    Double4 mean, slope_x, slope_y;
};

[[gnu::always_inline]] inline Taken take(const Moved* nodes, Index stride, const Reach& r) {
    Taken taken{};
    for (int j = 0; j < 3; ++j) {
        const Moved* const first = nodes + r.node + j * stride;
        const Double4 a = load(first), b = load(first + 1), c = load(first + 2);
        const Double4 row = r.wx[0] * a + r.wx[1] * b + r.wx[2] * c;
        taken.mean += r.wy[j] * row;
        taken.slope_x += r.wy[j] * (r.sx[0] * a + r.sx[1] * b + r.sx[2] * c);
        taken.slope_y += r.sy[j] * row;
    }
    return taken;
}

/// Four columns after a step, number by number.
struct Batch {
    Double4 vx, vy, pull, layer, cxx, cyx, cxy, cyy;
};

[[gnu::always_inline]] inline Batch take_four(const StructuredBody& body, Index p, int lanes) {
    const Stencils sx(load(&body.points.x[p], lanes)), sy(load(&body.points.y[p], lanes));
    const double per_cell = 1.0 / body.grid.cell();
    Taken taken[4] = {};
    for (int n = 0; n < lanes; ++n)
        taken[n] = take(body.moved.data(), body.grid.stride(), Reach(sx, sy, body.grid.stride(), n));
    Double4 mean[4], x[4], y[4];
    transpose(taken[0].mean, taken[1].mean, taken[2].mean, taken[3].mean, mean);
    transpose(taken[0].slope_x, taken[1].slope_x, taken[2].slope_x, taken[3].slope_x, x);
    transpose(taken[0].slope_y, taken[1].slope_y, taken[2].slope_y, taken[3].slope_y, y);
    return {mean[0],         mean[1],         mean[2],         mean[3],
            per_cell * x[0], per_cell * x[1], per_cell * y[0], per_cell * y[1]};
}

/// An edge of four domains goes with the material.
void stretch(double* rx, double* ry, const Batch& b, double dt, int lanes) {
    const Double4 x = load(rx, lanes), y = load(ry, lanes);
    store(rx, x + dt * (b.cxx * x + b.cxy * y), lanes);
    store(ry, y + dt * (b.cyx * x + b.cyy * y), lanes);
}

/// Stress, damage and the column's own depth, which changes with its area: exp(-div dt) to second order.
/// Returns the work of the strains on the structure [J].
template <bool kWater, bool kHexagon>
[[gnu::always_inline]] inline Double4 strain_four(StructuredBody& body, const Batch& b, Index p, int lanes,
                                               double dt) {
    StructuredPoints& q = body.points;
    const Double4 half = (0.5 * dt) * (b.cxx + b.cyy), damage = load(&q.damage[p], lanes);
    const Double4 depth = load(&q.depth[p], lanes) * ((1.0 - half) / (1.0 + half));
    store(&q.depth[p], depth, lanes);
    const Mask4 whole = damage < 1.0;
    const Double4 none = {};
    if (!any(whole)) return none;
    const auto if_whole = [&](Double4 a) { return select(whole, a, none); };
    ColumnStateOf<Double4> state{{if_whole(load(&q.xx[p], lanes)), if_whole(load(&q.yy[p], lanes)),
                                  if_whole(load(&q.zz[p], lanes)), if_whole(load(&q.xy[p], lanes))},
                                 damage,
                                 load(&q.strain[p], lanes)};
    const auto step =
        ColumnStepOf<Double4>::of(if_whole(b.cxx), if_whole(b.cxy), if_whole(b.cyx), if_whole(b.cyy), dt);
    Double4 density = all(body.density);
    if constexpr (kWater) density = load(&q.mass[p], lanes) / max(load(&q.volume[p], lanes), all(1e-300));
    const Double4 weight = if_whole(-0.5 * density * b.pull * depth);
    const ColumnStressOf<Double4> old = state.stress;
    body.law.update_as<kHexagon>(step, weight, load(&q.cohesion[p], lanes), state);
    store(&q.xx[p], state.stress.xx, lanes), store(&q.yy[p], state.stress.yy, lanes);
    store(&q.zz[p], state.stress.zz, lanes), store(&q.xy[p], state.stress.xy, lanes);
    store(&q.damage[p], state.damage, lanes), store(&q.strain[p], state.strain, lanes);
    const ColumnStressOf<Double4>& now = state.stress;
    const Double4 work = (old.xx + now.xx) * step.xx + (old.yy + now.yy) * step.yy + 2.0 * (old.xy + now.xy) * step.xy;
    return (0.5 * body.share) * load(&q.volume[p], lanes) * (1.0 - damage) * work;
}

/// A column gives away what it released in the last step, and notes what breaking releases in this one.
void release(StructuredBody& body, Index p, double damage_before, StructuredSums& sums) {
    StructuredPoints& q = body.points;
    const double gone = q.released[p];
    if (gone > 0.0) {
        const double left = q.volume[p] - gone;
        q.mass[p] -= body.water->by.material.fluid_density * gone;
        q.depth[p] *= left / q.volume[p], q.volume[p] = left;
        sums.released += gone;
    }
    const double whole = 1.0 - damage_before;
    q.released[p] = whole > 0.0 ? q.confined[p] * ((q.damage[p] - damage_before) / whole) : 0.0;
    q.confined[p] -= q.released[p];
}

/// Elastic energy of a column's structure in the plane [J].
double stored(const StructuredBody& body, Index p) {
    const StructuredPoints& q = body.points;
    const ColumnMaterial& of = body.law.material();
    const double xx = q.xx[p], yy = q.yy[p], xy = q.xy[p];
    const double twice = (xx * xx + yy * yy - 2.0 * of.poisson * xx * yy + 2.0 * (1.0 + of.poisson) * xy * xy) / of.young;
    return 0.5 * q.volume[p] * body.share * (1.0 - q.damage[p]) * twice;
}

/// The ground at the node nearest to a column.
const StructuredBody::Pull& ground_below(const StructuredBody& body, Index p) {
    const StructuredPoints& q = body.points;
    return body.pull[body.grid.at(static_cast<Index>(std::floor(q.x[p] + 0.5)), static_cast<Index>(std::floor(q.y[p] + 0.5)))];
}

/// Sums of a column, and what bounds the next step. Columns leave beyond the outer nodes, and where there is
/// no ground.
void count(StructuredBody& body, Index p, StructuredSums& sums) {
    const StructuredPoints& q = body.points;
    const double m = q.mass[p], speed2 = q.vx[p] * q.vx[p] + q.vy[p] * q.vy[p];
    const double finite = q.x[p] + q.y[p] + speed2 + q.xx[p] + q.yy[p] + q.xy[p] + q.damage[p] + q.depth[p];
    if (!std::isfinite(finite)) {
        sums.bad = p;
        return;
    }
    const Vec2 momentum = m * Vec2(q.vx[p], q.vy[p]);
    const bool inside = q.x[p] >= 0.0 && q.y[p] >= 0.0 &&
                        q.x[p] <= static_cast<double>(body.grid.nx()) - 1.0 &&
                        q.y[p] <= static_cast<double>(body.grid.ny()) - 1.0;
    if (!inside || ground_below(body, p).exit > 0.0) {
        body.gone[static_cast<std::size_t>(p)] = 1;
        sums.left_mass += m, sums.left_momentum += momentum;
        sums.left_confined += q.confined[p] + q.released[p];
        sums.left_energy += m * (0.5 * speed2 + body.gravity * (inside ? ground_below(body, p).elevation : 0.0));
        return;
    }
    sums.mass += m, sums.kinetic += 0.5 * m * speed2, sums.damaged += m * q.damage[p],
        sums.momentum += momentum, sums.speeds += m * std::sqrt(speed2);
    sums.stored += stored(body, p);
    sums.max_speed2 = std::max(sums.max_speed2, speed2);
    const double depth = q.damage[p] < 1.0 ? std::max(q.layer[p], q.depth[p]) : q.layer[p];
    sums.max_wave = std::max(sums.max_wave, std::sqrt(speed2) + std::sqrt(2.0 * q.pull[p] * depth));
}

}  // namespace

void clear_nodes(StructuredBody& body) {
    for_each_work_tile(body.active, [&](Index, Index tile) {
        const Index first = body.grid.at(body.grid.tile_i(tile), body.grid.tile_j(tile));
        for (Index j = 0; j < kTile; ++j) {
            std::fill_n(&body.nodes[first + j * body.grid.stride()], kTile, Deposit{});
            std::fill_n(&body.node_mass[first + j * body.grid.stride()], kTile, 0.0);
            if (body.grains) {
                std::fill_n(&body.push[first + j * body.grid.stride()], kTile, Push{});
                std::fill_n(&body.flow.nodes.column_mass[first + j * body.grid.stride()], kTile, 0.0);
            }
            if (body.water)
                std::fill_n(&body.bound[first + j * body.grid.stride()], kTile, StructuredBody::Bound{});
        }
    });
}

namespace {

template <bool kGrains, bool kWater>
void scatter_tile(StructuredBody& body, Index n, double kick) {
    const StructuredPoints& q = body.points;
    const Index stride = body.grid.stride(), end = body.active.begin[n + 1], tile = body.active.tile[n];
    const double cell = body.grid.cell();
    const bool at_side = near_side(body.grid, tile);
    StencilMarks marks = body.flow.marks_of(tile);
    for (Index p = body.active.begin[n]; p < end; p += 4) {
        const int lanes = static_cast<int>(std::min<Index>(4, end - p));
        const Stencils sx(load(&q.x[p], lanes)), sy(load(&q.y[p], lanes));
        Double4 cxx = load(&q.cxx[p], lanes), cxy = load(&q.cxy[p], lanes), cyx = load(&q.cyx[p], lanes),
                cyy = load(&q.cyy[p], lanes), push[4];
        bool pushes = false;
        if constexpr (kGrains) {
            limit_gradients(domains(q, p, lanes), cxx, cxy, cyx, cyy);
            pushes = grain_pushes(body, p, lanes, push);
        }
        for (int lane = 0; lane < lanes; ++lane) {
            const Index one = p + lane;
            const Reach reach(sx, sy, stride, lane);
            const Gradient c{cxx[lane], cxy[lane], cyx[lane], cyy[lane]};
            give(body.nodes, body.node_mass, stride, reach, sx.offset[lane], sy.offset[lane],
                 gift_of(q, one, c, body.share, kick, cell));
            if constexpr (kGrains)
                if (pushes) give(body.push.data(), stride, reach, push[lane]);
            if constexpr (kWater) give(body.bound.data(), stride, reach, bound_of(body, one));
            if constexpr (kGrains) marks.mark(sx.first[lane], sy.first[lane]);
        }
        if constexpr (kGrains) spread<kWater>(body, p, lanes, at_side);
    }
    constexpr int kBefore = 1, kAfter = 3;  // nodes that sub-points touch around the first of a stencil
    if constexpr (kGrains) body.flow.reach[tile] = marks.reach(kBefore, kAfter);
}

}  // namespace

void scatter(StructuredBody& body, double kick) {
    with_kinds(body, [&](auto grains, auto water) {
        for_each_tile_coloured(body.active, [&](Index n) { scatter_tile<grains.value, water.value>(body, n, kick); });
    });
}

void press(StructuredBody& body) {
    StructuredPoints& q = body.points;
    for_each_tile(body.active, [&](Index n) {
        for (Index p = body.active.begin[n]; p < body.active.begin[n + 1]; ++p) {
            q.pull[p] = take_four(body, p, 1).pull[0];
            q.zz[p] = -0.5 * body.density * q.pull[p] * q.depth[p];
        }
    });
}

namespace {

template <bool kGrains, bool kWater, bool kHexagon>
StructuredSums gather_tile(StructuredBody& body, Index n, double dt) {
    StructuredPoints& q = body.points;
    const double cells = dt / body.grid.cell();
    const Index end = body.active.begin[n + 1];
    StructuredSums sums;
    Double4 worked = {};
    for (Index p = body.active.begin[n]; p < end; p += 4) {
        const int lanes = static_cast<int>(std::min<Index>(4, end - p));
        const Batch b = take_four(body, p, lanes);
        store(&q.vx[p], b.vx, lanes), store(&q.vy[p], b.vy, lanes);
        store(&q.cxx[p], b.cxx, lanes), store(&q.cxy[p], b.cxy, lanes);
        store(&q.cyx[p], b.cyx, lanes), store(&q.cyy[p], b.cyy, lanes);
        store(&q.pull[p], b.pull, lanes), store(&q.layer[p], b.layer, lanes);
        store(&q.x[p], load(&q.x[p], lanes) + cells * b.vx, lanes);
        store(&q.y[p], load(&q.y[p], lanes) + cells * b.vy, lanes);
        if constexpr (kGrains) {
            stretch(&q.r1x[p], &q.r1y[p], b, dt, lanes);
            stretch(&q.r2x[p], &q.r2y[p], b, dt, lanes);
        }
        const Double4 damage = load(&q.damage[p], lanes);
        worked += strain_four<kWater, kHexagon>(body, b, p, lanes, dt);
        if constexpr (kWater)
            for (int lane = 0; lane < lanes; ++lane) release(body, p + lane, damage[lane], sums);
        for (int lane = 0; lane < lanes; ++lane) count(body, p + lane, sums);
    }
    sums.worked = sum(worked);
    return sums;
}

}  // namespace

void gather(StructuredBody& body, double dt) {
    with_kinds(body, [&](auto grains, auto water) {
        const auto as = [&](auto hexagon) {
            for_each_tile(body.active, [&](Index n) {
                body.sums[static_cast<std::size_t>(n)] =
                    gather_tile<grains.value, water.value, hexagon.value>(body, n, dt);
            });
        };
        if (body.law.is_hexagon())
            as(std::true_type{});
        else
            as(std::false_type{});
    });
}

}  // namespace frana
