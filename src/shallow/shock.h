#pragma once
// Artificial viscosity at bores, and the sensor that holds the surface filter back there.
#include <algorithm>

#include "shallow/flow.h"

namespace frana {

/// THEORY (27), (28): momentum fluxes of the limited artificial viscosity [m^3/s^2], and the shock sensor [0, 1]. The
/// fluxes go through the faces of each node towards +x (for vx) and +y (for vy). Acts in compression only, zero for
/// linear velocities. Per face with velocity jump d < 0, depth h (harmonic mean) and c = sqrt(g h): e = |d| (1 -
/// limiter), flux = h e (c1 c + c2 e). The limiter fades out where |d| exceeds scheme.shock_gate * c. So the middle of
/// a bore is not mistaken for a smooth velocity. The sensor grows from e = kap c to 2 kap c, kap = scheme.shock_sensor.
/// c1 c + c2 e is cell / (2 velocity_dt) at most: beyond that an explicit step makes energy instead of taking it. A
/// velocity step of 0 has no bound. Needs depth, flags and velocity before the grid update. Does nothing when the
/// scheme has no viscosity.
void shock_pass(Flow& flow, double velocity_dt);

/// Whether the scheme has artificial viscosity at all.
inline bool has_viscosity(const Scheme& scheme) {
    return scheme.viscosity_linear > 0.0 || scheme.viscosity_quadratic > 0.0;
}

/// Whether the filter is held back at bores.
inline bool senses_bores(const Scheme& scheme) { return has_viscosity(scheme) && scheme.shock_sensor > 0.0; }

/// Sensor at a node: the largest of its own four faces and of those of its four neighbours.
inline double shock_near(const Nodes& nodes, Index k, Index up) {
    const Pair* s = nodes.shock.data() + k;
    const double along_x = std::max({s[-2].x, s[-1].x, s[0].x, s[1].x});
    const double along_y = std::max({s[-2 * up].y, s[-up].y, s[0].y, s[up].y});
    const double adjacent_x = std::max({s[up].x, s[up - 1].x, s[-up].x, s[-up - 1].x});
    const double adjacent_y = std::max({s[1].y, s[1 - up].y, s[-1].y, s[-1 - up].y});
    return std::max({along_x, along_y, adjacent_x, adjacent_y});
}

/// The share of the filter's strength that the sensor leaves. THEORY (18).
inline double away_from_bores(const Nodes& nodes, Index k, Index up) {
    return std::max(0.0, 1.0 - 2.0 * shock_near(nodes, k, up));
}

}  // namespace frana
