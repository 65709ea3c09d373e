#pragma once
// Deposits of a material with a yield stress that came to rest marginally everywhere. On flat ground they are in the
// plane and round an axis (Nye 1952; Liu and Mei 1989; Balmforth et al. 2006). Others are on an incline (Coussot and
// Proust 1996).
#include <vector>

#include "checks/verify/problem.h"

namespace frana::verify {

/// What the rest of a deposit depends on.
struct YieldMaterial {
    double density, yield_stress;  ///< [kg/m^3], [Pa]
    double g = 9.81;
    /// Half the length over which a deposit on flat ground rises by itself, tau_Y / (rho g) [m]
    double length() const { return yield_stress / (density * g); }
};

/// rho g h |dh/dx| = tau_Y on flat ground, from a wall at x = 0.
struct FlatDeposit {
    YieldMaterial material;
    double volume;                       ///< per width [m^2]
    double front() const;                ///< (9 rho g V^2 / (8 tau_Y))^(1/3) [m]
    double depth(double x) const;        ///< sqrt(2 tau_Y (x_f - x) / (rho g)) [m]
    double contour(double level) const;  ///< where the depth is `level` [m]
    std::vector<Residual> residuals() const;
};

/// The same round an axis.
struct RoundDeposit {
    YieldMaterial material;
    double volume;         ///< of the full circle [m^3]
    double front() const;  ///< (225 rho g V^2 / (128 pi^2 tau_Y))^(1/5) [m]
    double depth(double r) const;
    double contour(double level) const;
    std::vector<Residual> residuals() const;
};

/// On an incline, front down-slope, behind it a vertical wall at x = 0. Let H = h/h_c, h normal to the bed and h_c the
/// plug's thickness. Then rho g h (sin th - cos th dh/dX) = tau_Y has s = (h_c / tan th) (-H - ln(1 - H)). s is
/// up-slope from the front along the bed. Here it is read as on the map: depth above x of the surface's own
/// place.
class InclineDeposit {
public:
    InclineDeposit(const YieldMaterial& material, double slope, double volume);
    double plug() const { return plug_; }    ///< h_c = tau_Y / (rho g sin th) [m]
    double front() const { return front_; }  ///< map distance of the foremost place from the wall [m]
    double depth(double x) const;            ///< vertical [m]
    double contour(double level) const;      ///< map place of that vertical depth [m]
    /// Distance up-slope from the foot of the front, along the bed [m].
    double distance(double share) const;
    std::vector<Residual> residuals() const;

private:
    double behind(double share) const;  ///< map distance of the surface with H = share from H = 0 [m]
    double held(double share) const;    ///< volume per width between the front and there [m^2]
    YieldMaterial material_;
    double slope_, volume_, plug_, front_ = 0.0, foot_ = 0.0;
    double least_;  ///< H of the front's vertical edge; below it the surface overhangs
};

}  // namespace frana::verify
