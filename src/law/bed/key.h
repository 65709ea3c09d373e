#pragma once
// How a bed law names the keys of its parameters, under [material.bed] of a case.
#include <cmath>

#include "base/range.h"

namespace frana::bed {

/// What a case that does not give a key means.
enum class Missing {
    refused,  ///< the law needs it, or the key that stands in its place
    usual,    ///< the parameter keeps the value that its struct gives it, which is the key's default
    none      ///< likewise, but the term is left out rather than has a default
};

/// A key of a law, and the parameter that it sets. A key that several laws have is one, the same for all of them.
template <class Law>
struct Key {
    double Law::*parameter;
    const char* name;
    const char* unit;
    Range range;
    const char* meaning;
    Missing missing = Missing::refused;
    const char* instead_of = "";  ///< key of the same parameter in other terms
    double (*convert)(double) = [](double value) { return value; };  ///< value of the key to parameter
    const char* more_than = "";   ///< key of the same law that must be smaller
    const char* way_out = "";     ///< what to do where it is not
};

/// The friction coefficient, by its angle; beside friction().
template <class Law>
Key<Law> friction_angle(double Law::*mu, Missing missing = Missing::refused) {
    return {mu, "friction_angle_deg", "degree", {0.0, 90.0, false, true}, "friction angle at the bed", missing, "mu",
            [](double degrees) { return std::tan(degrees * 3.14159265358979323846 / 180.0); }};
}

/// The friction coefficient; beside friction_angle().
template <class Law>
Key<Law> friction(double Law::*mu, Missing missing = Missing::refused) {
    return {mu, "mu", "1", ranges::between(0.0, 10.0), "friction coefficient at the bed, the tangent of the friction angle",
            missing, "friction_angle_deg"};
}

}  // namespace frana::bed
