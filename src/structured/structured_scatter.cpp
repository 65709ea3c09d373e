// What particles bring to the nodes in a step of structured solids. Four are done at once, and sums over nodes have one
// order.
#include <algorithm>

#include "base/touch.h"
#include "mpm/tile_points.h"
#include "shallow/scatter_four.h"
#include "shallow/sub_points_of_four.h"
#include "structured/structured_flow.h"

namespace frana {
namespace {

using GrainPressure = StructuredBody::GrainPressure;

/// Four numbers of a particle on its nodes.
template <class Four>
[[gnu::always_inline]] inline void add_to_nodes(Four* nodes, Index stride, const Reach& r, Double4 k) {
    Four* first = nodes + r.node;
    for (int j = 0; j < 3; ++j, first += stride) {
        const Double4 row = r.wy[j] * k;
        for (int i = 0; i < 3; ++i) store(first + i, load(first + i) + r.wx[i] * row);
    }
}

/// What a particle is made of.
Double4 bound_of(const StructuredBody& body, Index p) {
    const StructuredPoints& q = body.points;
    const double solids = q.solids[p];
    return Double4{q.volume[p], q.released[p], solids, solids * body.share * (1.0 - q.damage[p])};
}

[[gnu::always_inline]] inline Domains domains(const StructuredPoints& q, Index p, int lanes) {
    return {load(&q.r1x[p], lanes), load(&q.r1y[p], lanes), load(&q.r2x[p], lanes), load(&q.r2y[p], lanes)};
}

/// V s sigma / cell of four particles [N], s the share that is whole.
[[gnu::always_inline]] inline PlaneOf<Double4> internal_force_of(const StructuredBody& body, Index p, int lanes,
                                                                 Double4 intact) {
    const StructuredPoints& q = body.points;
    const Double4 scale = (1.0 / body.grid.cell()) * load(&q.volume[p], lanes) * intact;
    return {scale * load(&q.xx[p], lanes), scale * load(&q.yy[p], lanes), scale * load(&q.xy[p], lanes)};
}

/// What the grains of four particles give their nodes, particle by particle: m (1 - f) K, m (1 - f). False if none has
/// any.
[[gnu::always_inline]] inline bool grain_pressures(const StructuredBody& body, Index p, int lanes, Double4 grains,
                                                   Double4 thrust[4]) {
    if (!any(grains != 0.0)) return false;
    const StructuredPoints& q = body.points;
    const Sym2Of<Double4> rate{load(&q.cxx[p], lanes), load(&q.cyy[p], lanes),
                               0.5 * (load(&q.cxy[p], lanes) + load(&q.cyx[p], lanes))};
    const Double4 normal_gravity = load(&q.normal_gravity[p], lanes), none = {};
    // Nothing presses on the bed where water bears all: then there is no pressure either.
    const Double4 layer = select(normal_gravity > 0.0, load(&q.layer[p], lanes), none),
                  across = select(normal_gravity > 0.0, normal_gravity, all(1.0));
    const Sym2Of<Double4> k = earth_pressure_of<Double4>(rate, layer, across, body.rankine);
    transpose(grains * k.xx, grains * k.yy, grains * k.xy, grains, thrust);
    return true;
}

/// The mass of four particles on the nodes, from their sub-points. What was released is water already.
template <bool kWater>
[[gnu::always_inline]] inline void spread(StructuredBody& body, Index p, int lanes, bool at_side, Double4 x, Double4 y,
                                          Double4 mass, const Domains& r) {
    const StructuredPoints& q = body.points;
    if constexpr (kWater) mass = body.density * (load(&q.volume[p], lanes) - load(&q.released[p], lanes));
    if (!at_side && spread_four(body.flow, body.flow.nodes.column_mass.data(), lanes, x, y, mass, r)) return;
    for (int n = 0; n < lanes; ++n)
        spread_particle<Quadratic>(body.flow, body.flow.nodes.column_mass.data(), {x[n], y[n], mass[n]},
                                   edges_of(q, p + n));
}

/// How deep the structure of four particles is by itself, weighted with its mass. What was released is water already.
template <bool kWater>
[[gnu::always_inline]] inline void spread_block_depths(StructuredBody& body, Index p, int lanes, const Stencils& sx,
                                                       const Stencils& sy, Double4 mass) {
    const StructuredPoints& q = body.points;
    const Index stride = body.grid.stride();
    Double4 depth = load(&q.depth[p], lanes);
    if constexpr (kWater) depth *= 1.0 - load(&q.released[p], lanes) / max(load(&q.volume[p], lanes), all(1e-300));
    const Double4 brought = mass * depth;
    Double4 row[4];
    transpose(sx.w[0] * brought, sx.w[1] * brought, sx.w[2] * brought, Double4{}, row);
    for (int n = 0; n < lanes; ++n) {
        double* node = body.block_depth.data() + sy.first[n] * stride + sx.first[n];
        for (int j = 0; j < 3; ++j, node += stride) store(node, load(node) + sy.w[j][n] * row[n]);
    }
}

/// Four particles at once.
template <bool kGrains, bool kWater>
[[gnu::always_inline]] inline void scatter_particles(StructuredBody& body, Index p, int lanes, bool at_side,
                                                     StencilMarks& marks) {
    const StructuredPoints& q = body.points;
    const Index stride = body.grid.stride();
    const Double4 x = load(&q.x[p], lanes), y = load(&q.y[p], lanes), m = load(&q.mass[p], lanes);
    const Stencils sx(x), sy(y);
    Double4 cxx = load(&q.cxx[p], lanes), cxy = load(&q.cxy[p], lanes), cyx = load(&q.cyx[p], lanes),
            cyy = load(&q.cyy[p], lanes);
    const Double4 intact = body.share * (1.0 - load(&q.damage[p], lanes));
    Domains r{};
    if constexpr (kGrains) {
        r = domains(q, p, lanes);
        limit_gradients(r, cxx, cxy, cyx, cyy);
    }
    const Double4 mc = body.grid.cell() * m;
    scatter_four(body.flow.nodes, stride, lanes, sx, sy,
                 {m, m * load(&q.vx[p], lanes), m * load(&q.vy[p], lanes), mc * cxx, mc * cxy, mc * cyx, mc * cyy},
                 internal_force_of(body, p, lanes, intact));
    if (body.by_depth) spread_block_depths<kWater>(body, p, lanes, sx, sy, m * intact);
    if constexpr (kGrains) {
        Double4 thrust[4];
        if (grain_pressures(body, p, lanes, m * (1.0 - intact), thrust))
            for (int n = 0; n < lanes; ++n)
                add_to_nodes(body.grain_pressure.data(), stride, Reach(sx, sy, stride, n), thrust[n]);
        marks.mark(sx.first, sy.first, lanes);
        spread<kWater>(body, p, lanes, at_side, x, y, m, r);
    }
    if constexpr (kWater)
        for (int n = 0; n < lanes; ++n)
            add_to_nodes(body.bound.data(), stride, Reach(sx, sy, stride, n), bound_of(body, p + n));
}

/// Reads ahead (base/touch.h) what a batch of particles brings.
template <bool kGrains>
void touch_particles(const StructuredPoints& q, Index first, Index end) {
    const Array* const list[] = {
        &q.x,  &q.y,  &q.mass,           &q.vx,    &q.vy,  &q.cxx, &q.cxy, &q.cyx, &q.cyy, &q.damage, &q.volume, &q.xx,
        &q.yy, &q.xy, &q.normal_gravity, &q.layer, &q.r1x, &q.r1y, &q.r2x, &q.r2y};
    constexpr int kWithGrains = sizeof list / sizeof list[0], kCount = kGrains ? kWithGrains : kWithGrains - 6;
    for (Index p = first; p < end; p += kCacheLine / sizeof(double))
        for (int n = 0; n < kCount; ++n) touch(list[n]->data() + p);
}

template <bool kGrains>
void touch_nodes(const StructuredBody& body, Index n) {
    for_each_row_of_full(body.grid, body.active, n, [&](Index k, Index count) {
        touch(body.nodes + k, count);
        touch(body.node_mass + k, count);
        if constexpr (kGrains)
            touch(body.grain_pressure.data() + k, count), touch(body.flow.nodes.column_mass.data() + k, count);
    });
}

template <bool kGrains, bool kWater>
void scatter_tile(StructuredBody& body, Index n) {
    constexpr Index kBatch = 128;
    const Index end = body.active.begin[n + 1], tile = body.active.tile[n];
    const bool at_side = near_side(body.grid, tile);
    StencilMarks marks = body.flow.marks_of(tile);
    touch_nodes<kGrains>(body, n);
    for (Index first = body.active.begin[n]; first < end; first += kBatch) {
        const Index last = std::min(first + kBatch, end);
        touch_particles<kGrains>(body.points, first, last);
        for_each_four(first, last,
                      [&](Index p, int lanes) { scatter_particles<kGrains, kWater>(body, p, lanes, at_side, marks); });
    }
    if constexpr (kGrains) body.flow.reach[tile] = marks.reach(kReachBefore, kReachAfter);
}

}  // namespace

void clear_nodes(StructuredBody& body) {
    for_each_work_tile(body.active, [&](Index, Index tile) {
        const Index first = body.grid.at(body.grid.tile_i(tile), body.grid.tile_j(tile));
        for (Index j = 0; j < kTile; ++j) {
            std::fill_n(&body.nodes[first + j * body.grid.stride()], kTile, Deposit{});
            std::fill_n(&body.node_mass[first + j * body.grid.stride()], kTile, 0.0);
            if (body.by_depth) std::fill_n(&body.block_depth[first + j * body.grid.stride()], kTile, 0.0);
            if (body.grains) {
                std::fill_n(&body.grain_pressure[first + j * body.grid.stride()], kTile, GrainPressure{});
                std::fill_n(&body.flow.nodes.column_mass[first + j * body.grid.stride()], kTile, 0.0);
            }
            if (body.water) std::fill_n(&body.bound[first + j * body.grid.stride()], kTile, StructuredBody::Bound{});
        }
    });
}

void scatter(StructuredBody& body) {
    with_kinds(body, [&](auto grains, auto water) {
        for_each_tile_in_turn(body.active, [&](Index n) { scatter_tile<grains.value, water.value>(body, n); });
    });
}

}  // namespace frana
