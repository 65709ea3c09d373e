#include "compare/union_area.h"

#include <algorithm>

#include "base/compensated_sum.h"

namespace frana {
namespace {

/// From its lower end to its upper one.
struct Edge {
    Vec2 low, high;
    int turn;  ///< +1 where the inside begins to the east of it, -1 where it ends

    double x_at(double y) const { return low.x() + (y - low.y()) / (high.y() - low.y()) * (high.x() - low.x()); }
};

/// The lowest first. Level ones bound nothing. Counted from a corner, so that large map coordinates cost no digits.
std::vector<Edge> edges_of(const Rings& rings) {
    std::vector<Edge> edges;
    for (const auto& ring : rings)
        for (std::size_t k = 0; k < ring.size(); ++k) {
            const Vec2 origin = rings.front().front(), a = ring[k] - origin, b = ring[(k + 1) % ring.size()] - origin;
            if (a.y() > b.y()) edges.push_back({b, a, 1});
            if (a.y() < b.y()) edges.push_back({a, b, -1});
        }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) { return a.low.y() < b.low.y(); });
    return edges;
}

/// Where two edges change places, if they do so between the ends of both.
void add_crossing(const Edge& a, const Edge& b, std::vector<double>& heights) {
    const double from = std::max(a.low.y(), b.low.y()), to = std::min(a.high.y(), b.high.y());
    if (!(from < to)) return;
    const double before = a.x_at(from) - b.x_at(from), after = a.x_at(to) - b.x_at(to);
    if (before * after < 0.0) heights.push_back(from + before / (before - after) * (to - from));
}

/// Of all ends and crossings: between two of them no edges meet.
std::vector<double> heights_of(const std::vector<Edge>& edges) {
    std::vector<double> heights;
    std::vector<const Edge*> open;
    for (const Edge& edge : edges) {
        open.erase(std::remove_if(open.begin(), open.end(),
                                  [&](const Edge* other) { return other->high.y() <= edge.low.y(); }),
                   open.end());
        for (const Edge* other : open) add_crossing(edge, *other, heights);
        open.push_back(&edge);
        heights.push_back(edge.low.y()), heights.push_back(edge.high.y());
    }
    std::sort(heights.begin(), heights.end());
    heights.erase(std::unique(heights.begin(), heights.end()), heights.end());
    return heights;
}

/// Length of what is within, from west to east [m].
double width_at(double y, const std::vector<const Edge*>& open) {
    std::vector<std::pair<double, int>> crossings;
    for (const Edge* edge : open) crossings.emplace_back(edge->x_at(y), edge->turn);
    std::sort(crossings.begin(), crossings.end());
    double width = 0.0;
    int times = 0;
    for (std::size_t k = 0; k + 1 < crossings.size(); ++k) {
        times += crossings[k].second;
        if (times > 0) width += crossings[k + 1].first - crossings[k].first;
    }
    return width;
}

}  // namespace

double union_area(const Rings& rings) {
    const std::vector<Edge> edges = edges_of(rings);
    const std::vector<double> heights = heights_of(edges);
    CompensatedSum area;
    std::vector<const Edge*> open;
    auto next = edges.begin();
    for (std::size_t k = 0; k + 1 < heights.size(); ++k) {
        open.erase(
            std::remove_if(open.begin(), open.end(), [&](const Edge* edge) { return edge->high.y() <= heights[k]; }),
            open.end());
        for (; next != edges.end() && next->low.y() <= heights[k]; ++next) open.push_back(&*next);
        const double middle = 0.5 * (heights[k] + heights[k + 1]);  // widths are linear in between
        area.add((heights[k + 1] - heights[k]) * width_at(middle, open));
    }
    return area.value();
}

}  // namespace frana
