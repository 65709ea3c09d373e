#include "solver/columns.h"

#include <omp.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <variant>

#include "base/error.h"

namespace frana {
namespace {

/// All arrays of the points, to be shared out among threads.
struct Fields {
    explicit Fields(Columns& columns) {
        columns.each([&](auto& column) { list[static_cast<std::size_t>(count++)] = &column; });
        list[static_cast<std::size_t>(count++)] = &columns.id;
    }
    auto at(Index f) const { return list[static_cast<std::size_t>(f)]; }
    std::array<std::variant<Column*, ColumnOf<float>*, std::vector<std::int64_t>*>, 15> list;
    Index count = 0;
};

/// field[p] becomes field[order[p]], p < kept; `scratch` is room for it.
template <class Field>
void permute_field(Field& field, const std::int32_t* order, Index kept, Column& scratch) {
    using Number = typename Field::value_type;
    static_assert(sizeof(Number) <= sizeof(double), "the scratch is too narrow");
    resize_sparingly(scratch, static_cast<std::size_t>(kept));  // after a change of places it may be longer
    const Number* from = field.data();
    if constexpr (std::is_same_v<Field, Column>) {
        for (Index p = 0; p < kept; ++p) scratch[p] = from[order[p]];
        field.swap(scratch);
    } else {
        char* const room = reinterpret_cast<char*>(scratch.data());
        constexpr std::size_t size = sizeof(Number);
        for (Index p = 0; p < kept; ++p) std::memcpy(room + static_cast<std::size_t>(p) * size, from + order[p], size);
        field.resize(static_cast<std::size_t>(kept));
        if (kept > 0) std::memcpy(field.data(), room, static_cast<std::size_t>(kept) * size);
    }
}

}  // namespace

void TileSorter::plan(const Columns& columns, const TileGrid& grid, const std::vector<std::uint8_t>& gone,
                      ActiveTiles& active) {
    const Index count = columns.count();
    expect(count < std::numeric_limits<std::int32_t>::max() && grid.tiles() < std::numeric_limits<std::int32_t>::max(),
           "too many points for their numbers");
    resize_sparingly(key_, static_cast<std::size_t>(count));
    tile_count_.resize(static_cast<std::size_t>(grid.tiles()));
    std::int32_t* key = key_.data();
#pragma omp parallel for schedule(static) if (count > 4096)
    for (Index p = 0; p < count; ++p)
        key[p] = !gone.empty() && gone[static_cast<std::size_t>(p)]
                     ? -1
                     : static_cast<std::int32_t>(grid.tile_of(columns.x[p], columns.y[p]));

    used_.clear();
    for (Index p = 0; p < count; ++p)
        if (key[p] >= 0 && tile_count_[key[p]]++ == 0) used_.push_back(key[p]);
    wake(count, active);
    std::sort(used_.begin(), used_.end());

    active.tile.assign(used_.begin(), used_.end());
    active.begin.clear();
    Index kept = 0;
    for (const Index tile : used_) {
        active.begin.push_back(kept);
        kept += tile_count_[tile];
        tile_count_[tile] = active.begin.back();
    }
    active.begin.push_back(kept);

    resize_sparingly(order_, static_cast<std::size_t>(kept));
    for (Index p = 0; p < count; ++p)
        if (key[p] >= 0) order_[tile_count_[key[p]]++] = static_cast<std::int32_t>(p);
    for (const Index tile : used_) tile_count_[tile] = 0;
    list_tiles(grid, active);
}

/// Each thread permutes one field at a time: scattering all fields in one loop keeps too many streams open.
void TileSorter::carry_out(Columns& columns) {
    const Index kept = static_cast<Index>(order_.size());
    const Fields fields(columns);
    scratch_.resize(std::max(scratch_.size(), static_cast<std::size_t>(omp_get_max_threads())));
    // Here, not when a thread first takes a field: which does is chance.
    for (Column& scratch : scratch_) resize_sparingly(scratch, static_cast<std::size_t>(kept));
#pragma omp parallel for schedule(dynamic, 1) if (kept > 4096)
    for (Index f = 0; f < fields.count; ++f)
        std::visit([&](auto* field) { permute_field(*field, order_.data(), kept, scratch_[omp_get_thread_num()]); },
                   fields.at(f));
}

/// Tiles that points leave or enter do not sleep.
void TileSorter::wake(Index count, ActiveTiles& active) {
    if (active.quiet.empty()) return;
    Index p = 0;
    for (Index n = 0; n < active.count(); ++n)
        for (; p < active.begin[n + 1]; ++p)
            if (key_[p] != active.tile[n]) {
                active.quiet[active.tile[n]] = 0;
                if (key_[p] >= 0) active.quiet[key_[p]] = 0;
            }
    for (; p < count; ++p)
        if (key_[p] >= 0) active.quiet[key_[p]] = 0;
}

template <class At>
void TileSorter::keep(const std::vector<std::uint8_t>& gone, ActiveTiles& active, At&& at) {
    Index kept = 0;
    for (Index n = 0, place = 0; n < active.count(); ++n) {
        const Index end = active.begin[n + 1];
        active.begin[n] = kept;
        for (; place < end; ++place) {
            const std::int32_t p = at(place);
            if (!gone[static_cast<std::size_t>(p)]) order_[static_cast<std::size_t>(kept++)] = p;
        }
    }
    active.begin[active.count()] = kept;
    order_.resize(static_cast<std::size_t>(kept));
}

void TileSorter::leave_out(const std::vector<std::uint8_t>& gone, ActiveTiles& active) {
    keep(gone, active, [&](Index place) { return order_[static_cast<std::size_t>(place)]; });
}

void TileSorter::drop(Columns& columns, const std::vector<std::uint8_t>& gone, ActiveTiles& active) {
    resize_sparingly(order_, static_cast<std::size_t>(columns.count()));
    keep(gone, active, [](Index place) { return static_cast<std::int32_t>(place); });
    const Index kept = static_cast<Index>(order_.size());
    const std::int32_t* order = order_.data();
    const Fields fields(columns);
#pragma omp parallel for schedule(dynamic, 1) if (kept > 4096)
    for (Index f = 0; f < fields.count; ++f)
        std::visit(
            [&](auto* field) {
                auto* of = field->data();
                for (Index p = 0; p < kept; ++p) of[p] = of[order[p]];  // in place: order[p] >= p
            },
            fields.at(f));
    columns.resize(kept);
}

void TileSorter::list_tiles(const TileGrid& grid, ActiveTiles& active) {
    for (auto& positions : active.colour) {
        positions.clear();
        positions.reserve(active.tile.capacity());  // grows with the list of tiles, not some steps later
    }
    active.in_work.resize(static_cast<std::size_t>(grid.tiles()));
    active.quiet.resize(static_cast<std::size_t>(grid.tiles()));
    for (const Index tile : active.work) active.in_work[tile] = 0;
    active.work.clear();
    const Index width = grid.tiles_x();
    for (Index n = 0; n < active.count(); ++n) {
        const Index tile = active.tile[n], column = tile % width, row = tile / width;
        active.colour[(row % 2) * 2 + column % 2].push_back(n);
        for (Index dr = -1; dr <= 1; ++dr)
            for (Index dc = -1; dc <= 1; ++dc) {
                if (column + dc < 0 || column + dc >= width) continue;
                const Index neighbour = tile + dr * width + dc;
                if (neighbour < 0 || neighbour >= grid.tiles()) continue;
                if (!active.in_work[neighbour]) {
                    active.in_work[neighbour] = 1;
                    active.work.push_back(neighbour);
                }
            }
    }
    std::sort(active.work.begin(), active.work.end());
    list_runs(width, active);
}

/// Tiles of a run lie in one row of tiles.
void TileSorter::list_runs(Index width, ActiveTiles& active) {
    active.run.clear();
    active.run.reserve(active.work.capacity() + 1);
    const Index count = static_cast<Index>(active.work.size());
    for (Index n = 0; n < count; ++n) {
        const Index tile = active.work[n];
        const bool goes_on = n > 0 && tile == active.work[n - 1] + 1 && tile % width != 0;
        if (!goes_on || n - active.run.back() == kRunTiles) active.run.push_back(n);
    }
    active.run.push_back(count);
}

}  // namespace frana
