#include "solver/merge.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "solver/domain.h"

namespace frana {
namespace {

constexpr Index kSide = 2 * kTile;  ///< half-cell squares along a tile's edge
/// Squares hold few points; of a crowd only so many are compared at a time.
constexpr Index kMostCompared = 64;
/// A point so near to a square's edge [half cells] is in no square: round-off must not choose one, or mirror images part.
constexpr double kEdge = 1e-6;
/// Unions whose costs differ by less than this share tie, for the same reason.
constexpr double kTie = 1e-6;
/// A union shorter than this share of the splitting length will not split at once.
constexpr double kNoResplit = 0.95;

/// The points of one tile in the order of its half-cell squares.
class Squares {
public:
    /// `sorted`: the point at each place; `order` has room for the tile's points.
    Squares(const Flow& flow, Index n, const std::int32_t* sorted, std::int32_t* order)
        : i0_(2 * flow.grid.tile_i(flow.active.tile[n]) + 1), j0_(2 * flow.grid.tile_j(flow.active.tile[n]) + 1),
          c_(flow.columns), order_(order) {
        const Index begin = flow.active.begin[n], end = flow.active.begin[n + 1];
        Index held = 0;
        for (Index place = begin; place < end; ++place) {
            const Index p = sorted[place];
            if (!on_edge(p)) ++end_of_[square(p)], ++held;
        }
        for (Index s = 1; s < kSide * kSide; ++s) end_of_[s] += end_of_[s - 1];
        for (Index place = end; place-- > begin;) {
            const std::int32_t p = sorted[place];
            if (!on_edge(p)) order[--end_of_[square(p)]] = p;
        }
        for (Index s = 0; s + 1 < kSide * kSide; ++s) end_of_[s] = end_of_[s + 1];
        end_of_[kSide * kSide - 1] = held;
    }
    const std::int32_t* points(Index s) const { return order_ + (s == 0 ? 0 : end_of_[s - 1]); }
    Index held(Index s) const { return end_of_[s] - (s == 0 ? 0 : end_of_[s - 1]); }

private:
    bool on_edge(Index p) const {
        const auto near = [](double u) { return std::abs(u - std::round(u)) < kEdge; };
        return near(2.0 * c_.x[p]) || near(2.0 * c_.y[p]);
    }
    /// A point that the rounding of 2 x puts outside belongs to the nearest square.
    Index square(Index p) const {
        const Index i = static_cast<Index>(std::floor(2.0 * c_.x[p])) - i0_;
        const Index j = static_cast<Index>(std::floor(2.0 * c_.y[p])) - j0_;
        return std::clamp<Index>(j, 0, kSide - 1) * kSide + std::clamp<Index>(i, 0, kSide - 1);
    }
    Index i0_, j0_;
    const Columns& c_;
    std::int32_t* order_;
    Index end_of_[kSide * kSide] = {};
};

/// Growth of the second moments by a union [kg cells^2].
double cost_of(const Columns& c, Index a, Index b) {
    const double dx = c.x[a] - c.x[b], dy = c.y[a] - c.y[b];
    return c.mass[a] * c.mass[b] / (c.mass[a] + c.mass[b]) * (dx * dx + dy * dy);
}

struct Pick { Index a = -1, b = -1; };

/// The cheapest union among `count` points, nothing when two tie.
Pick cheapest(const Columns& c, const std::int32_t* points, Index count) {
    Pick pick;
    double best = 0.0, second = 0.0;
    for (Index m = 0; m < count; ++m)
        for (Index n = m + 1; n < count; ++n) {
            const double cost = cost_of(c, points[m], points[n]);
            if (pick.a < 0 || cost < best) {
                second = pick.a < 0 ? std::numeric_limits<double>::infinity() : best;
                best = cost;
                pick = {points[m], points[n]};
            } else {
                second = std::min(second, cost);
            }
        }
    return second <= best * (1.0 + kTie) ? Pick{} : pick;
}

}  // namespace

Merger::Merger(const Flow& flow) {
    resize_sparingly(order_, static_cast<std::size_t>(flow.columns.count()));
    std::vector<std::int32_t> sorted(order_.size());  // points lie as they are sorted
    std::iota(sorted.begin(), sorted.end(), 0);
    for (Index n = 0; n < flow.active.count(); ++n) {
        const Squares squares(flow, n, sorted.data(), order_.data() + flow.active.begin[n]);
        for (Index s = 0; s < kSide * kSide; ++s) most_ = std::max(most_, squares.held(s));
    }
}

Index Merger::merge(Flow& flow, const std::vector<std::int32_t>& sorted, std::vector<std::uint8_t>& gone) {
    assign_sparingly(gone, static_cast<std::size_t>(flow.columns.count()), std::uint8_t{0});
    resize_sparingly(order_, static_cast<std::size_t>(flow.columns.count()));
    merged_.assign(static_cast<std::size_t>(flow.active.count()), 0);
    for_each_tile(flow.active, [&](Index n) {
        std::uint8_t& quiet = flow.active.quiet[flow.active.tile[n]];
        if (quiet >= kAsleep) return;
        merged_[n] = merge_tile(flow, n, sorted.data(), gone);
        if (merged_[n] > 0) quiet = 0;
    });
    Index total = 0;
    for (const Index count : merged_) total += count;
    return total;
}

Index Merger::merge_tile(Flow& flow, Index n, const std::int32_t* sorted, std::vector<std::uint8_t>& gone) {
    const Squares squares(flow, n, sorted, order_.data() + flow.active.begin[n]);
    const double longest = kNoResplit * flow.scheme.split_length;
    Index merged = 0;
    for (Index s = 0; s < kSide * kSide; ++s) {
        if (squares.held(s) <= most_) continue;
        const Pick pick = cheapest(flow.columns, squares.points(s), std::min(squares.held(s), kMostCompared));
        if (pick.a < 0) continue;
        merged += flow.columns.with_real(
            [&](auto real) { return unite<decltype(real)>(flow, pick.a, pick.b, longest, gone); });
    }
    return merged;
}

/// Point b goes into point a.
template <class Real>
bool Merger::unite(Flow& flow, Index a, Index b, double longest, std::vector<std::uint8_t>& gone) {
    Columns& c = flow.columns;
    Carried<Real>& held = c.carried<Real>();
    if (c.mass[b] > c.mass[a]) std::swap(a, b);  // the heavier one keeps its id
    const double mass = c.mass[a] + c.mass[b], fa = c.mass[a] / mass, fb = c.mass[b] / mass;
    const double dx = c.x[b] - c.x[a], dy = c.y[b] - c.y[a];
    Moments moments;
    moments.add(fa, Moments::of(edges_of(held, a)), fb * dx, fb * dy);
    moments.add(fb, Moments::of(edges_of(held, b)), fa * dx, fa * dy);
    const Edges edges = rectangle_of(moments);
    if (edges.length1_2() >= longest * longest) return false;
    for (auto* column : {&c.x, &c.y}) (*column)[a] = fa * (*column)[a] + fb * (*column)[b];
    for (auto* column : {&held.vx, &held.vy, &held.cxx, &held.cxy, &held.cyx, &held.cyy, &held.depth})
        (*column)[a] = static_cast<Real>(fa * (*column)[a] + fb * (*column)[b]);
    c.mass[a] = mass;
    set_edges(held, a, edges);
    gone[static_cast<std::size_t>(b)] = 1;
    return true;
}

}  // namespace frana
