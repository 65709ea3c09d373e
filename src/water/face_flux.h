#pragma once
// Shallow water at a face between two cells: limited slopes, hydrostatic reconstruction (Audusse et al. 2004,
// doi:10.1137/S1064827503431090). The flux is that of Harten, Lax and van Leer with the contact wave (HLLC, Toro 2001).
// Functions are for one face (Real is double) or for four side by side (Double4). THEORY (3), (5) to (7).
#include "base/simd.h"

namespace frana {

/// The change of a quantity over a cell, from its changes to the cells before (a) and behind (b). It is
/// min(theta |a|, |a + b| / 2, theta |b|), or 0 at an extremum. theta = 1 is minmod, 2 is van Leer's MC; values at
/// faces stay between those of the neighbours for theta <= 2.
/// MC is the default. Against minmod it takes a third off the depth's error in Stoker's dam break, a quarter in the
/// round one. It takes half off in the planar bowl and two thirds off in the radial one (100 cells). Stoker's total
/// variation stays within 1 % of the exact one. Between them, 1.3 is a fifth better than MC in the planar bowl of 200
/// cells.
template <class Real>
[[gnu::always_inline]] inline Real limited(Real a, Real b, double theta) {
    const Real none = {}, mean = 0.5 * (a + b);
    const Real bound = min(min(theta * abs(a), theta * abs(b)), abs(mean));
    return select(a * b > 0.0, select(mean > 0.0, bound, -bound), none);
}

/// Water at one side of a face.
template <class Real>
struct FaceSide {
    Real depth;          ///< >= 0 [m]
    Real ground;         ///< [m]
    Real along, across;  ///< velocity through the face and along it [m/s]
};

/// What goes through a face, per metre of it and over the density.
template <class Real>
struct FaceFlux {
    Real mass;           ///< [m^2/s]
    Real along, across;  ///< momentum that the mass carries [m^3/s^2]
    Real low, high;      ///< all other momentum through the face [m^3/s^2]. Less the pressure g h^2 / 2 of the water
                         ///< that stands there after reconstruction, on either side
};

/// The flux between two sides under gravity g [m/s^2]. The ground of the face is the higher one of both sides. What
/// stands level does not flow, to the last bit. A dry side higher than the water is a wall. Speeds of the waves are
/// Davis's, next to dry ground those of a dam break.
template <class Real>
[[gnu::always_inline]] inline FaceFlux<Real> face_flux(const FaceSide<Real>& l, const FaceSide<Real>& r, Real g) {
    const Real none = {};
    const Real hl = max(none, l.depth - max(none, r.ground - l.ground)),
               hr = max(none, r.depth - max(none, l.ground - r.ground));
    const Real cl = sqrt(g * hl), cr = sqrt(g * hr), ul = l.along, ur = r.along;
    const auto dry_l = hl <= 0.0, dry_r = hr <= 0.0;
    const Real slow = min(none, select(dry_l, ur - 2.0 * cr, select(dry_r, ul - cl, min(ul - cl, ur - cr))));
    const Real fast = max(none, select(dry_r, ul + 2.0 * cl, select(dry_l, ur + cr, max(ul + cl, ur + cr))));
    const Real per = select((fast > slow) & ((hl > 0.0) | (hr > 0.0)), 1.0 / (fast - slow), none);
    const Real ml = hl * ul, mr = hr * ur;
    FaceFlux<Real> f;
    f.mass = per * (fast * ml - slow * mr + slow * fast * (hr - hl));
    const auto forward = f.mass > 0.0;
    f.along = f.mass * select(forward, ul, ur);
    f.across = f.mass * select(forward, l.across, r.across);
    const Real spread = per * (fast * ml * ul - slow * mr * ur + slow * fast * (mr - ml)) - f.along;
    const Real jump = 0.5 * g * per * (hr - hl) * (hr + hl);
    f.low = spread - slow * jump;
    f.high = spread - fast * jump;
    return f;
}

}  // namespace frana
