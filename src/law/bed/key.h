#pragma once
// Keys that several bed laws have, under [material.bed] of a case.
#include <cmath>

#include "base/constants.h"
#include "law/key.h"

namespace frana::bed {

using laws::Key;
using laws::Missing;

/// The friction coefficient, by its angle; an alternative to friction().
template <class Law>
Key<Law> friction_angle(double Law::*mu, Missing missing = Missing::refused) {
    return {mu,
            "friction_angle_deg",
            "degree",
            {0.0, 90.0, false, true},
            "friction angle at the bed",
            missing,
            "mu",
            [](double degrees) { return std::tan(degrees * constants::kPi / 180.0); }};
}

/// The friction coefficient; an alternative to friction_angle().
template <class Law>
Key<Law> friction(double Law::*mu, Missing missing = Missing::refused) {
    return {mu,
            "mu",
            "1",
            ranges::between(0.0, 10.0),
            "friction coefficient at the bed, the tangent of the friction angle",
            missing,
            "friction_angle_deg"};
}

}  // namespace frana::bed
