#include "shallow/merge.h"

#include <omp.h>

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

#include "mpm/domain.h"

namespace frana {
namespace {

constexpr Index kSide = 2 * kTile;  ///< half-cell squares along a tile's edge
/// Squares hold few points; a crowd of more than this is compared quarter by quarter, each for itself.
constexpr Index kMostCompared = 64;
/// Quarters of quarters so deep at most; what is crowded still is compared in part.
constexpr int kDeepest = 10;
/// A point so near to a square's edge [half cells] is in no square. Round-off must not choose one, or mirror particles
/// part.
constexpr double kEdge = 1e-6;
/// Unions whose costs differ by less than this share tie, for the same reason.
constexpr double kTie = 1e-6;
/// A union is at most so many times as heavy as a square's mean point. 2, and what round-off may add.
constexpr double kHeaviest = 2.0 + 1e-6;
/// A union shorter than this share of the splitting length will not split at once.
constexpr double kNoResplit = 0.95;

/// Whether a coordinate [half cells] lies so near to an edge that round-off would choose its side.
bool near_edge(double u, double edge) { return std::abs(u - edge) < kEdge; }

/// Lower corner and edge of a square [half cells]; how many times a half-cell square was quartered for it.
struct Square {
    double u, v, edge;
    int depth;
    double middle_u() const { return u + 0.5 * edge; }
    double middle_v() const { return v + 0.5 * edge; }
    Square quarter(int q) const { return {q & 1 ? middle_u() : u, q & 2 ? middle_v() : v, 0.5 * edge, depth + 1}; }
    /// The quarter that (x, y) [cells] lies in, or none (4) between two.
    int quarter_of(double x, double y) const {
        if (near_edge(2.0 * x, middle_u()) || near_edge(2.0 * y, middle_v())) return 4;
        return (2.0 * x > middle_u() ? 1 : 0) + (2.0 * y > middle_v() ? 2 : 0);
    }
};

/// The points of one tile in the order of its half-cell squares.
class Squares {
public:
    /// `sorted`: the point at each place; `order` and `square` have room for the tile's points.
    Squares(const Flow& flow, Index n, const std::int32_t* sorted, std::int32_t* order, std::int16_t* square)
        : i0_(2 * flow.grid.tile_i(flow.active.tile[n]) + 1),
          j0_(2 * flow.grid.tile_j(flow.active.tile[n]) + 1),
          c_(flow.particles),
          order_(order) {
        const Index begin = flow.active.begin[n], end = flow.active.begin[n + 1];
        Index held = 0;
        for (Index place = begin; place < end; ++place) {
            const std::int16_t s = square[place - begin] = square_of(sorted[place]);
            if (s != kNone) ++end_of_[s], ++held;
        }
        for (Index s = 1; s < kSide * kSide; ++s) end_of_[s] += end_of_[s - 1];
        for (Index place = end; place-- > begin;) {
            const std::int16_t s = square[place - begin];
            if (s != kNone) order[--end_of_[s]] = sorted[place];
        }
        for (Index s = 0; s + 1 < kSide * kSide; ++s) end_of_[s] = end_of_[s + 1];
        end_of_[kSide * kSide - 1] = held;
    }
    std::int32_t* points(Index s) const { return order_ + (s == 0 ? 0 : end_of_[s - 1]); }
    Index held(Index s) const { return end_of_[s] - (s == 0 ? 0 : end_of_[s - 1]); }
    Square at(Index s) const {
        const Index i = i0_ + s % kSide, j = j0_ + s / kSide;
        return {static_cast<double>(i), static_cast<double>(j), 1.0, 0};
    }

private:
    static constexpr std::int16_t kNone = -1;  ///< on an edge
    /// A point that the rounding of 2 x puts outside belongs to the nearest square.
    std::int16_t square_of(Index p) const {
        const double u = 2.0 * c_.x[p], v = 2.0 * c_.y[p], left = std::floor(u), below = std::floor(v);
        if (near_edge(u, left) || near_edge(u, left + 1.0) || near_edge(v, below) || near_edge(v, below + 1.0))
            return kNone;
        const Index i = static_cast<Index>(left) - i0_, j = static_cast<Index>(below) - j0_;
        return static_cast<std::int16_t>(std::clamp<Index>(j, 0, kSide - 1) * kSide +
                                         std::clamp<Index>(i, 0, kSide - 1));
    }
    Index i0_, j0_;
    const Particles& c_;
    std::int32_t* order_;
    Index end_of_[kSide * kSide] = {};
};

/// Growth of the second moments by a union [kg cells^2].
double cost_of(const Particles& c, Index a, Index b) {
    const double dx = c.x[a] - c.x[b], dy = c.y[a] - c.y[b];
    return c.mass[a] * c.mass[b] / (c.mass[a] + c.mass[b]) * (dx * dx + dy * dy);
}

struct Pick {
    Index a = -1, b = -1;
};

/// The cheapest union among `count` points, nothing when two tie. None is heavier than two points of their mean. Light
/// neighbours are cheap. Without that limit the heaviest takes in one after the other, and goes on as a lump.
Pick cheapest(const Particles& c, const std::int32_t* points, Index count) {
    double heaviest = 0.0;
    for (Index m = 0; m < count; ++m) heaviest += c.mass[points[m]];
    heaviest *= kHeaviest / static_cast<double>(count);
    Pick pick;
    double best = 0.0, second = 0.0;
    for (Index m = 0; m < count; ++m)
        for (Index n = m + 1; n < count; ++n) {
            if (c.mass[points[m]] + c.mass[points[n]] > heaviest) continue;
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

/// Calls body(points, count) for a square. Of a crowded one it takes those parts that hold more than their share of
/// `most` points. Sums what it returns. Parts are places: were a crowd cut off in the order it is stored in, mirror
/// particles would part.
template <class Body>
Index in_parts(const Particles& c, const Square& square, std::int32_t* points, Index count, Index most, Body&& body) {
    if (count <= kMostCompared || square.depth == kDeepest) return body(points, count);
    std::int32_t *from = points, *const end = points + count;
    Index sum = 0;
    for (int q = 0; q < 4; ++q) {
        std::int32_t* const next =
            std::partition(from, end, [&](std::int32_t p) { return square.quarter_of(c.x[p], c.y[p]) == q; });
        if (next - from > std::max<Index>(1, most / 4))
            sum += in_parts(c, square.quarter(q), from, next - from, most / 4, body);
        from = next;
    }
    return sum;
}

}  // namespace

Merger::Merger(const Flow& flow) {
    make_room(flow.active);
    std::vector<std::int32_t> sorted(
        static_cast<std::size_t>(flow.particles.count()));  // points lie as they are sorted
    std::iota(sorted.begin(), sorted.end(), 0);
    for (Index n = 0; n < flow.active.count(); ++n) {
        const Squares squares(flow, n, sorted.data(), order_.data(), square_.data());
        for (Index s = 0; s < kSide * kSide; ++s) most_ = std::max(most_, squares.held(s));
    }
}

Index Merger::most_of(const Seeds& seeds, const GridGeometry& grid) {
    std::map<std::pair<Index, Index>, Index> held;
    Index most = 0;
    for (std::size_t p = 0; p < seeds.x.size(); ++p) {
        const double u = 2.0 * ((seeds.x[p] - grid.x0) / grid.cell), v = 2.0 * ((seeds.y[p] - grid.y0) / grid.cell);
        const double left = std::floor(u), below = std::floor(v);
        if (near_edge(u, left) || near_edge(u, left + 1.0) || near_edge(v, below) || near_edge(v, below + 1.0))
            continue;
        most = std::max(most, ++held[{static_cast<Index>(left), static_cast<Index>(below)}]);
    }
    return most;
}

void Merger::make_room(const ActiveTiles& active) {
    largest_ = 0;
    for (Index n = 0; n < active.count(); ++n) largest_ = std::max(largest_, active.begin[n + 1] - active.begin[n]);
    resize_sparingly(order_, static_cast<std::size_t>(largest_ * omp_get_max_threads()));
    resize_sparingly(square_, order_.size());
}

Index Merger::merge(Flow& flow, const std::vector<std::int32_t>& sorted, std::vector<std::uint8_t>& gone) {
    assign_sparingly(gone, static_cast<std::size_t>(flow.particles.count()), std::uint8_t{0});
    if (notes_) resize_sparingly(into_, gone.size());
    make_room(flow.active);
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
    const Index own = largest_ * omp_get_thread_num();
    const Squares squares(flow, n, sorted, order_.data() + own, square_.data() + own);
    const double longest = kNoResplit * flow.scheme.split_length;
    const auto unite_cheapest = [&](const std::int32_t* points, Index count) -> Index {
        const Pick pick = cheapest(flow.particles, points, std::min(count, kMostCompared));
        if (pick.a < 0) return 0;
        return flow.particles.with_real(
            [&](auto real) { return unite<decltype(real)>(flow, pick.a, pick.b, longest, gone); });
    };
    Index merged = 0;
    for (Index s = 0; s < kSide * kSide; ++s)
        if (squares.held(s) > most_)
            merged +=
                in_parts(flow.particles, squares.at(s), squares.points(s), squares.held(s), most_, unite_cheapest);
    return merged;
}

/// Point b goes into point a.
template <class Real>
bool Merger::unite(Flow& flow, Index a, Index b, double longest, std::vector<std::uint8_t>& gone) {
    Particles& c = flow.particles;
    Carried<Real>& held = c.carried<Real>();
    if (c.mass[b] > c.mass[a]) std::swap(a, b);  // the id is that of the heavier one
    const double mass = c.mass[a] + c.mass[b], fa = c.mass[a] / mass, fb = c.mass[b] / mass;
    const double dx = c.x[b] - c.x[a], dy = c.y[b] - c.y[a];
    Moments moments;
    moments.add(fa, Moments::of(edges_of(held, a)), fb * dx, fb * dy);
    moments.add(fb, Moments::of(edges_of(held, b)), fa * dx, fa * dy);
    const Edges edges = rectangle_of(moments);
    if (edges.length1_2() >= longest * longest) return false;
    for (auto* array : {&c.x, &c.y}) (*array)[a] = fa * (*array)[a] + fb * (*array)[b];
    for (auto* array : {&held.vx, &held.vy, &held.cxx, &held.cxy, &held.cyx, &held.cyy, &held.depth})
        (*array)[a] = static_cast<Real>(fa * (*array)[a] + fb * (*array)[b]);
    c.mass[a] = mass;
    set_edges(held, a, edges);
    gone[static_cast<std::size_t>(b)] = 1;
    if (notes_) into_[static_cast<std::size_t>(b)] = static_cast<std::int32_t>(a);
    return true;
}

}  // namespace frana
