#pragma once
// Halving points whose domains have grown. It serves any model that has arrays with the names of shallow/particles.h
// (Points; Held: where what they carry lies). Numbers of equations: src/shallow/THEORY.md.
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/simd.h"
#include "mpm/domain.h"
#include "mpm/tile_grid.h"

namespace frana {

/// What decides on halving.
struct HalvingRules {
    double length;      ///< of an edge, from which a point is halved [cells]
    double least_mass;  ///< of a point that is halved [kg]
    bool split;         ///< otherwise domains are cut and straightened only
    bool straighten;    ///< strongly sheared domains become rectangles
    double off_side;    ///< that points stay off the outer nodes [cells]
};

/// New points' numbers, and whose parts they are.
struct Halves {
    Index next_id = 0;
    bool notes = false;
    std::vector<Index> parents;     ///< id for each new point, if `notes`
    std::vector<Index> tile_first;  ///< scratch
};

/// Long thin domains of points that may not split would throw their sub-points far ahead of the mass.
template <class Real>
bool clamp_edge(Real& x, Real& y, double longest) {
    const double length = std::sqrt(static_cast<double>(x) * x + static_cast<double>(y) * y);
    if (length <= longest) return false;
    x = static_cast<Real>(x * (longest / length));
    y = static_cast<Real>(y * (longest / length));
    return true;
}

/// Both edges. A point that splits may have edges twice as long as one that does not. Suppose they were drawn in before
/// it is halved. A high column that falls apart in a few steps would have its mass back in the middle. It would also
/// have energy that it had turned to motion.
template <class Held>
bool clamp_edges(Held& held, Index p, double longest) {
    const bool first = clamp_edge(held.r1x[p], held.r1y[p], longest);
    return clamp_edge(held.r2x[p], held.r2y[p], longest) || first;
}

/// Edges whose squared lengths differ by no more than this share are equally long: round-off.
template <class Held>
constexpr double kSameLength = sizeof(*Held().r1x.data()) == sizeof(float) ? 1e-5 : 1e-9;

/// Takes out of a point's gradient what stretches it along edges that are `longest` at least, and have just been cut to
/// it. A point that is alone stays as high as it was, however long its pressure has driven it apart: it would win energy
/// without end. Both edges count at once, or their order would tell.
template <class Held>
void stop_where_cut(Held& held, Index p, double longest) {
    using Real = typename decltype(held.cxx)::value_type;
    const double least2 = (1.0 - kSameLength<Held>)*longest * longest;
    const Edges e = edges_of(held, p);
    const double xx = held.cxx[p], xy = held.cxy[p], yx = held.cyx[p], yy = held.cyy[p];
    // Rate at which an edge grows over its length, where it is cut and grows.
    const auto rate = [&](double x, double y, double length2) {
        return length2 < least2 ? 0.0 : std::max(0.0, (x * x * xx + (xy + yx) * (x * y) + y * y * yy) / length2);
    };
    const double l1 = e.length1_2(), l2 = e.length2_2(), a1 = rate(e.r1x, e.r1y, l1), a2 = rate(e.r2x, e.r2y, l2);
    if (a1 == 0.0 && a2 == 0.0) return;
    const double dot = e.r1x * e.r2x + e.r1y * e.r2y, c2 = a1 > 0.0 && a2 > 0.0 ? dot * dot / (l1 * l2) : 0.0;
    const double whole = 1.0 / std::max(0.1, 1.0 - c2 * c2);  // a domain that is straightened has 0.12 at least
    const double s1 = l1 > 0.0 ? whole * (a1 - c2 * a2) / l1 : 0.0, s2 = l2 > 0.0 ? whole * (a2 - c2 * a1) / l2 : 0.0;
    const double shear = s1 * (e.r1x * e.r1y) + s2 * (e.r2x * e.r2y);
    held.cxx[p] = static_cast<Real>(xx - (s1 * (e.r1x * e.r1x) + s2 * (e.r2x * e.r2x)));
    held.cyy[p] = static_cast<Real>(yy - (s1 * (e.r1y * e.r1y) + s2 * (e.r2y * e.r2y)));
    held.cxy[p] = static_cast<Real>(xy - shear), held.cyx[p] = static_cast<Real>(yx - shear);
}

/// Squared lengths of a domain's edges over its squared area, from which on it is strongly sheared.
inline double most_sheared() { return 16.0; }

/// A strongly sheared domain, all edge and no area, gives way to the rectangle with the same second moments.
template <class Held>
bool straighten(Held& held, Index p) {
    const Edges e = edges_of(held, p);
    const double area = e.area();
    if (e.length1_2() * e.length2_2() <= most_sheared() * area * area) return false;
    set_edges(held, p, rectangle_of(Moments::of(e)));
    return true;
}

/// How many points a domain becomes: 1, 2, or 4 where both edges are equally long. Then round-off must not choose one, or
/// mirror particles part.
template <class Held>
int parts_of(const Held& held, Index p, double mass, const HalvingRules& rules) {
    constexpr double same = kSameLength<Held>;
    const Edges e = edges_of(held, p);
    const double l1 = e.length1_2(), l2 = e.length2_2();
    // Edges are cut to the splitting length where that is a cell or more. It must not take more than round-off to reach
    // it.
    const bool is_long = std::max(l1, l2) >= (1.0 - same) * rules.length * rules.length;
    if (!is_long || std::abs(e.area()) < 0.1 || mass <= rules.least_mass) return 1;
    return std::abs(l1 - l2) <= same * std::max(l1, l2) ? 4 : 2;
}

/// Whether four points in a row have short, sound domains, so that nothing below changes them: as most do.
template <class Held>
bool four_stay(const Held& held, Index p, const HalvingRules& rules) {
    const Double4 r1x = load(&held.r1x[p], 4), r1y = load(&held.r1y[p], 4);
    const Double4 r2x = load(&held.r2x[p], 4), r2y = load(&held.r2y[p], 4);
    const Double4 l1 = r1x * r1x + r1y * r1y, l2 = r2x * r2x + r2y * r2y, area = r1x * r2y - r1y * r2x;
    Mask4 stay = max(l1, l2) < (1.0 - kSameLength<Held>)*rules.length * rules.length;
    if (rules.straighten) stay &= l1 * l2 <= most_sheared() * area * area;
    return !any(~stay);
}

/// Cuts the edges of four points in a row. Does nothing and returns false if one may have to be halved or straightened.
/// A thin sheet is made of points that are long and too light to be halved.
template <class Points, class Held, class Alone>
bool four_cut(const Points& c, Held& held, Index p, const HalvingRules& rules, double longest, Alone&& alone,
              bool& changed) {
    Double4 r1x = load(&held.r1x[p], 4), r1y = load(&held.r1y[p], 4);
    Double4 r2x = load(&held.r2x[p], 4), r2y = load(&held.r2y[p], 4);
    const Double4 l1 = r1x * r1x + r1y * r1y, l2 = r2x * r2x + r2y * r2y, area = r1x * r2y - r1y * r2x;
    Mask4 one = l1 >= 0.0;
    if (rules.straighten) one &= l1 * l2 <= most_sheared() * area * area;
    if (rules.split)
        one &= (max(l1, l2) < (1.0 - kSameLength<Held>)*rules.length * rules.length) | (abs(area) < 0.1) |
               (load(&c.mass[p], 4) <= rules.least_mass);
    if (any(~one)) return false;
    const Double4 length1 = sqrt(l1), length2 = sqrt(l2), whole = all(1.0);
    if (!any(max(length1, length2) > longest)) return true;
    const Double4 share1 = select(length1 > longest, longest / length1, whole),
                  share2 = select(length2 > longest, longest / length2, whole);
    store(&held.r1x[p], share1 * r1x, 4), store(&held.r1y[p], share1 * r1y, 4);
    store(&held.r2x[p], share2 * r2x, 4), store(&held.r2y[p], share2 * r2y, 4);
    for (int n = 0; n < 4; ++n)
        if ((share1[n] < 1.0 || share2[n] < 1.0) && alone(p + n)) stop_where_cut(held, p + n, longest);
    changed = true;
    return true;
}

template <class Held>
bool first_is_longer(const Held& held, Index p) {
    const Edges e = edges_of(held, p);
    return e.length1_2() >= e.length2_2();
}

/// THEORY (54): halves point p along one of its edges; the second half becomes point q.
template <class Points, class Held>
void halve(Points& c, Held& held, Index p, Index q, bool first, double cell) {
    using Real = typename decltype(held.r1x)::value_type;
    Real& rx = first ? held.r1x[p] : held.r2x[p];
    Real& ry = first ? held.r1y[p] : held.r2y[p];
    const double dx = 0.25 * rx, dy = 0.25 * ry;
    rx *= Real{0.5};
    ry *= Real{0.5};
    c.halve(p);
    c.each([&](auto& array) { array[q] = array[p]; });
    const Real dvx = static_cast<Real>(cell * (held.cxx[p] * dx + held.cxy[p] * dy));
    const Real dvy = static_cast<Real>(cell * (held.cyx[p] * dx + held.cyy[p] * dy));
    c.x[q] = c.x[p] - dx;
    c.y[q] = c.y[p] - dy;
    held.vx[q] -= dvx;
    held.vy[q] -= dvy;
    c.x[p] += dx;
    c.y[p] += dy;
    held.vx[p] += dvx;
    held.vy[p] += dvy;
}

/// Only after all halving, or its order would tell. Slopes of linear shapes jump at nodes. On the outermost one a
/// point's gradient would be of a neighbour that it gives no mass. On the last it would be of the cell beyond. It stays
/// off them by more than round-off.
template <class Points>
void hold_inside(Points& c, Index p, const TileGrid& grid, double off) {
    const auto hold = [&](double& u, Index nodes) { u = std::clamp(u, off, static_cast<double>(nodes - 1) - off); };
    hold(c.x[p], grid.nx());
    hold(c.y[p], grid.ny());
}

/// One point's part in halve_points: it, and those at q, q + 1, q + 2.
template <class Points, class Held>
void halve_into(Points& c, Held& held, Index p, Index q, int parts, double cell) {
    halve(c, held, p, q, first_is_longer(held, p), cell);
    if (parts != 4) return;
    const bool other = first_is_longer(held, p);  // the edge that is still whole
    halve(c, held, p, q + 1, other, cell);
    halve(c, held, q, q + 2, other, cell);
}

/// Cuts and straightens the domains of all points of tiles awake, and halves those that `may(p)` and are long. Those that
/// are cut and `alone(p)` stretch no more. New points are appended; returns how many. The same bits for any number of
/// threads.
template <class Points, class Held, class May, class Alone>
Index halve_points(const TileGrid& grid, ActiveTiles& active, const HalvingRules& rules, Points& c, Held& held,
                   Halves& halves, May&& may, Alone&& alone) {
    const Index count = c.count();
    const double longest = std::max(1.0, rules.length);
    const auto parts = [&](Index p) { return rules.split && may(p) ? parts_of(held, p, c.mass[p], rules) : 1; };
    halves.tile_first.assign(static_cast<std::size_t>(active.count()) + 1, 0);
    for_each_tile(active, [&](Index n) {
        Index found = 0;
        bool changed = false;
        const Index tile = active.tile[n];
        if (active.quiet[tile] >= kAsleep) return;
        const Index end = active.begin[n + 1];
        for (Index p = active.begin[n]; p < end; ++p) {
            if (p + 4 <= end && (four_stay(held, p, rules) || four_cut(c, held, p, rules, longest, alone, changed))) {
                p += 3;
                continue;
            }
            changed |= clamp_edges(held, p, 2.0 * longest);
            if (rules.straighten) changed |= straighten(held, p);
            const int into = parts(p);
            if (into == 1 && clamp_edges(held, p, longest)) {
                changed = true;
                if (alone(p)) stop_where_cut(held, p, longest);
            }
            found += into - 1;
        }
        halves.tile_first[n + 1] = found;
        if (changed || found > 0) active.quiet[tile] = 0;
    });
    for (Index n = 0; n < active.count(); ++n) halves.tile_first[n + 1] += halves.tile_first[n];
    const Index added = halves.tile_first.back();
    if (added == 0) return 0;
    c.resize(count + added);
    const std::size_t noted = halves.parents.size();
    if (halves.notes) halves.parents.resize(noted + static_cast<std::size_t>(added));
    for_each_tile(active, [&](Index n) {
        Index next = halves.tile_first[n];
        if (next == halves.tile_first[n + 1]) return;
        for (Index p = active.begin[n]; p < active.begin[n + 1]; ++p) {
            const int into = parts(p);
            if (into == 1) continue;
            const Index q = count + next;
            for (int part = 1; part < into; ++part, ++next) {
                c.id[count + next] = halves.next_id + next;
                if (halves.notes) halves.parents[noted + static_cast<std::size_t>(next)] = c.id[p];
            }
            halve_into(c, held, p, q, into, grid.cell());
            for (int part = 0; part < into; ++part) {
                const Index one = part == 0 ? p : q + part - 1;
                clamp_edges(held, one, longest);
                hold_inside(c, one, grid, rules.off_side);
            }
        }
    });
    halves.next_id += added;
    return added;
}

}  // namespace frana
