#include "ensemble/vary_words.h"

#include <fmt/core.h>

#include <cmath>

#include "base/number_text.h"
#include "scene/parameters.h"

namespace frana {
namespace {

using Form = Distribution::Kind;

/// Of a normal or lognormal one; "" where it has none.
std::string cut_of(const Distribution& of, const std::string& unit) {
    const bool below = std::isfinite(of.low) && !(of.kind == Form::lognormal && of.low == 0.0);
    if (below && std::isfinite(of.high)) return fmt::format(", cut to {:g} to {:g}{}", of.low, of.high, unit);
    if (below) return fmt::format(", cut below {:g}{}", of.low, unit);
    return std::isfinite(of.high) ? fmt::format(", cut above {:g}{}", of.high, unit) : "";
}

std::string choices_of(const Vary& vary, const std::string& unit) {
    std::string text = "discrete";
    for (std::size_t k = 0; k < vary.distribution.values.size(); ++k) {
        text += fmt::format(", {}{} with weight {:g}", vary.distribution.values[k], unit, vary.distribution.weights[k]);
        if (!vary.return_periods.empty()) text += fmt::format(" ({:g} years)", vary.return_periods[k]);
    }
    return text;
}

std::string shape_of(const Vary& vary, const std::string& unit) {
    const Distribution& of = vary.distribution;
    const std::string range = fmt::format("{:g} to {:g}{}", of.low, of.high, unit);
    switch (of.kind) {
        case Form::uniform:
            return "uniform, " + range;
        case Form::loguniform:
            return "loguniform, " + range;
        case Form::normal:
            return fmt::format("normal, mean {0:g}{2}, standard deviation {1:g}{2}", of.middle, of.spread, unit) +
                   cut_of(of, unit);
        case Form::lognormal:
            return fmt::format("lognormal, median {:g}{}, factor {:g}", of.middle, unit, of.spread) + cut_of(of, unit);
        case Form::triangular:
            return fmt::format("triangular, {}, most likely {:g}{}", range, of.middle, unit);
        case Form::beta:
            return fmt::format("beta, {}, alpha {:g}, beta {:g}", range, of.alpha, of.beta);
        case Form::discrete:
            return choices_of(vary, unit);
    }
    return "";
}

}  // namespace

std::string words_of(const Vary& vary) {
    const Parameter* parameter = find_parameter(vary.key);
    const std::string words = shape_of(vary, parameter ? after_number(parameter->unit) : "");
    const bool levels = vary.levels > 0 && vary.distribution.kind != Form::discrete;
    return levels ? fmt::format("{}, on {} levels", words, vary.levels) : words;
}

}  // namespace frana
