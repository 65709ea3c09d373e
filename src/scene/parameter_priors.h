#pragma once
// Distributions of a key's values where only the kind of mass is known. An ensemble that gives no range takes them.
#include <optional>
#include <string>
#include <vector>

namespace frana {

struct ParameterPrior {
    const char* kind;  ///< word of case.kind
    const char* key;
    const char* law;  ///< word of material.bed.law that it belongs to; "": any
    enum class Shape { triangular, lognormal, uniform } shape;
    double a, b, c;  ///< lowest, most likely, highest; or median, factor, 0; or lowest, highest, 0
};

const std::vector<ParameterPrior>& parameter_priors();

/// Of a case key: its row of the table; otherwise uniform over the plausible range, if that has a width.
std::optional<ParameterPrior> prior_of(const std::string& kind, const std::string& key, const std::string& law);

/// "triangular, 0.05 to 0.3, most likely 0.12"; `unit` follows the values, with a space before it.
std::string words_of(const ParameterPrior& prior, const std::string& unit);

}  // namespace frana
