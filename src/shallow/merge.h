#pragma once
#include "shallow/flow.h"

namespace frana {

/// Merges points that convergence has crowded together, so that splitting does not let their number grow for ever.
class Merger {
public:
    /// A half-cell square may hold as many points as it ever does at the start, and at least two, unmerged.
    explicit Merger(const Flow& flow);
    explicit Merger(Index most) : most_(most) {}
    Index most() const { return most_; }  ///< points that such a square may hold
    /// Of points at the places of seeds, how many such a square holds at most.
    static Index most_of(const Seeds& seeds, const GridGeometry& grid);
    /// In every half-cell square with more points than that, two become one. They are those whose union adds least to
    /// the second moments (m_a m_b / (m_a + m_b) |x_a - x_b|^2; Ward 1963). Mass, place, velocity and its gradient are
    /// the mass-weighted means. The domain is the rectangle with the union's second moments. Mass and momentum are
    /// conserved exactly. No union when its domain would be nearly long enough to split again. Where two unions tie,
    /// none is made: round-off must not choose, or mirror particles part. A crowd (more than 64 points) is thinned in
    /// each quarter of its square.
    /// Needs tiles that are up to date; `sorted`: the point at each place of them (TileSorter::order). Marks merged-away
    /// points in `gone` (resized); returns how many. The caller drops them.
    Index merge(Flow& flow, const std::vector<std::int32_t>& sorted, std::vector<std::uint8_t>& gone);
    /// From now on merge() tells where points went.
    void note_unions() { notes_ = true; }
    /// The point that each one marked in `gone` went into; others have no meaning.
    const std::vector<std::int32_t>& into() const { return into_; }
    /// Memory that grows with a tile's points [bytes].
    Index bytes() const { return allocated(order_) + allocated(square_); }

private:
    void make_room(const ActiveTiles& active);
    Index merge_tile(Flow& flow, Index n, const std::int32_t* sorted, std::vector<std::uint8_t>& gone);
    template <class Real>
    bool unite(Flow& flow, Index a, Index b, double longest, std::vector<std::uint8_t>& gone);

    Index most_ = 2;                    ///< points that a half-cell square may hold
    Index largest_ = 0;                 ///< points of the fullest tile: each thread has room for so many
    std::vector<std::int32_t> order_;   ///< a tile's points by square
    std::vector<std::int16_t> square_;  ///< of the point at each of the tile's places, as it was found
    std::vector<Index> merged_;         ///< per tile
    bool notes_ = false;
    std::vector<std::int32_t> into_;
};

}  // namespace frana
