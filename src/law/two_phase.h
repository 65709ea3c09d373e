#pragma once
// What solids with their confined water (c) and free water (u) do to one another where both are. This is drag, virtual
// mass and buoyancy (Pudasaini 2012, doi:10.1029/2011JF002186; van den Bout et al. 2021, doi:10.5194/gmd-14-1841-2021,
// eqs. 31 to 39). Also the step of their velocities, exact for constant coefficients. The printed equations were
// reconstructed from the prose and from the literature they cite. THEORY: src/water/THEORY.md.
#include "base/constants.h"
#include "base/types.h"

namespace frana {

/// Parts of the volume of a mixture.
struct Mixture {
    double solids;            ///< alpha_s, above 0 and below 1
    double structured = 0.0;  ///< f_sc: of the solids, in blocks
    double confined = 0.0;    ///< f_fc: of the water, within blocks, below 1

    double fluid() const { return 1.0 - solids; }
    double bound() const { return solids + confined * fluid(); }  ///< alpha_c
    double free() const { return (1.0 - confined) * fluid(); }    ///< alpha_u
    double grains() const { return (1.0 - structured) * solids; }
};

/// What a user says of two phases.
struct TwoPhaseMaterial {
    double solid_density = 2650.0, fluid_density = 1000.0;  ///< [kg/m^3]
    double viscosity = 1e-3;                                ///< of the fluid, eta [Pa s]
    double gravity = constants::kGravity;                   ///< [m/s^2]
    double grain = 1e-3, block = 0.1;                       ///< diameters of grains and of blocks [m]
    int power = 2;                                          ///< j: drag grows with the slip (1) or with its square (2)
    bool split = true;     ///< drag of blocks apart from that of grains; or all solids as grains, all water free
    double weighting = 1;  ///< m of P = (solid share)^m between solid-like and fluid-like drag
};

/// rho_c of solids with their confined water [kg/m^3], THEORY (16)
double bound_density(const TwoPhaseMaterial& material, const Mixture& mixture);

/// Speeds at which a grain of diameter d [m] settles in still fluid [m/s]: Stokes's, and Zanke's (1977). Zanke's tends
/// to 0.9 of Stokes's for small grains and to sqrt((rho_s / rho_f - 1) g d) for large ones.
double stokes_velocity(const TwoPhaseMaterial& material, double d);
double zanke_velocity(const TwoPhaseMaterial& material, double d);
/// THEORY (22): Stokes's below 0.1 mm, Zanke's from there on; in water it falls by an eighth there.
double terminal_velocity(const TwoPhaseMaterial& material, double d);
/// M of Richardson and Zaki (1954), by the particle's Reynolds number: 4.65 to 2.39.
double richardson_zaki(double reynolds);

/// THEORY (19) to (21): drag of both kinds of solids, force per volume on c is C |w|^(j - 1) w, w = u_u - u_c.
class TwoPhaseDrag {
public:
    explicit TwoPhaseDrag(const TwoPhaseMaterial& material);
    /// C [Pa s^j / m^(1 + j)] of blocks and grains (31); `flux`: K = |alpha_c u_c + alpha_u u_u| [m/s]
    double coefficient(const Mixture& mixture, double flux) const;
    /// The same of grains alone, all water free: alpha_s alpha_f (rho_s - rho_f) g over a speed to the j.
    double unsplit(double solids, double flux) const;
    /// That speed, of grains: U_T (P F + (1 - P) G) + S_p [m/s]. F is as in Kozeny and Carman (32), G as in Richardson
    /// and Zaki (33).
    double grain_speed(const Mixture& mixture, double flux) const;
    /// Of blocks: U_T G + K / alpha_u [m/s]
    double block_speed(const Mixture& mixture, double flux) const;
    const TwoPhaseMaterial& material() const { return material_; }

private:
    struct Settling {
        double speed, reynolds, exponent;
    };
    Settling settling(double d) const;
    double over(double weight, double speed) const;  ///< weight / speed^j

    TwoPhaseMaterial material_;
    Settling grain_, block_;
};

/// Virtual mass that c carries when it speeds up against u, as a number C_VM. Pudasaini's (2012) grows without bound
/// where there is little free water. Pudasaini and Mergili's (2019, doi:10.1029/2019JF005204) does not. THEORY (23).
enum class VirtualMass { none, unbounded, bounded };
double virtual_mass_number(VirtualMass law, const TwoPhaseMaterial& material, const Mixture& mixture);
/// Per area, of a mixture `depth` [m] deep: alpha_c rho_f C_VM h [kg/m^2]
double virtual_mass(VirtualMass law, const TwoPhaseMaterial& material, const Mixture& mixture, double depth);

/// Force of the fluid's pressure on c per area, -rho_f g_z h_c grad(surface) [Pa]; `normal_gravity`: g_z [m/s^2]
Vec2 buoyancy(double fluid_density, double normal_gravity, double bound_depth, const Vec2& surface_slope);
/// Stress with which c rests on the bed (39) [Pa], >= 0; `support`: share B of the pore pressure below
/// blocks.
double basal_stress(const TwoPhaseMaterial& material, const Mixture& mixture, double normal_gravity, double depth,
                    double support);

/// eta = eta_0 exp(beta C) of water with fines (O'Brien and Julien 1988), not below clear water's [Pa s]. eta_0 is in
/// Pa s: tables are often in poise, 0.1 Pa s. `concentration`: of the volume.
double mud_viscosity(double eta_0, double beta, double concentration, double clear = 1e-3);

/// One phase above a place, per area; nothing moves that has no mass.
struct Phase {
    double mass;          ///< [kg/m^2]
    Vec2 velocity;        ///< [m/s]
    Vec2 force = {0, 0};  ///< all but the exchange [Pa]
};

/// How two phases hold on to one another.
struct Exchange {
    double drag;                ///< h C [Pa s^j / m^j]
    int power;                  ///< j
    double virtual_mass = 0.0;  ///< [kg/m^2]
};

/// THEORY (24) to (26): a step of dt [s] of both velocities under forces, drag and virtual mass. It is stable for any
/// step. What one gets the other loses, to round-off. The slip follows its equation (mu + chi) dD/dt = mu (F_c / m_c -
/// F_u / m_u) - h C |D|^(j - 1) D, mu = m_c m_u / (m_c + m_u). It does so exactly for j = 1, and for j = 2 when force
/// and slip are parallel (else to first order).
void exchange(const Exchange& by, double dt, Phase& c, Phase& u);

}  // namespace frana
