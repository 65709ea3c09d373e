#pragma once
// The order of points by tile, of any model: a stable counting sort, and the permutation of their arrays.
#include <variant>
#include <vector>

#include "base/staggered.h"
#include "mpm/tile_grid.h"

namespace frana {

/// Memory that an array holds [bytes].
template <class Values>
Index allocated(const Values& array) {
    return static_cast<Index>(array.capacity() * sizeof(typename Values::value_type));
}

/// An array with one number for each point.
using PointField = std::variant<Array*, ArrayOf<float>*, std::vector<std::int64_t>*>;

/// Which point lies where once points are sorted by tile. Needs no memory once warmed up; same bits for any
/// number of threads.
class PointOrder {
public:
    /// Finds the tile of each of `count` points, below `tiles`; tile_of(p) < 0 drops the point.
    template <class TileOf>
    void find_tiles(Index count, Index tiles, TileOf&& tile_of) {
        make_room(count, tiles);
        std::int32_t* key = key_.data();
#pragma omp parallel for schedule(static) if (count > 4096)
        for (Index p = 0; p < count; ++p) key[p] = static_cast<std::int32_t>(tile_of(p));
        tally(count);
    }
    /// Tile of each point as it was found.
    const std::vector<std::int32_t>& key() const { return key_; }
    /// Fills tiles and ranges of `active`, and order().
    void lay_out(ActiveTiles& active);
    /// The point that will lie at each place.
    const std::vector<std::int32_t>& order() const { return order_; }
    /// Leaves points marked in `gone` out of an order that was laid out.
    void leave_out(const std::vector<std::uint8_t>& gone, ActiveTiles& active);
    /// The order of the points as they lie, without those marked in `gone`.
    void retain_places(Index count, const std::vector<std::uint8_t>& gone, ActiveTiles& active);

    /// Each field's number p becomes the one at order()[p].
    void permute(const std::vector<PointField>& fields);
    /// The same when order()[p] >= p for all p: in place, without changing the fields' lengths.
    void close_gaps(const std::vector<PointField>& fields) const;

    /// Memory that grows with the points [bytes].
    Index bytes() const {
        Index sum = allocated(key_) + allocated(order_);
        for (const Array& column : scratch_) sum += allocated(column);
        return sum;
    }

private:
    void make_room(Index count, Index tiles);
    void tally(Index count);
    template <class At>
    void retain(const std::vector<std::uint8_t>& gone, ActiveTiles& active, At&& at);

    std::vector<std::int32_t> key_, order_;  ///< tile of each point, -1 when it goes; points by tile
    std::vector<Index> tile_count_;          ///< per tile of the domain; only entries in `used_` are non-zero
    std::vector<Index> used_;
    std::vector<Array> scratch_;  ///< one per thread: columns are permuted one by one through it
};

}  // namespace frana
