#pragma once
// How a law names the keys of its parameters in a case.
#include "base/range.h"

namespace frana::laws {

/// What a case that does not give a key means.
enum class Missing {
    refused,  ///< the law needs it, or the key that stands in its place
    usual,    ///< the parameter has the value that its struct gives it, which is the key's default
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
    const char* instead_of = "";                                     ///< key of the same parameter in other terms
    double (*convert)(double) = [](double value) { return value; };  ///< value of the key to parameter
    const char* more_than = "";                                      ///< key of the same law that must be smaller
    const char* way_out = "";                                        ///< what to do where it is not
};

}  // namespace frana::laws
