// The bed gains: material that has been at rest for a time becomes bed (THEORY.md, section 20).
#include <algorithm>
#include <cmath>
#include <utility>

#include "shallow/erosion.h"
#include "shallow/sub_points.h"
#include "shallow/tiles_around.h"

namespace frana {
namespace {

/// How often material at rest is searched for within the time that it has to rest. Each time all that stay close their
/// ranks.
constexpr double kLooks = 10.0;

/// Whether a step ended a stretch of time, or a time [s] of none.
bool ends_stretch(const Clock& now, double stretch) {
    return !(stretch > 0.0) || std::floor(now.time / stretch) != std::floor((now.time - now.dt) / stretch);
}

/// Whether a point is no faster than `slowest` [m/s], and a cell of `cell` [m] next to it neither.
template <class Real>
bool is_still(const Carried<Real>& held, Index p, double slowest, double cell) {
    for (const auto* array : {&held.cxx, &held.cxy, &held.cyx, &held.cyy})
        if (!(cell * std::abs(double{(*array)[p]}) <= slowest)) return false;
    return std::hypot(double{held.vx[p]}, double{held.vy[p]}) <= slowest;
}

}  // namespace

void Erosion::prepare_deposition(const Scene& scene, const Flow& flow) {
    if (!scene.deposition && !scene.forest) return;
    deposits_ = true;
    fresh_ = LazyArray<double>(flow.grid.size());
    ledger_tiles_.reserve(static_cast<std::size_t>(flow.grid.tiles()));  // steps allocate nothing
    if (scene.deposition) rest_time_ = scene.deposition->rest;
    raised_tiles_.reserve(2 * static_cast<std::size_t>(flow.grid.tiles()));  // what rests, and what trees take
    if (takes_) raised_ = LazyArray<double>(flow.grid.size());
    if (!rest_time_) return;
    clocks_ = RestClocks(flow.grid);
    rest_fraction_ = scene.rest_fraction;
}

std::optional<ExchangeSums> Erosion::settle(Flow& flow, const Status& now) {
    unmark_raised(flow), raised_tiles_.clear();
    if (!rest_time_) return {};
    note_slowest(flow, now);
    clocks_.tick(flow, now.dt, slowest_);
    if (!ends_stretch(now, *rest_time_ / kLooks) || !find_settled(flow)) return {};
    give(flow);
    for (const Index tile : next_)  // whose slopes or smoothed bed have changed
        for_each_around(flow.grid, tile, [&](Index to) {
            if (flow.active.in_work[to]) wake(flow, to);
        });
    ExchangeSums all;
    for (Index n = 0; n < flow.active.count(); ++n) {
        if (!eroding_[static_cast<std::size_t>(n)]) continue;
        const ExchangeSums& of = sums_[static_cast<std::size_t>(n)];
        all.taken += of.taken, all.px += of.px, all.py += of.py, all.lost += of.lost;
    }
    return all;
}

void Erosion::begin(const Flow& flow, Index first, bool anew) {
    if (!rest_time_) return;
    Index last = -1;
    for (Index p = first; p < flow.particles.count(); ++p) {
        const auto i = static_cast<Index>(std::lround(flow.particles.x[p])),
                   j = static_cast<Index>(std::lround(flow.particles.y[p]));
        const Index tile = flow.grid.tile_of_node(i, j);
        if (std::exchange(last, tile) == tile) continue;
        for_each_around(flow.grid, tile, [&](Index to) { clocks_.begin(flow.grid, to, anew); });
    }
}

/// THEORY.md, section 20. As the rest of a run (63), of which the first two are. And it goes no tenth of a cell while
/// it has to rest.
void Erosion::note_slowest(const Flow& flow, const Status& now) {
    constexpr double kOfCell = 0.1;
    const double became_bed = std::max(0.0, now.bed.deposited - now.bed.eroded), all = now.mass + became_bed;
    if (all > 0.0) peak_mean_speed_ = std::max(peak_mean_speed_, now.mean_speed * now.mass / all);
    slowest_ = rest_fraction_ * peak_mean_speed_;
    if (now.time > 0.0) slowest_ = std::min(slowest_, 2.0 * flow.cell / now.time);
    if (*rest_time_ > 0.0) slowest_ = std::min(slowest_, kOfCell * flow.cell / *rest_time_);
}

/// Those may give again.
void Erosion::unmark_raised(const Flow& flow) {
    for (const Index tile : raised_tiles_)
        if (raised_) for_each_node_of(flow.grid, tile, [&](Index k, Index, Index) { raised_[k] = 0.0; });
}

/// Which points give all that they have, and their tiles.
bool Erosion::find_settled(Flow& flow) {
    eroding_.assign(static_cast<std::size_t>(flow.active.count()), 0);
    assign_sparingly(gone_, static_cast<std::size_t>(flow.particles.count()), std::uint8_t{0});
    make_room(flow);
    flow.particles.with_real([&](auto real) {
        for_each_tile(flow.active, [&](Index n) {
            bool near = false;
            for_each_around(flow.grid, flow.active.tile[n],
                            [&](Index to) { near = near || clocks_.any_has_run(to, *rest_time_); });
            eroding_[static_cast<std::size_t>(n)] = near && choose_settled<decltype(real)>(flow, n);
        });
    });
    return std::any_of(eroding_.begin(), eroding_.end(), [](std::uint8_t one) { return one != 0; });
}

template <class Real>
bool Erosion::choose_settled(const Flow& flow, Index n) {
    const Carried<Real>& held = flow.particles.carried<Real>();
    ExchangeSums sums;
    bool any = false;
    for (Index p = flow.active.begin[n]; p < flow.active.begin[n + 1]; ++p) {
        const bool settles = is_still(held, p, slowest_, flow.cell) && lies_on_rest<Real>(flow, p);
        wanted_[p] = settles ? flow.particles.mass[p] : 0.0;
        gone_[static_cast<std::size_t>(p)] = settles;
        any = any || settles;
        if (!settles) continue;
        const Index k = flow.grid.nearest(flow.particles.x[p], flow.particles.y[p]);
        const double mass = wanted_[p], vx = held.vx[p], vy = held.vy[p];
        const double rise = flow.steep ? vx * flow.bed.slope_x[k] + vy * flow.bed.slope_y[k] : 0.0;
        sums.taken -= mass, sums.px -= mass * vx, sums.py -= mass * vy;
        sums.lost += 0.5 * mass * (vx * vx + vy * vy + rise * rise);
    }
    sums_[static_cast<std::size_t>(n)] = sums;
    return any;
}

/// Whether all nodes that a point deposits on have rested. Mass is on those of its sub-points, momentum on those around itself.
template <class Real>
bool Erosion::lies_on_rest(const Flow& flow, Index p) const {
    const Particles& c = flow.particles;
    bool rest = true;
    const auto look = [&](const Quadratic& sx, const Quadratic& sy) {
        for (int j = 0; j < 3; ++j)
            for (int i = 0; i < 3; ++i)
                rest = rest && clocks_.have_run(flow.grid.at(sx.base + i, sy.base + j), *rest_time_);
    };
    look(Quadratic(c.x[p]), Quadratic(c.y[p]));
    if (rest) for_each_sub_point<Quadratic>(flow, c.x[p], c.y[p], edges_of(c.carried<Real>(), p), look);
    return rest;
}

/// What the points of the tiles chosen give, `wanted_`, lies on the bed as they would have deposited it. z
/// rises by what the flow's depth falls.
void Erosion::give(Flow& flow) {
    list_given(flow);
    CompensatedSum given;
    for (Index n = 0; n < flow.active.count(); ++n) {
        if (!eroding_[static_cast<std::size_t>(n)]) continue;
        for (Index p = flow.active.begin[n]; p < flow.active.begin[n + 1]; ++p) given.add(wanted_[p]);
    }
    deposited_.add(given.value());
    flow.particles.with_real([&](auto real) {
        for_each_eroding_in_turn(flow, [&](Index n) { spread<decltype(real)>(flow, n, wanted_, demand_); });
    });
    collect_reach(flow);
    fold(flow, demand_);
    for_each_in_parallel(nodes_, [&](Index tile) { raise_tile(flow, tile); });
    for (const Index tile : nodes_) {
        energy_.add(tile_energy_[tile]);
        if (!marked_[static_cast<std::size_t>(tile)]) continue;
        list_ledger(tile);
        raised_tiles_.push_back(tile);
    }
    follow_bed(flow);
    status_changed();
}

/// Tiles whose nodes the chosen ones reach; at walls all, since mirror particles lie beyond.
void Erosion::list_given(const Flow& flow) {
    nodes_.clear();
    for (Index n = 0; n < flow.active.count(); ++n)
        if (eroding_[static_cast<std::size_t>(n)])
            for_each_around(flow.grid, flow.active.tile[n],
                            [&](Index to) { marked_[static_cast<std::size_t>(to)] = 1; });
    for (const Index tile : flow.active.work)
        if (std::exchange(marked_[static_cast<std::size_t>(tile)], std::uint8_t{0}) || flow.walls)
            nodes_.push_back(tile);
}

void Erosion::raise_tile(Flow& flow, Index tile) {
    double energy = 0.0;
    TileBox any;
    for_each_node_of(flow.grid, tile, in_reach_[tile], [&](Index k, Index i, Index j) {
        const double given = std::exchange(demand_[k], 0.0);
        if (!(given > 0.0)) return;
        const double rises = given * per_area_of_flow_;
        energy -= flow.share(i, j) * flow.gravity * given * (flow.bed.z[k] + 0.5 * rises);
        fresh_[k] += given;
        if (raised_) raised_[k] = 1.0;
        flow.bed.z[k] += rises;
        flow.bed.ground[k] += rises;
        if (bent_path_) pending_[k] += rises;
        any.add(one_node(flow.grid, tile, i, j));
    });
    tile_energy_[tile] = energy;
    if (any.empty()) return;
    moved_[tile] = any;
    if (bent_path_) tile_pending_[tile] = most_pending(flow, tile);
    changed_[tile] = 1;
    marked_[static_cast<std::size_t>(tile)] = 1;
    count_tile(flow, tile);
}

/// The ledger's sums go over its tiles in ascending order.
void Erosion::list_ledger(Index tile) {
    const auto place = std::lower_bound(ledger_tiles_.begin(), ledger_tiles_.end(), tile);
    if (place == ledger_tiles_.end() || *place != tile) ledger_tiles_.insert(place, tile);
}

void Erosion::serialize_deposition(Archive& archive, const Flow& flow) {
    const auto deposited = deposited_.parts();
    archive.numbers("deposited", {deposited[0], deposited[1]});
    if (!rest_time_) return;
    archive.numbers("slow", {&peak_mean_speed_});
    clocks_.serialize(archive, flow);
}

}  // namespace frana
