#pragma once
// Distance from any point to a set of rings.
#include "particles/outline_area.h"

namespace frana {

/// The point on the segment from a to b that is nearest to p, as a fraction of the way from a.
double nearest_fraction(const Vec2& a, const Vec2& b, const Vec2& p);

/// The edges of rings, sorted into square buckets so that a search looks only where the nearest may be.
class NearestOnRings {
public:
    explicit NearestOnRings(const Rings& rings);  ///< at least one ring

    /// To the nearest point of any edge [m].
    double distance(const Vec2& p) const;

private:
    struct Piece {
        Vec2 a, b;
        Index bucket;
    };
    Index bucket_of(const Vec2& p, int axis) const;
    void search_node(Index i, Index j, const Vec2& p, double& best) const;

    Vec2 low_{0, 0};
    double size_ = 1.0;  ///< of a bucket; no piece is longer [m]
    Index nx_ = 1, ny_ = 1;
    std::vector<Piece> pieces_;       ///< by bucket
    std::vector<std::size_t> first_;  ///< of each bucket, and the end
};

}  // namespace frana
