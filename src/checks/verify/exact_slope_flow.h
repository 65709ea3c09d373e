#pragma once
// Dry frictional flows on planes whose pressure and drive separate: dam breaks, the sliding cap, the similarity pile.
#include <vector>

#include "checks/verify/exact_dam_break.h"

namespace frana::verify {

/// Dam break on a plane under Coulomb friction (Mangeney et al. 2000). It is Ritter's fan in a frame that falls with
/// `drive`. Lengths along x, gravity across the layer; x = 0 is the dam, material fills x < 0.
struct SlopeDam {
    double depth;    ///< of the reservoir [m]
    double gravity;  ///< of the layer's pressure [m/s^2]
    double drive;    ///< acceleration of an infinite layer [m/s^2]

    WaveState at(double x, double t) const;
    double front(double t) const;  ///< [m]
    double rear(double t) const;   ///< where the fan meets the undisturbed reservoir [m]
    /// The dam of AvaFrame's damBreak test: 22 degrees, friction 21 degrees, 1 m normal to the slope.
    static SlopeDam avaframe();
    /// Mass and momentum equations by differences, and the printed figures of the AvaFrame dam.
    std::vector<Residual> residuals() const;
    static std::vector<Residual> published();
};

/// A parabolic cap that spreads while it slides (Savage and Hutter 1989, one dimension): h = hc / l (1 - (x - drive
/// t^2/2)^2 / (w l)^2). There l'' = 2 g hc / (w^2 l^2), l(0) = 1, l'(0) = 0.
struct SlidingCap {
    double depth;       ///< hc [m]
    double half_width;  ///< w [m]
    double gravity;     ///< [m/s^2]
    double drive;       ///< [m/s^2]

    /// l from its first integral: sqrt(l (l - 1)) + ln(sqrt l + sqrt(l - 1)) = sqrt(4 g hc) t / w.
    double stretch(double t) const;
    WaveState at(double x, double t) const { return at(x, t, stretch(t)); }
    WaveState at(double x, double t, double stretch_then) const;  ///< the same without solving for l
    std::vector<Residual> residuals() const;
};

}  // namespace frana::verify
