#pragma once
// Keys of [[stage]] that several 3D laws have, and how a law is made of the values of its keys.
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "law/key.h"

namespace frana::solid {

using laws::Missing;

/// A key of a law. A law holds moduli that several keys give, so that a key sets no member by itself. A key that several
/// laws have is one, the same for all of them.
struct Key {
    const char* name;
    const char* unit;
    Range range;
    const char* meaning;
    Missing missing = Missing::refused;
    double usual = 0.0;                     ///< the default, with Missing::usual
    const char* absent = "";                ///< what its absence means, with Missing::none
    std::vector<std::string> choices = {};  ///< it is a word, one of these; the first is the default
};

/// The value of a key that is given or has a default. Of a word: its place among the choices.
using Values = std::function<std::optional<double>(const std::string& key)>;

inline Key viscosity() {
    return {"viscosity",   "Pa s", ranges::not_negative, "viscosity of a fluid, or of bingham",
            Missing::none, 0.0,    "the rheology's"};
}

inline Key yield_stress() {
    return {"yield_stress", "Pa", ranges::positive, "yield stress of bingham or herschel_bulkley in shear",
            Missing::none,  0.0,  "the rheology's"};
}

inline Key shear_modulus() {
    return {"shear_modulus", "Pa", ranges::positive,          "stiffness of both below their yield stress",
            Missing::none,   0.0,  "a hundred yield stresses"};
}

inline Key sound_speed() {
    return {"sound_speed",
            "m/s",
            ranges::positive,
            "artificial speed of sound of fluids, with a yield stress or without, and of sand or grains where no "
            "law is named: the density changes by about (speed / sound_speed)^2",
            Missing::none,
            0.0,
            "ten times the larger of the fastest speed and sqrt(2 g depth) when the stage begins"};
}

inline Key young_modulus() {
    return {
        "young_modulus", "Pa", ranges::positive,
        "stiffness of drucker_prager, mu_i or elastic; the stiffer, the more steps: about 100 density gravity depth is "
        "enough"};
}

inline Key poisson_ratio() {
    return {"poisson_ratio",         "1",
            {0.0, 0.5, false, true}, "share of a strain that shows across it, of drucker_prager, mu_i or elastic",
            Missing::usual,          0.3};
}

}  // namespace frana::solid
