#pragma once
// Reads what varies: [[ensemble.vary]], [[calibrate.vary]].
#include "ensemble/checked_table.h"
#include "ensemble/plan.h"

namespace frana {

/// How the file of the tables is used; what is wrong goes to `problems`.
struct VaryContext {
    const std::filesystem::path& file;
    Method method = Method::sobol;
    std::string method_name = "sobol";
    std::string kind = {};     ///< case.kind of the case, whose priors a key without a range has; "": none
    std::string bed_law = {};  ///< material.bed.law of the case
};

/// What is wrong with a key that is to vary; nothing: empty.
struct KeyProblem {
    std::string found, expected, way_out;
};
KeyProblem problem_of_key(const std::string& key, const std::vector<Vary>& before);

/// Reads all tables of `array`, named "ensemble.vary.0" and so on.
std::vector<Vary> read_varied_keys(const toml::array& array, const std::string& name, const VaryContext& context,
                                   Problems& problems);

}  // namespace frana
