#pragma once
// Free water as structured particles meet it: cells around the nodes of the same grid.
// Numbers of equations: src/water/THEORY.md.
#include <algorithm>

#include "base/node_values.h"
#include "law/two_phase.h"
#include "law/water_friction.h"

namespace frana {

/// How particles and free water act on one another (van den Bout et al. 2021, sec. 2.3; what the paper leaves open is
/// said here).
struct WaterExchange {
    TwoPhaseMaterial material;
    VirtualMass virtual_mass = VirtualMass::none;
    /// B, share of the pore pressure that bears the particles where their pores are full [1]
    double pore_pressure = 1.0;
    /// Free water over bound volume that fills the pores [1]. With less, B goes down in proportion: a particle that
    /// stands dry rests on the bed with all its weight. This is that of loose grains, four tenths of them pores.
    double void_ratio = 0.67;
};

/// The water's own numbers, which particles change: depth [m] and discharge [m^2/s], by storage index.
struct FreeWater {
    WaterExchange by;
    TwoPhaseDrag drag;
    double *h, *qx, *qy;
    const double* bed;  ///< elevation above any datum [m]
    double film;        ///< water as shallow as this takes no part [m]
    WaterFriction::Law friction;
    NodeValues<double> coefficients;  ///< of that law
    WaterViscosity viscosity;

    WaterFriction friction_at(Index k) const { return {friction, coefficients[k]}; }

    /// THEORY (17): share of its weight that water takes off a particle's bed. It is 1 at most: buoyancy never makes
    /// the force on the bed tensile.
    double support(double bound_density, double bound_depth, double depth) const {
        const double full = by.void_ratio * bound_depth;
        const double share = depth < full ? depth / full : 1.0;
        return std::min(1.0, share * by.pore_pressure * by.material.fluid_density / bound_density);
    }
};

}  // namespace frana
