#pragma once
// The order of points by tile, of any model: a stable counting sort, and the permutation of their arrays.
#include <variant>
#include <vector>

#include "base/staggered.h"
#include "mpm/point_set.h"
#include "mpm/tile_grid.h"

namespace frana {

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
        for_each_part([&](Part& part) {
            for (Index p = part.first; p < part.end; ++p) key[p] = static_cast<std::int32_t>(tile_of(p));
            tally(part);
        });
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
    template <class Points>
    void permute_points(Points& points) {
        permute(fields_of(points));
    }
    /// The same when order()[p] >= p for all p: in place.
    template <class Points>
    void close_gaps(Points& points) {
        close_gaps_of(fields_of(points));
        points.resize(static_cast<Index>(order_.size()));
    }

    /// Memory that grows with the points [bytes].
    Index bytes() const { return allocated(key_) + allocated(order_) + allocated(kept_) + allocated(scratch_); }

private:
    /// Points in a row that one thread counts and lays out.
    struct Part {
        Index first = 0, end = 0;
        LazyArray<std::int32_t> count;   ///< per tile of the domain, of its points; then where its next one goes
        std::vector<std::int32_t> used;  ///< tiles of which the count is not zero
    };
    template <class Body>
    void for_each_part(Body&& body) {
        const std::size_t parts = parts_in_use_;
#pragma omp parallel for schedule(static, 1) if (parts > 1)
        for (std::size_t n = 0; n < parts; ++n) body(parts_[n]);
    }
    template <class Points>
    const std::vector<PointField>& fields_of(Points& points) {
        fields_.clear();
        points.each([&](auto& array) { fields_.push_back(&array); });
        fields_.push_back(&points.id);
        return fields_;
    }
    void close_gaps_of(const std::vector<PointField>& fields) const;
    void make_room(Index count, Index tiles);
    void tally(Part& part) const;
    void lay_out(Part& part);
    template <class At>
    void retain(const std::vector<std::uint8_t>& gone, ActiveTiles& active, At&& at);
    template <class Stays, class At>
    void retain_serially(ActiveTiles& active, Stays&& stays, At&& at);

    std::vector<std::int32_t> key_, order_;  ///< tile of each point, -1 when it goes; points by tile
    std::vector<std::int32_t> kept_;         ///< order_ to come, when points are left out of it
    std::vector<Part> parts_;                ///< as many as there are threads
    std::size_t parts_in_use_ = 1;           ///< small lists have one
    std::vector<std::int32_t> used_;         ///< tiles with points
    std::vector<Index> first_;               ///< of the points that stay, by position in ActiveTiles
    std::vector<PointField> fields_;         ///< of the points that are sorted
    Array scratch_;                          ///< arrays are permuted one by one through it
};

}  // namespace frana
