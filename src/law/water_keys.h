#pragma once
// The keys of what particles and free water do to one another, and of the water's viscosity.
#include <vector>

#include "law/free_water.h"
#include "law/key.h"

namespace frana::laws {

inline std::vector<Key<TwoPhaseMaterial>> two_phase_keys() {
    return {{&TwoPhaseMaterial::fluid_density, "density", "kg/m^3", ranges::positive, "of the water, confined or free",
             Missing::usual},
            {&TwoPhaseMaterial::viscosity, "viscosity", "Pa s", ranges::positive,
             "of clear water; grains settle in it or in mud", Missing::usual},
            {&TwoPhaseMaterial::grain, "grain_diameter", "m", ranges::positive, "of grains, for their drag",
             Missing::usual},
            {&TwoPhaseMaterial::block, "block_diameter", "m", ranges::positive,
             "of blocks of what has structure, for their drag", Missing::usual}};
}

inline std::vector<Key<WaterExchange>> water_exchange_keys() {
    return {{&WaterExchange::pore_pressure, "pore_pressure", "1", ranges::fraction,
             "share of the pores' pressure that bears the particles on the bed where pores are full", Missing::usual},
            {&WaterExchange::void_ratio, "void_ratio", "1", ranges::positive,
             "free water over grains and their confined water that fills the pores", Missing::usual}};
}

inline std::vector<Key<WaterViscosity>> water_viscosity_keys() {
    return {{&WaterViscosity::shear, "bed_shear", "1", ranges::not_negative,
             "viscous stress at the bed over viscosity times speed over depth; 3: a parabola", Missing::usual},
            {&WaterViscosity::profile, "profile_factor", "1", ranges::not_negative,
             "xi of that term, of how grains are spread over the depth: 0 evenly, 3 as a parabola; left out where drag "
             "does not dominate it",
             Missing::usual}};
}

}  // namespace frana::laws
