#pragma once
// A flow point's state for an erosion law.
#include "base/simd.h"

namespace frana::erosion {

/// A particle over its bed. Lengths are normal to the bed, speeds along it. Real: double, or Double4 for four
/// particles.
template <class Real>
struct StateOf {
    Real thickness{};          ///< of the flow, > 0 [m]
    Real speed{};              ///< along the bed, > 0 [m/s]
    Real stress{};             ///< traction of the bed law on the flow's base, of laws with kSeesStress [Pa]
    Real normal_gravity{};     ///< g times the cosine of the slope, of laws with kSeesStress [m/s^2]
    Real eroded{};             ///< depth that was taken here already, of laws with kSeesEroded [m]
    Real left{};               ///< depth that can still be taken here, of laws with kSeesLeft [m]
    Real edge{};               ///< of a square as large as the particle, of laws with kSeesLeft [m]
    Real lies{};               ///< of a deposit on the bed, of laws with kSeesStress [m]
    Real bears{};              ///< stress that this deposit bears, of laws with kSeesStress [Pa]
    double density = 0.0;      ///< of the flow [kg/m^3]
    double bed_density = 0.0;  ///< [kg/m^3]
    double dt = 0.0;           ///< [s]
};
using State = StateOf<double>;

}  // namespace frana::erosion
