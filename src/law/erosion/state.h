#pragma once
// What an erosion law sees of a point of the flow.

namespace frana::erosion {

/// A column over its bed. Lengths are normal to the bed, speeds along it.
struct State {
    double thickness = 0.0;       ///< of the flow, > 0 [m]
    double speed = 0.0;           ///< along the bed, > 0 [m/s]
    double stress = 0.0;          ///< traction of the bed law on the flow's base [Pa]
    double eroded = 0.0;          ///< depth that was taken here already, of laws with kSeesEroded [m]
    double density = 0.0;         ///< of the flow [kg/m^3]
    double bed_density = 0.0;     ///< [kg/m^3]
    double dt = 0.0;              ///< [s]
    double normal_gravity = 0.0;  ///< g times the cosine of the slope [m/s^2]
    double left = 0.0;            ///< depth that can still be taken here, of laws with kSeesEroded [m]
    double edge = 0.0;            ///< of a square as large as the column [m]
};

}  // namespace frana::erosion
