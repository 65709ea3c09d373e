#pragma once
// The terrain under a grid update, at one node (Real: double) or four in a row (Double4). It is gentle or steep, curved
// or not.
#include "base/simd.h"
#include "shallow/flow.h"
#include "shallow/surface_gradient.h"

namespace frana {

/// 1 at margins, whose surface may be that of what lies behind; otherwise 0. A node that is wide both ways may also be one of
/// four, where it is 0.
inline double at_front(const Flow& flow, Index k) {
    const std::uint8_t flags = flow.nodes.flags[k];
    return (flags & kMargin) && (flags & (kWideX | kWideY)) != (kWideX | kWideY) ? 1.0 : 0.0;
}

/// Terrain of Fois et al. (2024): gentle slopes, no curvature. Driving a = -g grad(eta), normal force g.
template <class Real>
struct GentleBed {
    GentleBed(const Flow&, Index) {}
};

/// Driving slope of the surface, times its gravity: a = -gravity * (x, y).
template <class Real>
struct Drive {
    Real x, y;
};

/// Slopes whose squares are far below this are smooth, whatever the ground around. What a bend there could turn is as
/// small.
constexpr double kFlat = 0.01;
/// Square of the round-off of a few operations, relative [1].
constexpr double kRoundOff2 = 1e-28;

/// Steep terrain. kLinear: to first order in the depth gradient. kCurvature: none, inertia (v.H.v in the acceleration
/// only), full (in the friction too).
template <class Real, Curvature kCurvature, bool kLinear>
struct SteepBed {
    Real bx, by, hxx{}, hxy{}, hyy{};
    const Pair* smooth = nullptr;     ///< read where something climbs or flies
    const double* surface = nullptr;  ///< read where something climbs [m]
    SteepBed(const Flow& flow, Index k) : bx(read<Real>(&flow.bed.slope_x[k])), by(read<Real>(&flow.bed.slope_y[k])) {
        if constexpr (kCurvature != Curvature::none) {
            hxx = read<Real>(&flow.bed.hxx[k]);
            hxy = read<Real>(&flow.bed.hxy[k]);
            hyy = read<Real>(&flow.bed.hyy[k]);
            smooth = &flow.bed.smooth[k];
            surface = &flow.nodes.surface[k];
        }
    }
    /// What a velocity (dx, dy) that climbs loses besides, in dt; `weight`: gravity() of the grid update. Where the bed
    /// is smooth, v.H.v turns the velocity up a slope. The slope's own acceleration is 1/(1 + q) of gravity. Together a
    /// climb by z costs g z. A bend shorter than the curvature's length turns nothing. So the part of the slope that
    /// the smoothed bed does not have acts with all of gravity. Otherwise a column would climb a step of slope B at a
    /// cost of g z / (1 + B^2). `at_front`, 1 at margins: the surface there is that of what lies behind. A front leaves
    /// that on its way up such a step. There the bed's slope counts. This stops a climb and turns none round. `cell`: of
    /// the nodes [m].
    void climb(Real ex, Real ey, Real at_front, double g, double cell, Real weight, double dt, Real& dx,
               Real& dy) const {
        if constexpr (kCurvature != Curvature::none) {
            const Real zero{}, one = zero + 1.0, up = dx * ex + dy * ey, up_bed = dx * bx + dy * by;
            if (!any((up > 0.0) | (at_front * up_bed > 0.0))) return;
            Real smooth_x, smooth_y;
            unzip(smooth, smooth_x, smooth_y);
            const Real slope2 = bx * bx + by * by, along = smooth_x * bx + smooth_y * by;
            const Real known = min(one, max(zero, (along + kFlat) / (slope2 + kFlat)));
            const Real share = known * known, q = max(zero, bx * ex + by * ey);
            const Real hidden =
                max(zero, up_bed - up) / (abs(up_bed) + abs(up) + 1e-300);  // of the climb, by the margin
            const Real bare = at_front * (1.0 - share) * hidden;
            const Real cx = ex + bare * (bx - ex), cy = ey + bare * (by - ey);
            const Real rise = dx * cx + dy * cy, square = max(cx * cx + cy * cy, zero + 1e-300);
            const Real whole = (g + share * (weight - g)) / (1.0 + share * share * max(zero, bx * cx + by * cy));
            const Real had = weight / (1.0 + q) * max(zero, ex * cx + ey * cy) / square;
            const Real most = rise / square, lost = select(rise > 0.0, min(dt * max(zero, whole - had), most), zero);
            const Real left_x = dx - lost * cx, left_y = dy - lost * cy;
            // What stops leaves round-off, which has no direction; friction would start from the speed in that direction.
            // Most of it is that of the surface's height in its slope. A millionth of the speed is no round-off.
            const Real unknown = kSurfaceRoundOff / cell * read<Real>(surface);
            const Real off2 = kRoundOff2 * square + min(unknown * unknown, 1e-12 * square);
            const auto stays = (rise > 0.0) & (lost >= most) &
                               (square * (left_x * left_x + left_y * left_y) <= off2 * (dx * dx + dy * dy));
            dx = select(stays, zero, left_x), dy = select(stays, zero, left_y);
        }
    }
    /// Gravity plus the bed's own vertical acceleration along the path, (g + v.H.v)+
    Real gravity(double g, Real vx, Real vy) const {
        if constexpr (kCurvature == Curvature::none) return Real{} + g;
        return max(Real{}, g + vx * vx * hxx + 2.0 * vx * vy * hxy + vy * vy * hyy);
    }
    /// gravity(g, vx, vy) times `slope` (drive()), less where the flow is high against the bend. With k = v.H.v,
    /// k * slope has two parts. k B / (1 + B^2) turns the velocity along the bed and does no work. The rest is k added
    /// to the pressure. That works at -k v.grad(h) / (1 + q), of nothing. What takes it back is of second order in the
    /// depth times the bed's bend, and not in the model. From a column of that height down to its foot it gives v^2/2 a
    /// share 2 |k| high / v^2. So the rest fades where the bed's slope along the path changes by over a quarter within
    /// the depth: |k| high > v^2 / 4. It is gone at a half: half of v^2/2 at most. `high`: depth a cell around [m].
    /// Where g + k is below 0 the flow would fly. It has no weight there, but it takes the slope of the bed all the
    /// same. If its velocity along the map stayed it would win energy by falling faster than what flies. Its direction
    /// stays, and so does a speed along the bed that gravity alone changes. (To turn it with the bed would do no work
    /// either, but draw a flow that passes a spur uphill.) A climb counts by the smoothed bed. H is its bend, and a
    /// step in the bed that only the raw bed has may give no speed.
    Drive<Real> driving(const Drive<Real>& slope, double g, Real high, Real vx, Real vy, Real cosine) const {
        const Real weight = gravity(g, vx, vy);
        const Drive<Real> whole{weight * slope.x, weight * slope.y};
        if constexpr (kCurvature == Curvature::none) return whole;
        const Real k = vx * vx * hxx + 2.0 * vx * vy * hxy + vy * vy * hyy, speed2 = vx * vx + vy * vy;
        const auto too_high = 4.0 * abs(k) * high > speed2;
        const Real flies = min(Real{}, g + k);
        if (!any(too_high | (flies < 0.0))) return whole;
        const Real share = max(Real{}, 2.0 - 4.0 * abs(k) * high / max(speed2, Real{} + 1e-300));
        const Real lift = select(too_high, weight - max(Real{}, g + share * k), Real{}), c2 = cosine * cosine;
        Real smooth_x, smooth_y;
        unzip(smooth, smooth_x, smooth_y);
        const Real w = vx * bx + vy * by, up = min(w, max(Real{}, vx * smooth_x + vy * smooth_y));
        const Real held = flies * up / max(speed2 + w * w, Real{} + 1e-300);
        return {whole.x - lift * (slope.x - c2 * bx) + held * vx, whole.y - lift * (slope.y - c2 * by) + held * vy};
    }
    /// Depth a cell away, up its gradient. At the foot of a column the pressure on a node is the column's. `ex`, `ey`:
    /// slope of the free surface.
    Real height_around(const Flow& flow, Real depth, Real ex, Real ey) const {
        return depth + flow.cell * (abs(ex - bx) + abs(ey - by));
    }
    /// grad(eta) / (1 + q), q = gradZ . grad(eta): a column that accelerates vertically with its bed. Where the surface
    /// slopes against the bed (q < 0) that would grow without bound and make energy of nothing. There it is the plain
    /// gradient. At q = -1 the column would have no weight. Linear: c^2 (gradZ + grad h - c^2 gradZ (gradZ .
    /// grad h)), the first terms of its series in grad h.
    Drive<Real> drive(Real ex, Real ey, Real cosine) const {
        if constexpr (kLinear) {
            const Real c2 = cosine * cosine, hx = ex - bx, hy = ey - by, along = c2 * (bx * hx + by * hy);
            return {c2 * (ex - bx * along), c2 * (ey - by * along)};
        } else {
            const Real q = bx * ex + by * ey, reduce = select(q >= 0.0, 1.0 / (1.0 + abs(q)), Real{} + 1.0);
            return {reduce * ex, reduce * ey};
        }
    }
};

struct Gentle {
    static constexpr bool kSteep = false, kLinearised = false;
    template <class Real>
    using Bed = GentleBed<Real>;
};

template <Curvature kCurvature, bool kLinear>
struct Steep {
    static constexpr bool kSteep = true, kLinearised = kLinear;
    template <class Real>
    using Bed = SteepBed<Real, kCurvature, kLinear>;
};

}  // namespace frana
