#pragma once
// Friction of water at the bed. Numbers of equations: src/water/THEORY.md.
#include <cmath>
#include <variant>
#include <vector>

#include "law/key.h"
#include "law/law_map.h"

namespace frana {

/// Friction of water at the bed as a case names it: parameters and keys of each law.
namespace water_law {

struct None {
    static constexpr const char* name = "none";
    static constexpr const char* is = "";
    static std::vector<laws::Key<None>> keys() { return {}; }
};

struct Manning {
    double n = 0.0;  ///< roughness [s/m^(1/3)]

    static constexpr const char* name = "manning";
    static constexpr const char* is = "";
    static std::vector<laws::Key<Manning>> keys() {
        return {{&Manning::n, "manning_n", "s/m^(1/3)", ranges::above_to(0.0, 1.0), "Manning's roughness"}};
    }
};

struct DarcyWeisbach {
    double f = 0.0;  ///< factor [1]

    static constexpr const char* name = "darcy_weisbach";
    static constexpr const char* is = "";
    static std::vector<laws::Key<DarcyWeisbach>> keys() {
        return {{&DarcyWeisbach::f, "darcy_f", "1", ranges::positive, "Darcy and Weisbach's factor"}};
    }
};

}  // namespace water_law

using WaterLaw = std::variant<water_law::None, water_law::Manning, water_law::DarcyWeisbach>;
using WaterLawMap = laws::LawMap<WaterLaw>;

/// Stress over density k |V| V: g n^2 / T^(1/3) of Manning (n in s/m^(1/3)), or f / 8 of Darcy and Weisbach
/// (f [1]). V is the velocity along the bed, T the thickness across it.
struct WaterFriction {
    enum class Law { none, manning, darcy_weisbach };
    Law law = Law::none;
    double coefficient = 0.0;  ///< n or f, >= 0
};

inline WaterFriction water_friction(const WaterLaw& law) {
    if (const auto* manning = std::get_if<water_law::Manning>(&law)) return {WaterFriction::Law::manning, manning->n};
    if (const auto* darcy = std::get_if<water_law::DarcyWeisbach>(&law))
        return {WaterFriction::Law::darcy_weisbach, darcy->f};
    return {};
}

/// Viscosity of free water in its flow, averaged over the depth (Pudasaini 2012, doi:10.1029/2011JF002186; van den Bout
/// et al. 2021, doi:10.5194/gmd-14-1841-2021, eqs. 29 and 30).
struct WaterViscosity {
    double kinematic = 0.0;  ///< nu = eta / density [m^2/s]; 0: the flow feels none
    double shear = 3.0;  ///< chi of the bed's stress over density, chi nu V / T: 3 for a parabola over the depth [1]
    bool solid_gradient =
        false;             ///< slip along a gradient of the solids' share is sheared as well (eq. 30's second term)
    double profile = 0.0;  ///< xi of that term: how solids are spread over the depth, 0 evenly, 3 as a parabola [1]
};

/// THEORY (11): the longest stable step under viscosity inside, on cells of a length [s]; infinite without. It is
/// explicit. A thin cell adjacent to deep ones has four faces twice as thick as itself, two with twice the viscosity.
/// So its rates are 24 nu / cell^2 at most, half that in water of one depth.
inline double viscous_step(const WaterViscosity& viscosity, double cell) {
    constexpr double kSafe = 0.9 * 2.0 / 24.0;
    return kSafe * cell * cell / viscosity.kinematic;
}

/// Where friction acts.
struct WaterBed {
    double gravity;    ///< g [m/s^2]
    double thickness;  ///< T, across the bed, > 0 [m]
    double kappa;      ///< |V| over the speed on the map, >= 1 [1]
};

/// THEORY (12): the deceleration on the map over the speed on the map squared [1/m].
inline double quadratic_drag(const WaterFriction& friction, const WaterBed& bed) {
    const double t = bed.thickness, c = friction.coefficient;
    if (friction.law == WaterFriction::Law::manning) return bed.gravity * c * c * bed.kappa / (t * std::cbrt(t));
    if (friction.law == WaterFriction::Law::darcy_weisbach) return c * bed.kappa / (8.0 * t);
    return 0.0;
}

/// The deceleration by viscosity at the bed over the speed, on the map as along the bed [1/s]. The flow is `thickness`
/// across the bed.
inline double linear_drag(const WaterViscosity& viscosity, double thickness) {
    return viscosity.shear * viscosity.kinematic / (thickness * thickness);
}

}  // namespace frana
