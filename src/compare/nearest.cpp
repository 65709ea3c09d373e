#include "compare/nearest.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace frana {

double nearest_fraction(const Vec2& a, const Vec2& b, const Vec2& p) {
    const Vec2 along = b - a;
    const double square = along.squaredNorm();
    return square > 0.0 ? std::clamp((p - a).dot(along) / square, 0.0, 1.0) : 0.0;
}

NearestOnRings::NearestOnRings(const Rings& rings) {
    expect(!rings.empty(), "distances need an outline");
    Vec2 high = rings.front().front();
    low_ = high;
    for (const auto& ring : rings)
        for (const Vec2& v : ring) {
            low_ = low_.cwiseMin(v);
            high = high.cwiseMax(v);
        }
    constexpr double buckets = 128.0;  // along the longer side: a few pieces in each along the outline
    const Vec2 extent = high - low_;
    size_ = std::max(extent.maxCoeff() / buckets, 1e-9);
    nx_ = 1 + static_cast<Index>(extent.x() / size_);
    ny_ = 1 + static_cast<Index>(extent.y() / size_);
    for (const auto& ring : rings)
        for (std::size_t k = 0; k < ring.size(); ++k) {
            const Vec2& a = ring[k];
            const Vec2 edge = ring[(k + 1) % ring.size()] - a;
            const int parts = std::max(1, static_cast<int>(std::ceil(edge.norm() / size_)));
            for (int part = 0; part < parts; ++part) {
                const Vec2 from = a + static_cast<double>(part) / parts * edge;
                const Vec2 to = a + (part + 1.0) / parts * edge;
                const Vec2 middle = 0.5 * (from + to);
                pieces_.push_back({from, to, bucket_of(middle, 1) * nx_ + bucket_of(middle, 0)});
            }
        }
    std::sort(pieces_.begin(), pieces_.end(), [](const Piece& l, const Piece& r) { return l.bucket < r.bucket; });
    first_.assign(static_cast<std::size_t>(nx_ * ny_) + 1, 0);
    for (const Piece& piece : pieces_) ++first_[static_cast<std::size_t>(piece.bucket) + 1];
    for (std::size_t k = 1; k < first_.size(); ++k) first_[k] += first_[k - 1];
}

Index NearestOnRings::bucket_of(const Vec2& p, int axis) const {
    const Index count = axis == 0 ? nx_ : ny_;
    return std::clamp<Index>(static_cast<Index>(std::floor((p[axis] - low_[axis]) / size_)), 0, count - 1);
}

void NearestOnRings::search_node(Index i, Index j, const Vec2& p, double& best) const {
    if (i < 0 || j < 0 || i >= nx_ || j >= ny_) return;
    const auto bucket = static_cast<std::size_t>(j * nx_ + i);
    for (std::size_t k = first_[bucket]; k < first_[bucket + 1]; ++k) {
        const Piece& piece = pieces_[k];
        const Vec2 at = piece.a + nearest_fraction(piece.a, piece.b, p) * (piece.b - piece.a);
        best = std::min(best, (p - at).norm());
    }
}

double NearestOnRings::distance(const Vec2& p) const {
    const Index i = bucket_of(p, 0), j = bucket_of(p, 1);
    double best = INFINITY;
    // A piece reaches half a bucket beyond the one its middle is in. A point outside the buckets' box is further
    // from everything in it than the box's point nearest to it, whose bucket the search starts from.
    for (Index r = 0; r <= std::max(nx_, ny_) && best > (static_cast<double>(r) - 1.5) * size_; ++r)
        for (Index dj = -r; dj <= r; ++dj) {
            const bool whole_row = dj == -r || dj == r;
            for (Index di = -r; di <= r; di += whole_row || r == 0 ? 1 : 2 * r) search_node(i + di, j + dj, p, best);
        }
    return best;
}

}  // namespace frana
