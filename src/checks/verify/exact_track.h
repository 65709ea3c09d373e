#pragma once
// A point mass on a curved track in a vertical plane. It has the energy line, and the path with friction by the full
// normal force.
#include <memory>
#include <vector>

#include "checks/verify/problem.h"

namespace frana::verify {

/// A bed profile z(s) falling along s, smooth but for jumps of its curvature.
class Track {
public:
    virtual ~Track() = default;
    virtual double z(double s) const = 0;            ///< [m]
    virtual double slope(double s) const = 0;        ///< dz/ds [1]
    virtual double curvature(double s) const = 0;    ///< d2z/ds2 [1/m]
    virtual std::vector<double> joints() const = 0;  ///< where the curvature jumps, rising
};

/// Parabola that falls from `steepest` (tangent) at s = 0 to a flat from s = length on; straight before s = 0.
std::shared_ptr<const Track> parabola(double steepest, double length);
/// Straight slope, arc of a circle from s = 0 on backwards, flat from s = 0 on.
std::shared_ptr<const Track> hockey_stick(double slope_deg, double radius);
/// Circle of that radius around s = 0, straight from 60 degrees on.
std::shared_ptr<const Track> circle(double radius);

/// Coulomb friction's normal force: of gravity alone ("inertia"), or with the centripetal part ("full").
enum class Normal { gravity, full };

/// Where a point stops that is released at rest and slides towards larger s. It solves, piece by piece between the
/// joints,
/// (1 + z'^2) d(v^2)/ds = -2 z' (g + z'' v^2) - 2 mu (g or g + z'' v^2).
double stop_of(const Track& track, double mu, double start, Normal normal);
/// Where it is at t without friction, from (1 + z'^2) s'' = -z' (g + z'' s'^2).
double place_of(const Track& track, double start, double t);
/// Where the energy line of slope mu from the start meets the bed.
double energy_line(const Track& track, double mu, double start);

/// Slopes and curvatures by differences; the integrated point with gravity's normal force against the energy line.
std::vector<Residual> track_residuals(const Track& track, double mu, double start);
/// Pendulum: energy of the integrated path, its period by the elliptic integral (arithmetic-geometric mean).
std::vector<Residual> pendulum_residuals(double radius, double release_deg);

}  // namespace frana::verify
