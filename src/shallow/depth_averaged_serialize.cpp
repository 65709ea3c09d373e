// The state of a depth-averaged run between two steps, as it is serialized. It holds the points in their order, the
// tiles they are sorted by, the run's sums and the peaks. (Points have moved since the sort.) It also holds what the
// points have deposited on the nodes. A second deposit would add in another order where points have left in between.
// What else nodes have follows from the deposit.
#include <fmt/core.h>

#include <array>

#include "mpm/stored_nodes.h"
#include "shallow/depth_averaged.h"

namespace frana {
namespace {

constexpr const char* kArrayNames[] = {"x",   "y",   "mass", "vx",  "vy",  "cxx", "cxy",
                                       "cyx", "cyy", "r1x",  "r1y", "r2x", "r2y", "depth"};

}  // namespace

void DepthAveraged::serialize(Archive& archive) {
    aside_ = archive.aside() && !archive.loading();
    serialize_points(archive);
    serialize_sums(archive);
    serialize_nodes(archive);
    serialize_peaks(archive);
    if (erosion_) erosion_->serialize(archive, flow_, tiles_of_a_step());
    timed_.serialize(archive);
    if (feed_) feed_->serialize(archive), serialize_support(archive), choose_sleep();
    if (late_) late_->serialize(archive);
    if (passages_) archive.array("passed", passages_->passed());
    if (!archive.loading()) return;
    flow_.rest.some_asleep = false;  // what sleeps is found again; it changes no bit
    activate_all(flow_);
    raise_surface();
}

void DepthAveraged::serialize_points(Archive& archive) {
    frana::serialize_points(archive, flow_.particles, [](std::size_t n) { return kArrayNames[n]; });
    const Archive::Part part(archive, "points");
    serialize_tiles(archive, flow_.active);
    if (!archive.loading()) return;
    require_whole(flow_.active, flow_.grid.tiles(), flow_.particles.count());
    sorter_.list_tiles(flow_.grid, flow_.active);
    for (const Index tile : flow_.active.tile) flow_.active.quiet[tile] = 0;
}

void DepthAveraged::serialize_sums(Archive& archive) {
    frana::serialize(archive, "status", status_);
    since_start_.serialize(archive, "ledger");
    archive.numbers("sums", {&signal_, &since_split_, &drift_, &stress_power_, &mass_added_, &start_momentum_[0],
                             &start_momentum_[1], &centre_.x(), &centre_.y()});
    Index next_id = splitter_.next_id(), most = merger_ ? merger_->most() : 0, fitted = fit_ ? 1 : 0;
    archive.number("next_id", next_id);
    archive.number("most_in_a_square", most);
    archive.number("fitted", fitted);
    MassFit fit = fit_.value_or(MassFit{});
    archive.number("fit_rows", fit.rows);
    archive.number("fit_iterations", fit.iterations);
    archive.number("fit_largest_change", fit.largest_change);
    archive.number("fit_clipped", fit.clipped);
    archive.number("fit_level_error", fit.level_error);
    archive.number("fit_left_free", fit.left_free);
    archive.number("fit_volume_change", fit.volume_change);
    if (!archive.loading()) return;
    splitter_.set_next_id(next_id);
    if (flow_.scheme.merge && !flow_.scheme.paper_pressure) merger_.emplace(most);
    if (fitted) fit_ = fit;
}

void DepthAveraged::serialize_nodes(Archive& archive) {
    const Archive::Part part(archive, "nodes");
    Nodes& nodes = flow_.nodes;
    const std::vector<Index>& tiles = flow_.active.work;
    std::vector<std::uint64_t> in_reach;
    in_reach.reserve(tiles.size());
    for (const Index tile : tiles) in_reach.push_back(flow_.in_reach[tile]);
    archive.array("touched", in_reach);
    if (in_reach.size() != tiles.size()) throw misfit("its nodes are not those of the tiles");
    for (std::size_t n = 0; n < tiles.size(); ++n) flow_.in_reach[tiles[n]] = in_reach[n];
    const auto serialize = [&](const char* name, const auto& at) {
        frana::serialize_nodes(archive, name, flow_.grid, tiles, at);
    };
    serialize("mass", [&](Index k) { return std::array{&nodes.mass[k]}; });
    serialize("momentum", [&](Index k) { return std::array{&nodes.deposits()[k].px, &nodes.deposits()[k].py}; });
    serialize("column_mass", [&](Index k) { return std::array{&nodes.column_mass[k]}; });
    if (!nodes.forced) return;
    serialize("force", [&](Index k) { return std::array{&nodes.deposits()[k].fx, &nodes.deposits()[k].fy}; });
}

void DepthAveraged::serialize_support(Archive& archive) {
    const Archive::Part part(archive, "support");
    std::vector<Index> nodes;
    std::vector<double> own;
    for (const Supported& node : supported_) nodes.push_back(node.k), own.push_back(node.own);
    archive.array("node", nodes);
    archive.array("own", own);
    if (!archive.loading()) return;
    if (nodes.size() != own.size()) throw misfit("its arrays differ in length");
    supports_->clear();
    for (const Index k : nodes) {
        if (k < 0 || k >= flow_.grid.size()) throw misfit("its nodes are not those of the grid");
        supports_->add(k);
    }
    if (supports_->number() != nodes.size()) throw misfit("a node is there twice");
    supported_.resize(nodes.size());
    for (std::size_t n = 0; n < nodes.size(); ++n) supported_[*supports_->place(nodes[n])] = {nodes[n], own[n]};
}

/// Those whose nodes a step may change: of the work list, and where what is still to come may enter.
std::vector<Index> DepthAveraged::tiles_of_a_step() const {
    std::vector<Index> tiles = flow_.active.work;
    if (late_) late_->add_tiles_to_come(tiles);
    return tiles;
}

/// Where nothing ever was, peaks are zero and are not saved. Steps aside leave them as they are.
void DepthAveraged::serialize_peaks(Archive& archive) {
    if (archive.aside()) return;
    const Archive::Part part(archive, "peaks");
    std::vector<Index> tiles;
    for (Index tile = 0; !archive.loading() && tile < flow_.grid.tiles(); ++tile) {
        bool reached = false;
        for_each_node_of(flow_.grid, tile, [&](Index k, Index, Index) { reached |= peaks_.depth[k] > 0.0; });
        if (reached) tiles.push_back(tile);
    }
    archive.array("tile", tiles);
    for (const Index tile : tiles)
        if (tile < 0 || tile >= flow_.grid.tiles()) throw misfit("its peaks lie outside the grid");
    const auto serialize_peak = [&](const char* name, LazyArray<double>& peak) {
        frana::serialize_nodes(archive, name, flow_.grid, tiles, [&](Index k) { return std::array{&peak[k]}; });
    };
    serialize_peak("depth", peaks_.depth);
    serialize_peak("speed", peaks_.speed);
    serialize_peak("pressure", peaks_.pressure);
    serialize_peak("dynamic_pressure", peaks_.dynamic_pressure);
    serialize_peak("arrival", peaks_.arrival);
}

}  // namespace frana
