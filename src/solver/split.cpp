#include "solver/split.h"

#include <algorithm>

#include "base/simd.h"
#include "solver/domain.h"

namespace frana {
namespace {

/// Long thin domains of points that may not split would throw their sub-points far ahead of the mass.
template <class Real>
bool clamp_edge(Real& x, Real& y, double longest) {
    const double length = std::sqrt(static_cast<double>(x) * x + static_cast<double>(y) * y);
    if (length <= longest) return false;
    x = static_cast<Real>(x * (longest / length));
    y = static_cast<Real>(y * (longest / length));
    return true;
}

/// Both edges. A point that splits may have edges twice as long as one that does not: drawn in before it is halved, a high
/// column that falls apart in a few steps would have its mass back in the middle, and energy that it had turned to motion.
template <class Real>
bool clamp_edges(Carried<Real>& held, Index p, double longest) {
    const bool first = clamp_edge(held.r1x[p], held.r1y[p], longest);
    return clamp_edge(held.r2x[p], held.r2y[p], longest) || first;
}

/// Squared lengths of a domain's edges over its squared area, from which on it is strongly sheared.
double most_sheared() { return 16.0; }

/// A strongly sheared domain, all edge and no area, gives way to the rectangle with the same second moments.
template <class Real>
bool straighten(Carried<Real>& held, Index p) {
    const Edges e = edges_of(held, p);
    const double area = e.area();
    if (e.length1_2() * e.length2_2() <= most_sheared() * area * area) return false;
    set_edges(held, p, rectangle_of(Moments::of(e)));
    return true;
}

/// Edges whose squared lengths differ by no more than this share are equally long: round-off.
template <class Real>
constexpr double kSame = std::is_same_v<Real, float> ? 1e-5 : 1e-9;

/// How many points p becomes: 1, 2, or 4 where both edges are equally long. Then round-off must not choose one, or
/// mirror images part.
template <class Real>
int parts_of(const Columns& c, Index p, double split_length, double least_mass) {
    const Edges e = edges_of(c.carried<Real>(), p);
    const double l1 = e.length1_2(), l2 = e.length2_2();
    // Edges are cut to the splitting length where that is a cell or more: it must not take more than round-off to reach it.
    const bool is_long = std::max(l1, l2) >= (1.0 - kSame<Real>) * split_length * split_length;
    if (!is_long || std::abs(e.area()) < 0.1 || c.mass[p] <= least_mass) return 1;
    return std::abs(l1 - l2) <= kSame<Real> * std::max(l1, l2) ? 4 : 2;
}

/// Whether four points in a row have short, sound domains, so that nothing below changes them: as most do.
template <class Real>
bool four_stay(const Carried<Real>& held, Index p, double split_length, bool straightens) {
    const Double4 r1x = load(&held.r1x[p], 4), r1y = load(&held.r1y[p], 4);
    const Double4 r2x = load(&held.r2x[p], 4), r2y = load(&held.r2y[p], 4);
    const Double4 l1 = r1x * r1x + r1y * r1y, l2 = r2x * r2x + r2y * r2y, area = r1x * r2y - r1y * r2x;
    Mask4 stay = max(l1, l2) < (1.0 - kSame<Real>) * split_length * split_length;
    if (straightens) stay &= l1 * l2 <= most_sheared() * area * area;
    return !any(~stay);
}

template <class Real>
bool first_is_longer(const Columns& c, Index p) {
    const Edges e = edges_of(c.carried<Real>(), p);
    return e.length1_2() >= e.length2_2();
}

/// Halves point p along one of its edges; the second half becomes point q.
template <class Real>
void halve(Flow& flow, Index p, Index q, bool first) {
    Columns& c = flow.columns;
    Carried<Real>& held = c.carried<Real>();
    Real& rx = first ? held.r1x[p] : held.r2x[p];
    Real& ry = first ? held.r1y[p] : held.r2y[p];
    const double dx = 0.25 * rx, dy = 0.25 * ry;
    rx *= Real{0.5};
    ry *= Real{0.5};
    c.mass[p] *= 0.5;
    c.each([&](auto& column) { column[q] = column[p]; });
    const Real dvx = static_cast<Real>(flow.cell * (held.cxx[p] * dx + held.cxy[p] * dy));
    const Real dvy = static_cast<Real>(flow.cell * (held.cyx[p] * dx + held.cyy[p] * dy));
    c.x[q] = c.x[p] - dx;
    c.y[q] = c.y[p] - dy;
    held.vx[q] -= dvx;
    held.vy[q] -= dvy;
    c.x[p] += dx;
    c.y[p] += dy;
    held.vx[p] += dvx;
    held.vy[p] += dvy;
}

/// Only after all halving, or its order would tell. Slopes of linear shapes jump at nodes: on the outermost one a point's
/// gradient would be of a neighbour that it gives no mass, and on the last of the cell beyond. It stays off them by more
/// than round-off.
void hold_inside(Flow& flow, Index p) {
    constexpr double kOff = 1e-9;  // [cells]
    Columns& c = flow.columns;
    const double off = flow.scheme.shape == Shape::linear ? kOff : 0.0;
    const auto hold = [&](double& u, Index nodes) { u = std::clamp(u, off, static_cast<double>(nodes - 1) - off); };
    hold(c.x[p], flow.grid.nx());
    hold(c.y[p], flow.grid.ny());
}

}  // namespace

Index Splitter::split(Flow& flow) {
    return flow.columns.with_real([&](auto real) { return split_as<decltype(real)>(flow); });
}

template <class Real>
Index Splitter::split_as(Flow& flow) {
    Columns& c = flow.columns;
    Carried<Real>& held = c.carried<Real>();
    const Index count = c.count();
    const double length = flow.scheme.split_length, longest = std::max(1.0, length);
    const bool may_split = flow.scheme.split;
    tile_first_.assign(static_cast<std::size_t>(flow.active.count()) + 1, 0);
    for_each_tile(flow.active, [&](Index n) {
        Index found = 0;
        bool changed = false;
        const Index tile = flow.active.tile[n];
        if (flow.active.quiet[tile] >= kAsleep) return;
        const Index end = flow.active.begin[n + 1];
        for (Index p = flow.active.begin[n]; p < end; ++p) {
            if (p + 4 <= end && four_stay(held, p, length, flow.scheme.reset_domains)) {
                p += 3;
                continue;
            }
            changed |= clamp_edges(held, p, 2.0 * longest);
            if (flow.scheme.reset_domains) changed |= straighten(held, p);
            const int parts = may_split ? parts_of<Real>(c, p, length, least_mass_) : 1;
            if (parts == 1) changed |= clamp_edges(held, p, longest);
            found += parts - 1;
        }
        tile_first_[n + 1] = found;
        if (changed || found > 0) flow.active.quiet[tile] = 0;
    });
    for (Index n = 0; n < flow.active.count(); ++n) tile_first_[n + 1] += tile_first_[n];
    const Index added = tile_first_.back();
    if (added == 0) return 0;
    c.resize(count + added);
    const std::size_t noted = parents_.size();
    if (notes_) parents_.resize(noted + static_cast<std::size_t>(added));
    for_each_tile(flow.active, [&](Index n) {
        Index next = tile_first_[n];
        if (next == tile_first_[n + 1]) return;
        for (Index p = flow.active.begin[n]; p < flow.active.begin[n + 1]; ++p) {
            const int parts = parts_of<Real>(c, p, length, least_mass_);
            if (parts == 1) continue;
            const Index q = count + next;
            for (int part = 1; part < parts; ++part, ++next) {
                c.id[count + next] = next_id_ + next;
                if (notes_) parents_[noted + static_cast<std::size_t>(next)] = c.id[p];
            }
            halve<Real>(flow, p, q, first_is_longer<Real>(c, p));
            if (parts == 4) {
                const bool other = first_is_longer<Real>(c, p);  // the edge that is still whole
                halve<Real>(flow, p, q + 1, other);
                halve<Real>(flow, q, q + 2, other);
            }
            for (int part = 0; part < parts; ++part) {
                const Index one = part == 0 ? p : q + part - 1;
                clamp_edges(held, one, longest);
                hold_inside(flow, one);
            }
        }
    });
    next_id_ += added;
    return added;
}

}  // namespace frana
