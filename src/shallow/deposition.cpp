// The bed gains: material that has been at rest for a time becomes bed (THEORY.md, section 20).
#include <algorithm>
#include <utility>

#include "mpm/stored_points.h"
#include "shallow/bed_tiles.h"
#include "shallow/erosion.h"

namespace frana {
namespace {

/// Whether a tile has points and none of them moves or would turn.
template <class Real>
bool all_rest(const Flow& flow, Index n) {
    const Carried<Real>& held = flow.columns.carried<Real>();
    const Index first = flow.active.begin[n], end = flow.active.begin[n + 1];
    for (Index p = first; p < end; ++p)
        for (const auto* column : {&held.vx, &held.vy, &held.cxx, &held.cxy, &held.cyx, &held.cyy})
            if ((*column)[p] != Real{0}) return false;
    return first < end;
}

}  // namespace

void Erosion::prepare_deposition(const Scene& scene, const Flow& flow) {
    if (!scene.deposition) return;
    deposits_ = true;
    fresh_ = LazyArray<double>(flow.grid.size());
    rested_ = LazyArray<double>(flow.grid.tiles());
    seen_ = LazyArray<Index>(flow.grid.tiles());
    ledger_tiles_.reserve(static_cast<std::size_t>(flow.grid.tiles()));  // steps allocate nothing
    rest_time_ = scene.deposition->rest;
}

bool Erosion::settle(Flow& flow, const Clock& now) {
    if (!rest_time_ || !find_settled(flow, now)) return false;
    const Index count = flow.columns.count();
    assign_sparingly(gone_, static_cast<std::size_t>(count), std::uint8_t{0});
    make_room(flow);
    for_each_eroding(flow, [&](Index n) {
        for (Index p = flow.active.begin[n]; p < flow.active.begin[n + 1]; ++p) {
            wanted_[p] = flow.columns.mass[p];
            gone_[static_cast<std::size_t>(p)] = 1;
        }
    });
    give(flow);
    return true;
}

/// Counts how long each tile has been at rest, by its points alone: what sleeps is found anew after a load.
bool Erosion::find_settled(Flow& flow, const Clock& now) {
    const ActiveTiles& active = flow.active;
    eroding_.assign(static_cast<std::size_t>(active.count()), 0);
    last_step_ = now.step;
    flow.columns.with_real([&](auto real) {
        using Real = decltype(real);
        for_each_tile(active, [&](Index n) {
            const Index tile = active.tile[n];
            const bool asleep = active.quiet[tile] >= kAsleep && active.begin[n] < active.begin[n + 1];
            if (!asleep && !all_rest<Real>(flow, n)) return;
            const bool again = seen_[tile] == now.step - 1;  // what has just come in has felt no force yet
            rested_[tile] = again ? rested_[tile] + now.dt : 0.0;
            seen_[tile] = now.step;
            eroding_[static_cast<std::size_t>(n)] = again && rested_[tile] >= *rest_time_;
        });
    });
    return std::any_of(eroding_.begin(), eroding_.end(), [](std::uint8_t one) { return one != 0; });
}

/// What the points of the tiles chosen give lies on the bed from now on, as they would have deposited it: z rises by what the
/// flow's depth falls.
void Erosion::give(Flow& flow) {
    list_given(flow);
    CompensatedSum given;
    for (Index n = 0; n < flow.active.count(); ++n) {
        if (!eroding_[static_cast<std::size_t>(n)]) continue;
        for (Index p = flow.active.begin[n]; p < flow.active.begin[n + 1]; ++p) given.add(wanted_[p]);
    }
    deposited_.add(given.value());
    flow.columns.with_real([&](auto real) {
        for_each_eroding_coloured(flow, [&](Index n) { spread<decltype(real)>(flow, n, wanted_, demand_); });
    });
    fold(flow, demand_);
    for_each_in_parallel(nodes_, [&](Index tile) { raise_tile(flow, tile); });
    for (const Index tile : nodes_) {
        energy_.add(tile_energy_[tile]);
        if (marked_[static_cast<std::size_t>(tile)]) list_ledger(tile);
    }
    follow_bed(flow);
    status_changed();
}

/// Tiles whose nodes the chosen ones reach; at walls all, since images lie beyond.
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
    bool any = false;
    for_each_node_of(flow.grid, tile, [&](Index k, Index i, Index j) {
        const double given = std::exchange(demand_[k], 0.0);
        if (!(given > 0.0)) return;
        const double rises = given * per_area_of_flow_;
        energy -= flow.share(i, j) * flow.gravity * given * (flow.bed.z[k] + 0.5 * rises);
        fresh_[k] += given;
        flow.bed.z[k] += rises;
        flow.bed.ground[k] += rises;
        if (bent_path_) pending_[k] += rises;
        any = true;
    });
    tile_energy_[tile] = energy;
    if (!any) return;
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

/// How long each tile has been at rest; below 0, it was not.
void Erosion::serialize_rest(Archive& archive, const Flow& flow) {
    std::vector<double> rested;
    const std::vector<Index>& tiles = flow.active.tile;
    if (!archive.loading())
        for (const Index tile : tiles) rested.push_back(rest_time_ && seen_[tile] == last_step_ ? rested_[tile] : -1.0);
    archive.array("rested", rested);
    archive.number("rested_at", last_step_);
    const auto deposited = deposited_.parts();
    archive.numbers("deposited", {deposited[0], deposited[1]});
    if (!archive.loading()) return;
    if (rested.size() != tiles.size()) throw misfit("its tiles are not those at rest");
    for (Index tile = 0; tile < flow.grid.tiles(); ++tile) seen_[tile] = -1;
    for (std::size_t n = 0; n < tiles.size(); ++n)
        if (rested[n] >= 0.0) rested_[tiles[n]] = rested[n], seen_[tiles[n]] = last_step_;
}

}  // namespace frana
