#include "structured/breakage.h"

#include <algorithm>
#include <numeric>

namespace frana {
namespace {

/// Calls visit(p, q) for all pairs of points nearer than `reach` [m]: points sorted by strips as wide as
/// that.
template <class Visit>
void each_pair(const StructuredFlow& flow, double reach, Visit&& visit) {
    const Index count = flow.body().points.count();
    struct Place {
        Index strip;
        double x, y;
        Index p;
    };
    std::vector<Place> places;
    for (Index p = 0; p < count; ++p) {
        const Vec2 at = flow.position(p);
        places.push_back({static_cast<Index>(std::floor(at.y() / reach)), at.x(), at.y(), p});
    }
    const auto before = [](const Place& a, const Place& b) {
        return a.strip != b.strip ? a.strip < b.strip : a.x < b.x;
    };
    std::sort(places.begin(), places.end(), before);
    for (std::size_t n = 0; n < places.size(); ++n)
        for (const Index strip : {places[n].strip, places[n].strip + 1}) {
            auto other = strip == places[n].strip ? places.begin() + static_cast<std::ptrdiff_t>(n) + 1
                                                  : std::lower_bound(places.begin(), places.end(),
                                                                     Place{strip, places[n].x - reach, 0, 0}, before);
            for (; other != places.end() && other->strip == strip && other->x < places[n].x + reach; ++other)
                if (std::hypot(other->x - places[n].x, other->y - places[n].y) < reach) visit(places[n].p, other->p);
        }
}

}  // namespace

Neighbours::Neighbours(const StructuredFlow& flow, double reach) {
    const StructuredPoints& q = flow.body().points;
    each_pair(flow, reach, [&](Index a, Index b) { pairs_.emplace_back(q.id[a], q.id[b]); });
    std::sort(pairs_.begin(), pairs_.end());
}

void Neighbours::serialize(Archive& archive) {
    std::vector<std::int64_t> ids;
    for (const auto& [first, second] : pairs_) ids.insert(ids.end(), {first, second});
    archive.array("neighbours", ids);
    if (!archive.loading()) return;
    pairs_.clear();
    for (std::size_t n = 0; n + 1 < ids.size(); n += 2) pairs_.emplace_back(ids[n], ids[n + 1]);
}

Neighbours::Torn Neighbours::torn(const StructuredFlow& flow, double distance) const {
    constexpr double kHalfFragmented = 0.5;
    const StructuredPoints& q = flow.body().points;
    std::int64_t most = -1;
    for (const std::int64_t id : q.id) most = std::max(most, id);
    std::vector<Index> where(static_cast<std::size_t>(most + 1), -1);
    for (Index p = 0; p < q.count(); ++p) where[static_cast<std::size_t>(q.id[p])] = p;
    Torn torn;
    for (const auto& [first, second] : pairs_) {
        if (first > most || second > most) continue;  // left the grid
        const Index a = where[static_cast<std::size_t>(first)], b = where[static_cast<std::size_t>(second)];
        if (a < 0 || b < 0 || (flow.position(a) - flow.position(b)).norm() <= distance) continue;
        ++torn.all;
        if (q.damage[a] < kHalfFragmented && q.damage[b] < kHalfFragmented) ++torn.numerical;
    }
    return torn;
}

std::vector<double> pieces(const StructuredFlow& flow, const PieceRule& rule) {
    const StructuredPoints& q = flow.body().points;
    std::vector<Index> head(static_cast<std::size_t>(q.count()));
    std::iota(head.begin(), head.end(), Index{0});
    const auto root = [&](Index p) {
        while (head[p] != p) p = head[p] = head[head[p]];
        return p;
    };
    const auto counts = [&](Index p) { return q.damage[p] < rule.damage; };
    each_pair(flow, rule.link, [&](Index a, Index b) {
        if (counts(a) && counts(b)) head[root(a)] = root(b);
    });
    std::vector<double> mass(head.size(), 0.0);
    double all = 0.0;
    for (Index p = 0; p < q.count(); ++p) {
        all += q.mass[p];
        if (counts(p)) mass[root(p)] += q.mass[p];
    }
    std::vector<double> shares;
    for (const double m : mass)
        if (m > rule.share * all) shares.push_back(m / all);
    std::sort(shares.rbegin(), shares.rend());
    return shares;
}

}  // namespace frana
