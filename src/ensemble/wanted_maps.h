#pragma once
// Which maps to make of a case, from a table that says nothing of its runs: [predict].
#include <toml++/toml.h>

#include "ensemble/plan.h"
#include "scene/problems.h"

namespace frana {

/// Reads case, fields, exceed and quantiles of the table of that name; `plan` has the file. Samples are for others to give.
void read_wanted_maps(const toml::table& of, const std::string& name, EnsemblePlan& plan, Problems& problems);

/// An ensemble's file with these wishes, whose samples stand in a table.
std::string ensemble_of_table(const EnsemblePlan& plan, const std::filesystem::path& table);

}  // namespace frana
