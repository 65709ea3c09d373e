#include "solver/split.h"

#include <algorithm>

#include "solver/domain.h"

namespace frana {
namespace {

/// Long thin domains of points that may not split would throw their sub-points far ahead of the mass.
bool clamp_edge(double& x, double& y, double longest) {
    const double length = std::sqrt(x * x + y * y);
    if (length <= longest) return false;
    x *= longest / length;
    y *= longest / length;
    return true;
}

/// A strongly sheared domain, all edge and no area, gives way to the rectangle with the same second moments.
bool straighten(Columns& c, Index p) {
    const double l1 = c.r1x[p] * c.r1x[p] + c.r1y[p] * c.r1y[p], l2 = c.r2x[p] * c.r2x[p] + c.r2y[p] * c.r2y[p];
    const double area = c.r1x[p] * c.r2y[p] - c.r1y[p] * c.r2x[p];
    if (l1 * l2 <= 16.0 * area * area) return false;
    const Edges edges = rectangle_of(Moments::of(c.r1x[p], c.r1y[p], c.r2x[p], c.r2y[p]));
    c.r1x[p] = edges.r1x, c.r1y[p] = edges.r1y, c.r2x[p] = edges.r2x, c.r2y[p] = edges.r2y;
    return true;
}

/// How many points p becomes: 1, 2, or 4 where both edges are equally long. Then round-off must not choose one, or
/// mirror images part.
int parts_of(const Columns& c, Index p, double split_length, double least_mass) {
    const double l1 = c.r1x[p] * c.r1x[p] + c.r1y[p] * c.r1y[p], l2 = c.r2x[p] * c.r2x[p] + c.r2y[p] * c.r2y[p];
    const double area = std::abs(c.r1x[p] * c.r2y[p] - c.r1y[p] * c.r2x[p]);
    const bool splits = std::max(l1, l2) >= split_length * split_length && area >= 0.1 && c.mass[p] > least_mass;
    if (!splits) return 1;
    return std::abs(l1 - l2) <= 1e-9 * std::max(l1, l2) ? 4 : 2;
}

bool first_is_longer(const Columns& c, Index p) {
    return c.r1x[p] * c.r1x[p] + c.r1y[p] * c.r1y[p] >= c.r2x[p] * c.r2x[p] + c.r2y[p] * c.r2y[p];
}

/// Halves point p along one of its edges; the second half becomes point q.
void halve(Flow& flow, Index p, Index q, bool first) {
    Columns& c = flow.columns;
    double& rx = first ? c.r1x[p] : c.r2x[p];
    double& ry = first ? c.r1y[p] : c.r2y[p];
    const double dx = 0.25 * rx, dy = 0.25 * ry;
    rx *= 0.5;
    ry *= 0.5;
    c.mass[p] *= 0.5;
    c.each([&](Column& column) { column[q] = column[p]; });
    const double dvx = flow.cell * (c.cxx[p] * dx + c.cxy[p] * dy), dvy = flow.cell * (c.cyx[p] * dx + c.cyy[p] * dy);
    const double x_max = static_cast<double>(flow.grid.nx() - 1), y_max = static_cast<double>(flow.grid.ny() - 1);
    c.x[q] = std::clamp(c.x[p] - dx, 0.0, x_max);
    c.y[q] = std::clamp(c.y[p] - dy, 0.0, y_max);
    c.vx[q] -= dvx;
    c.vy[q] -= dvy;
    c.x[p] = std::clamp(c.x[p] + dx, 0.0, x_max);
    c.y[p] = std::clamp(c.y[p] + dy, 0.0, y_max);
    c.vx[p] += dvx;
    c.vy[p] += dvy;
}

}  // namespace

Index Splitter::split(Flow& flow) {
    Columns& c = flow.columns;
    const Index count = c.count();
    const double length = flow.scheme.split_length, longest = std::max(1.0, length);
    const bool may_split = flow.scheme.split;
    tile_first_.assign(static_cast<std::size_t>(flow.active.count()) + 1, 0);
    for_each_tile(flow.active, [&](Index n) {
        Index found = 0;
        bool changed = false;
        const Index tile = flow.active.tile[n];
        if (flow.active.quiet[tile] >= kAsleep) return;
        for (Index p = flow.active.begin[n]; p < flow.active.begin[n + 1]; ++p) {
            changed |= clamp_edge(c.r1x[p], c.r1y[p], longest);
            changed |= clamp_edge(c.r2x[p], c.r2y[p], longest);
            if (flow.scheme.reset_domains) changed |= straighten(c, p);
            if (may_split) found += parts_of(c, p, length, least_mass_) - 1;
        }
        tile_first_[n + 1] = found;
        if (changed || found > 0) flow.active.quiet[tile] = 0;
    });
    for (Index n = 0; n < flow.active.count(); ++n) tile_first_[n + 1] += tile_first_[n];
    const Index added = tile_first_.back();
    if (added == 0) return 0;
    c.resize(count + added);
    for_each_tile(flow.active, [&](Index n) {
        Index next = tile_first_[n];
        if (next == tile_first_[n + 1]) return;
        for (Index p = flow.active.begin[n]; p < flow.active.begin[n + 1]; ++p) {
            const int parts = parts_of(c, p, length, least_mass_);
            if (parts == 1) continue;
            const Index q = count + next;
            for (int part = 1; part < parts; ++part, ++next) c.id[count + next] = next_id_ + next;
            halve(flow, p, q, first_is_longer(c, p));
            if (parts == 2) continue;
            const bool other = first_is_longer(c, p);  // the edge that is still whole
            halve(flow, p, q + 1, other);
            halve(flow, q, q + 2, other);
        }
    });
    next_id_ += added;
    return added;
}

}  // namespace frana
