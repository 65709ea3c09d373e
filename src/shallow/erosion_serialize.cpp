// An erodible bed is put aside and taken up again: the ledger everywhere, heights where they have changed.
#include "mpm/stored_points.h"
#include "shallow/erosion.h"

namespace frana {

/// All that have changed; aside those that a step may change.
std::vector<Index> Erosion::tiles_to_keep(const Flow& flow, bool aside, const std::vector<Index>& reached) const {
    const TileGrid& grid = flow.grid;
    std::vector<std::uint8_t> kept(static_cast<std::size_t>(grid.tiles()), 0);
    const Index reach = static_cast<Index>(filter_.size()), far = 2 + (reach + 2) / kTile, width = grid.tiles_x();
    const auto add = [&](Index tile) {
        for (Index dj = -far; dj <= far; ++dj)
            for (Index di = -far; di <= far; ++di) {
                const Index to = tile + dj * width + di, column = tile % width + di;
                if (column >= 0 && column < width && to >= 0 && to < grid.tiles())
                    kept[static_cast<std::size_t>(to)] = 1;
            }
    };
    if (aside)
        for (const Index tile : reached) add(tile);
    if (aside && bent_path_)
        for (const Index tile : ledger_tiles_)
            if (tile_pending_[tile] > 0.0) add(tile);
    std::vector<Index> tiles;
    for (Index tile = 0; tile < grid.tiles(); ++tile)
        if (aside ? kept[static_cast<std::size_t>(tile)] != 0 : changed_[tile] != 0) tiles.push_back(tile);
    return tiles;
}

void Erosion::serialize(Archive& archive, Flow& flow, const std::vector<Index>& reached) {
    const Archive::Part part(archive, "bed");
    std::vector<Index> tiles;
    if (!archive.loading()) tiles = tiles_to_keep(flow, archive.aside(), reached);
    archive.array("tile", tiles);
    for (const Index tile : tiles)
        if (tile < 0 || tile >= flow.grid.tiles()) throw misfit("its erodible bed lies outside the grid");
    const auto numbers = [&](const char* name, LazyArray<double>& field, const auto& differs) {
        if (!field) return;
        std::vector<double> values;
        const std::size_t expected = tiles.size() * static_cast<std::size_t>(kTile * kTile);
        if (!archive.loading()) {
            values.reserve(expected);
            for (const Index tile : tiles)
                for_each_node_of(flow.grid, tile, [&](Index k, Index, Index) { values.push_back(field[k]); });
        }
        archive.array(name, values);
        if (!archive.loading()) return;
        if (values.size() != expected) throw misfit("its erodible bed is not that of the tiles");
        const double* from = values.data();
        for (std::size_t n = 0; n < tiles.size(); ++n)
            for_each_node_of(flow.grid, tiles[n], [&](Index k, Index i, Index j) {
                if (field[k] != *from) differs(n, i, j);
                field[k] = *from++;
            });
    };
    const auto as_it_was = [](std::size_t, Index, Index) {};
    std::vector<std::uint8_t> bent(tiles.size(), 0);  // its smoothed bed is not what it was
    numbers("left", left_, as_it_was);
    numbers("fresh", fresh_, as_it_was);
    numbers("cut", cut_, as_it_was);
    numbers("buried", buried_, as_it_was);
    if (evolves_) {
        numbers("z", flow.bed.z,
                [&](std::size_t n, Index i, Index j) { moved_[tiles[n]].add(one_node(flow.grid, tiles[n], i, j)); });
        numbers("ground", flow.bed.ground, as_it_was);
        numbers("pending", pending_, as_it_was);
        numbers("smoothed", flow.bed.smoothed, [&](std::size_t n, Index, Index) { bent[n] = 1; });
    }
    const auto eroded = eroded_.parts(), energy = energy_.parts();
    archive.numbers("sums", {eroded[0], eroded[1], energy[0], energy[1]});
    archive.numbers("exchange", {&waited_, &ahead_, &share_rate_});
    if (deposits_) serialize_deposition(archive, flow);
    if (!archive.loading()) return;
    for (const Index tile : tiles) {
        if (deposits_ || cut_) list_ledger(tile);
        changed_[tile] = 1;
        count_tile(flow, tile);
        if (bent_path_) tile_pending_[tile] = most_pending(flow, tile);
    }
    status_changed();
    if (evolves_) refresh_taken_up(flow, tiles, bent);
}

}  // namespace frana
