#include "scene/parameter_priors.h"

#include <fmt/core.h>

#include "scene/parameter_ranges.h"

namespace frana {

const std::vector<ParameterPrior>& parameter_priors() {
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

std::optional<ParameterPrior> prior_of(const std::string& kind, const std::string& key, const std::string& law) {
    const RangeKey known = range_key(key);
    const bool same = known.scale(1.0) == 1.0;  // an angle has no row of its own
    for (const ParameterPrior& row : parameter_priors())
        if (same && row.kind == kind && row.key == known.key && (!*row.law || row.law == law)) return row;
    const std::optional<Plausible> range = plausible(kind, known.key, law);
    if (!range || !(range->low < range->high)) return {};
    return ParameterPrior{"", "", "", ParameterPrior::Shape::uniform, known.scale(range->low), known.scale(range->high),
                          0.0};
}

std::string words_of(const ParameterPrior& prior, const std::string& unit) {
    switch (prior.shape) {
        case ParameterPrior::Shape::triangular:
            return fmt::format("triangular, {:g} to {:g}{}, most likely {:g}", prior.a, prior.c, unit, prior.b);
        case ParameterPrior::Shape::lognormal:
            return fmt::format("lognormal, median {:g}{}, factor {:g}", prior.a, unit, prior.b);
        case ParameterPrior::Shape::uniform:
            break;
    }
    return fmt::format("uniform, {:.4g} to {:.4g}{}", prior.a, prior.b, unit);
}

}  // namespace frana
