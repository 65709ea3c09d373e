#pragma once
// How likely values of a key are where nothing but the kind of mass is known: what an ensemble takes that gives no range.
#include <optional>
#include <string>
#include <vector>

#include "scene/parameter_ranges.h"

namespace frana {

struct ParameterPrior {
    const char* kind;  ///< word of case.kind
    const char* key;
    const char* law;  ///< word of material.bed.law that it belongs to; "": any
    enum class Shape { triangular, lognormal, uniform } shape;
    double a, b, c;  ///< lowest, most likely, highest; or median, factor, 0; or lowest, highest, 0
};

inline const std::vector<ParameterPrior>& parameter_priors() {
    using Of = ParameterPrior::Shape;
    static const std::vector<ParameterPrior> table = {
        {"debris_flow", "material.bed.mu", "voellmy", Of::triangular, 0.05, 0.12, 0.30},
        {"debris_flow", "material.bed.xi", "voellmy", Of::lognormal, 300.0, 1.8, 0.0},
        {"rock_avalanche", "material.bed.mu", "voellmy", Of::triangular, 0.05, 0.12, 0.35},
        {"rock_avalanche", "material.bed.xi", "voellmy", Of::lognormal, 500.0, 1.8, 0.0},
        {"mud", "material.rheology.yield_stress", "", Of::lognormal, 300.0, 3.0, 0.0},
        {"mud", "material.rheology.viscosity", "", Of::lognormal, 50.0, 3.0, 0.0},
    };
    return table;
}

/// Of a case key: its row of the table; otherwise uniform over the plausible range, if that has a width.
inline std::optional<ParameterPrior> prior_of(const std::string& kind, const std::string& key, const std::string& law) {
    const RangeKey known = range_key(key);
    const bool same = known.scale(1.0) == 1.0;  // an angle has no row of its own
    for (const ParameterPrior& row : parameter_priors())
        if (same && row.kind == kind && row.key == known.key && (!*row.law || row.law == law)) return row;
    const std::optional<Plausible> range = plausible(kind, known.key, law);
    if (!range || !(range->low < range->high)) return {};
    return ParameterPrior{"", "", "", ParameterPrior::Shape::uniform, known.scale(range->low), known.scale(range->high),
                          0.0};
}

}  // namespace frana
