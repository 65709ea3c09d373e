// A run that goes on on a larger grid, because its material comes near the end of its own.
#include <algorithm>

#include "shallow/depth_averaged.h"

namespace frana {
namespace {

/// Where nothing ever was, peaks are zero.
void copy_peaks(const TileGrid& from_grid, const Peaks& from, const TileGrid& to_grid, Peaks& to, Index east,
                Index north) {
    for (Index j = -kTile; j < from_grid.ny() + kGhosts; ++j)
        for (Index i = -kTile; i < from_grid.nx() + kGhosts; ++i) {
            const Index k = from_grid.at(i, j);
            if (!(from.depth[k] > 0.0)) continue;
            const Index n = to_grid.at(i + east, j + north);
            to.depth[n] = from.depth[k], to.speed[n] = from.speed[k], to.pressure[n] = from.pressure[k];
            to.dynamic_pressure[n] = from.dynamic_pressure[k], to.arrival[n] = from.arrival[k];
        }
}

}  // namespace

NodeBox DepthAveraged::worked() const {
    const std::vector<Index>& work = flow_.active.work;
    if (work.empty()) return {};
    const TileGrid& grid = flow_.grid;
    Index west = grid.tile_i(work.front()), east = west;
    for (const Index tile : work) west = std::min(west, grid.tile_i(tile)), east = std::max(east, grid.tile_i(tile));
    const Index south = grid.tile_j(work.front()), north = grid.tile_j(work.back());  // ascending
    return {west, south, east - west + kTile, north - south + kTile};
}

void DepthAveraged::take_over(DepthAveraged& from, Index east, Index north) {
    Particles& c = flow_.particles;
    c = std::move(from.flow_.particles);
    for (Index p = 0; p < c.count(); ++p) c.x[p] += static_cast<double>(east), c.y[p] += static_cast<double>(north);
    flow_.departed = std::move(from.flow_.departed);
    for (std::vector<Departed>& list : flow_.departed)
        for (Departed& particle : list)
            particle.x += static_cast<double>(east), particle.y += static_cast<double>(north);
    copy_peaks(from.flow_.grid, from.peaks_, flow_.grid, peaks_, east, north);
    splitter_ = std::move(from.splitter_), merger_ = std::move(from.merger_), timed_ = std::move(from.timed_);
    births_wanted_ = from.births_wanted_, end_of_births_ = from.end_of_births_;
    store_ = std::move(from.store_);
    status_ = from.status_, fit_ = from.fit_, start_momentum_ = from.start_momentum_;
    if (feed_) feed_->take_over(*from.feed_), choose_sleep();
    if (late_) late_->take_over(*from.late_);
    if (passages_) passages_->take_over(*from.passages_);
    added_ = std::move(from.added_), mass_added_ = from.mass_added_;
    since_start_ = from.since_start_;
    signal_ = from.signal_, since_split_ = from.since_split_, stress_power_ = from.stress_power_;
    centre_ = from.centre_ + Vec2(static_cast<double>(east), static_cast<double>(north));
    if (erosion_) {
        if (late_) late_->for_each_entered([&](const LateRelease& release) { erosion_->cut(flow_, release.scar); });
        erosion_->take_over(*from.erosion_, from.flow_, flow_, east, north);
        status_.bed = erosion_->status();
    }
    sorter_.sort(c, flow_.grid, {}, flow_.active);
    drift_ = 0.0;
    arrive(timed_("deposit", [&] { return transfer_->deposit(flow_, 0.5 * (status_.dt + longest_step())); }));
}

}  // namespace frana
