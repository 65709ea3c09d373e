#pragma once
// Trees that take mass out of a flow: detrainment (Feistl et al. 2014).
#include <limits>

namespace frana {

/// A forest takes K/u in each second and on each square metre along the bed [kg/(m2 s)], u the speed along it. K [Pa] is
/// that of the stand: 10 to 150.
struct Detrainment {
    double min_speed = 0.1;  ///< slower flow loses nothing, since K/u has no end [m/s]
    double max_speed = std::numeric_limits<double>::infinity();  ///< likewise faster flow [m/s]
    double max_depth = std::numeric_limits<double>::infinity();  ///< and deeper flow, along gravity [m]

    /// A particle in the middle of a step.
    struct State {
        double pressure;   ///< K [Pa]
        double density;    ///< [kg/m^3]
        double depth;      ///< along gravity [m]
        double thickness;  ///< normal to the bed [m]
        double speed;      ///< along the bed [m/s]
    };
    /// Share of its mass that a particle loses in `dt` [s], at most 1. Its ground stays, so the loss is even in time.
    double share(const State& s, double dt) const {
        if (!(s.speed >= min_speed && s.speed <= max_speed && s.depth <= max_depth)) return 0.0;
        const double lost = s.pressure * dt, there = s.density * s.thickness * s.speed;
        return lost < there ? lost / there : 1.0;
    }
};

}  // namespace frana
