#pragma once
// The material points of the depth-averaged model: one array per quantity, sorted by tile.
#include <array>
#include <vector>

#include "base/staggered.h"
#include "grid/tile_grid.h"

namespace frana {

/// Memory that an array holds [bytes].
template <class Array>
Index allocated(const Array& array) {
    return static_cast<Index>(array.capacity() * sizeof(typename Array::value_type));
}

/// Columns of material. Positions and domain edges are in cells (from node (0, 0)); all else is SI.
struct Columns {
    Column x, y;                ///< position [cells]
    Column vx, vy;              ///< velocity [m/s], half a step behind the position
    Column cxx, cxy, cyx, cyy;  ///< velocity gradient, c_kl = dv_k / dx_l [1/s]
    Column mass;                ///< [kg]
    Column r1x, r1y, r2x, r2y;  ///< edges of the point's domain [cells]
    Column depth;               ///< sampled from the nodes (paper preset: carried) [m]
    std::vector<std::int64_t> id;            ///< constant through sorting; children of a split get new ones

    Index count() const { return static_cast<Index>(x.size()); }

    /// The one list of floating-point columns: sorting and growing walk it.
    template <class Visit>
    void each(Visit&& visit) {
        for (auto* column : all(*this)) visit(*column);
    }
    template <class Visit>
    void each(Visit&& visit) const {
        for (auto* column : all(*this)) visit(*column);
    }
    Index bytes() const {
        Index sum = allocated(id);
        each([&](const Column& column) { sum += allocated(column); });
        return sum;
    }
    void resize(Index count) {
        each([&](Column& column) { resize_sparingly(column, static_cast<std::size_t>(count)); });
        resize_sparingly(id, static_cast<std::size_t>(count));
    }

private:
    template <class Self>
    static auto all(Self& s) -> std::array<decltype(&s.x), 14> {
        return {&s.x, &s.y, &s.vx, &s.vy, &s.cxx, &s.cxy, &s.cyx, &s.cyy, &s.mass, &s.r1x, &s.r1y, &s.r2x, &s.r2y,
                &s.depth};
    }
};

/// Stable counting sort by tile; points whose `keep` says no are dropped. Needs no memory once warmed up.
class TileSorter {
public:
    /// Sorts `columns` and rebuilds `active`. Same bits for any number of threads.
    /// `gone` (one byte per particle, may be empty) marks particles to drop.
    void sort(Columns& columns, const TileGrid& grid, const std::vector<std::uint8_t>& gone, ActiveTiles& active);
    /// Drops the points marked in `gone`; the others keep their order and tiles.
    void drop(Columns& columns, const std::vector<std::uint8_t>& gone, ActiveTiles& active);
    /// Makes `active` whole from its tiles and their ranges.
    void list_tiles(const TileGrid& grid, ActiveTiles& active);
    /// Memory that grows with the points [bytes].
    Index bytes() const {
        Index sum = allocated(key_) + allocated(order_) + allocated(id_scratch_);
        for (const Column& column : scratch_) sum += allocated(column);
        return sum;
    }

private:
    void wake(Index count, ActiveTiles& active);

    std::vector<std::int32_t> key_, order_;  ///< tile of each point, -1 when it goes; points by tile
    std::vector<Index> tile_count_;   ///< per tile of the domain; only entries in `used_` are non-zero
    std::vector<Index> used_;
    std::vector<Column> scratch_;     ///< one per thread: columns are permuted one by one and change places with it
    std::vector<std::int64_t> id_scratch_;
};

}  // namespace frana
