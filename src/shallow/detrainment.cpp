// Trees take mass out of the flow, with the velocity that it has (THEORY.md, section 21).
#include <algorithm>

#include "mpm/tile_points.h"
#include "shallow/erosion.h"
#include "shallow/feed.h"
#include "shallow/ground_of_four.h"
#include "shallow/tiles_around.h"

namespace frana {
namespace {

/// Of the largest particle: lighter ones are not left. In a thin flow each step takes a share of what there is, without
/// end.
constexpr double kLeastShare = 1e-6;

}  // namespace

void Erosion::prepare_forest(const Scene& scene, const Flow& flow) {
    if (!scene.forest) return;
    const TileGrid& grid = flow.grid;
    forest_ = scene.forest->law;
    least_mass_ = kLeastShare * scene.density * largest_particle(scene);
    trees_ = LazyArray<double>(grid.size());
    wooded_.assign(static_cast<std::size_t>(grid.tiles()), 0);
    for (Index j = 0; j < grid.ny(); ++j)
        for (Index i = 0; i < grid.nx(); ++i)
            if (const double pressure = scene.forest->pressure.at(i, j); pressure > 0.0)
                trees_[grid.at(i, j)] = pressure;
    for (Index tile = 0; tile < grid.tiles(); ++tile) {
        bool any = false;
        for_each_node_of(grid, tile, [&](Index k, Index, Index) { any = any || trees_[k] > 0.0; });
        if (any) for_each_around(grid, tile, [&](Index to) { wooded_[static_cast<std::size_t>(to)] = 1; });
    }
}

ExchangeSums Erosion::detrain(Flow& flow, double dt) {
    ExchangeSums all;
    any_gone_ = false;
    if (!trees_ || !(dt > 0.0) || !choose_wooded(flow)) return all;
    make_room(flow);
    assign_sparingly(gone_, static_cast<std::size_t>(flow.particles.count()), std::uint8_t{0});
    flow.particles.with_real(
        [&](auto real) { for_each_eroding(flow, [&](Index n) { lose<decltype(real)>(flow, n, dt); }); });
    CompensatedSum taken, px, py, lost;
    for (const ExchangeSums& of : sums_) taken.add(of.taken), px.add(of.px), py.add(of.py), lost.add(of.lost);
    all.taken = taken.value(), all.px = px.value(), all.py = py.value(), all.lost = lost.value();
    if (!(all.taken < 0.0)) return all;
    any_gone_ = std::find(gone_.begin(), gone_.end(), std::uint8_t{1}) != gone_.end();
    give(flow);
    return all;
}

/// Tiles whose points may be among trees. What sleeps does not move.
bool Erosion::choose_wooded(const Flow& flow) {
    const ActiveTiles& active = flow.active;
    eroding_.assign(static_cast<std::size_t>(active.count()), 0);
    bool any = false;
    for (Index n = 0; n < active.count(); ++n) {
        const Index tile = active.tile[n];
        if (!wooded_[static_cast<std::size_t>(tile)] || active.quiet[tile] >= kAsleep) continue;
        any = true, eroding_[static_cast<std::size_t>(n)] = 1;
    }
    return any;
}

/// THEORY (80): velocities are those of the middle of the step, depths those of its start.
template <class Real>
void Erosion::lose(Flow& flow, Index n, double dt) {
    Particles& c = flow.particles;
    const Carried<Real>& held = c.carried<Real>();
    ExchangeSums sums;
    for_each_four(flow.active.begin[n], flow.active.begin[n + 1], [&](Index p, int lanes) {
        const Double4 none = {}, one = all(1.0);
        store(&wanted_[p], none, lanes);
        const Double4 x = load(&c.x[p], lanes), y = load(&c.y[p], lanes);
        Double4 pressure = none;
        for (int lane = 0; lane < lanes; ++lane) pressure[lane] = trees_[flow.grid.nearest(x[lane], y[lane])];
        const Double4 vx = load(&held.vx[p], lanes), vy = load(&held.vy[p], lanes);
        const Mask4 moves = (pressure > none) & (sqrt(vx * vx + vy * vy) > kSlowest);
        if (!any(moves)) return;
        const Double4 depth = max(none, load(&held.depth[p], lanes));
        const MeansOfFour means(flow.grid, x, y);
        const GroundOfFour ground(flow, false, means, select(moves, vx, one), select(moves, vy, none), depth);
        for (int lane = 0; lane < lanes; ++lane) {
            if (!moves[lane]) continue;
            const double speed = ground.speed[lane];
            const double share =
                forest_.share({pressure[lane], flow.density, depth[lane], ground.below.thickness[lane], speed}, dt);
            if (!(share > 0.0)) continue;
            const Index q = p + lane;
            const double mass = c.mass[q], rest = (1.0 - share) * mass, left = rest > least_mass_ ? rest : 0.0;
            const double lost = wanted_[q] = mass - left;
            if (left > 0.0)
                c.mass[q] = left;
            else
                gone_[static_cast<std::size_t>(q)] = 1;
            sums.taken -= lost, sums.px -= lost * vx[lane], sums.py -= lost * vy[lane];
            sums.lost += 0.5 * lost * speed * speed;
        }
    });
    sums_[static_cast<std::size_t>(n)] = sums;
    eroding_[static_cast<std::size_t>(n)] = sums.taken < 0.0;
}

template void Erosion::lose<double>(Flow&, Index, double);
template void Erosion::lose<float>(Flow&, Index, double);

}  // namespace frana
