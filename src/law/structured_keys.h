#pragma once
// The keys of a structured solid's law.
#include <vector>

#include "base/constants.h"
#include "law/key.h"
#include "law/structured_law.h"

namespace frana::laws {

inline std::vector<Key<StructuredMaterial>> structured_keys() {
    const auto degrees = [](double angle) { return angle * constants::kDegree; };
    return {{&StructuredMaterial::friction, "friction_angle_deg", "degree", Range{0.0, 90.0, true, true},
             "internal friction angle of the structure, and of the grains it falls to; at most 60 where their "
             "pressure is by Rankine's coefficients",
             Missing::refused, "", degrees},
            {&StructuredMaterial::dilatancy, "dilatancy_angle_deg", "degree", Range{0.0, 90.0, false, true},
             "angle by which yielding makes room", Missing::usual, "", degrees},
            {&StructuredMaterial::young, "young_modulus", "Pa", ranges::positive,
             "stiffness; the stiffer, the more steps: twenty times the strength is enough"},
            {&StructuredMaterial::poisson, "poisson_ratio", "1", Range{0.0, 0.5, true, true},
             "share of a strain that shows across it", Missing::usual, "bulk_modulus"},
            {&StructuredMaterial::critical_strain, "critical_strain", "1", ranges::positive,
             "that strain at which no bond is left", Missing::usual},
            {&StructuredMaterial::onset, "onset", "1", ranges::not_negative,
             "strain before which damage = \"strain\" breaks nothing", Missing::usual}};
}

}  // namespace frana::laws
