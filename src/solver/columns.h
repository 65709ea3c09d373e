#pragma once
// The material points of the depth-averaged model: one array per quantity, sorted by tile.
#include <array>
#include <vector>

#include "grid/tile_grid.h"

namespace frana {

/// Memory that an array holds [bytes].
template <class T>
Index allocated(const std::vector<T>& array) { return static_cast<Index>(array.capacity() * sizeof(T)); }

/// Columns of material. Positions and domain edges are in cells (from node (0, 0)); all else is SI.
struct Columns {
    std::vector<double> x, y;                ///< position [cells]
    std::vector<double> vx, vy;              ///< velocity [m/s], half a step behind the position
    std::vector<double> cxx, cxy, cyx, cyy;  ///< velocity gradient, c_kl = dv_k / dx_l [1/s]
    std::vector<double> mass;                ///< [kg]
    std::vector<double> r1x, r1y, r2x, r2y;  ///< edges of the point's domain [cells]
    std::vector<double> depth;               ///< sampled from the nodes (paper preset: carried) [m]
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
        each([&](const std::vector<double>& column) { sum += allocated(column); });
        return sum;
    }
    void resize(Index count) {
        each([&](std::vector<double>& column) { column.resize(static_cast<std::size_t>(count)); });
        id.resize(static_cast<std::size_t>(count));
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
    /// Memory that grows with the points [bytes].
    Index bytes() const {
        Index sum = allocated(key_) + allocated(order_) + allocated(id_scratch_);
        for (const std::vector<double>& column : scratch_) sum += allocated(column);
        return sum;
    }

private:
    void list_tiles(const TileGrid& grid, ActiveTiles& active);

    std::vector<Index> key_, order_;
    std::vector<Index> tile_count_;   ///< per tile of the domain; only entries in `used_` are non-zero
    std::vector<Index> used_;
    std::vector<std::vector<double>> scratch_;  ///< one per field: they are permuted side by side
    std::vector<std::int64_t> id_scratch_;
};

}  // namespace frana
