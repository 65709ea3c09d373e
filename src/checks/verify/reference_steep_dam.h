#pragma once
// A dam break on a steep plane by the equations of steep terrain, not linearised in the depth gradient.
#include <vector>

#include "checks/verify/problem.h"

namespace frana::verify {

/// One dimension, map coordinates: z = -slope x, depth h vertical, material in x < 0 up to far behind the dam.
///   h_t + (h u)_x = 0,   u_t + u u_x = g (slope - h_x) / (1 + slope (slope - h_x)) - mu g cos^2
/// Linearised in h_x this is the theory of Mangeney et al. (2000). Solved on `parcels` of equal mass that move with the
/// flow, leapfrog in time: no grid, no diffusion. Errors fall with the parcels to the power one (the front's last parcel).
class SteepDam {
public:
    struct Plane {
        double slope, friction, depth, gravity;
    };  ///< tangents, vertical depth [m], [m/s^2]
    SteepDam(const Plane& plane, double behind, double end, int parcels);

    double depth_at(double x) const;     ///< at `end` [m]
    double velocity_at(double x) const;  ///< along the map [m/s]
    double front() const { return x_.back(); }

private:
    double drive(double gradient) const;  ///< acceleration along the map [m/s^2]
    void accelerate(double dt);
    std::size_t parcel_at(double x) const;

    Plane plane_;
    double mass_;                ///< of a parcel, as an area [m2]
    std::vector<double> x_, u_;  ///< edges of the parcels and their velocities
};

/// How far the solution changes with half the parcels. Also that without friction and on a gentle slope it is Ritter's.
std::vector<Residual> steep_dam_residuals();

}  // namespace frana::verify
