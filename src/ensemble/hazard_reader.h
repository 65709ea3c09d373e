#pragma once
// Reads [ensemble.hazard].
#include "ensemble/checked_table.h"
#include "ensemble/hazard.h"

namespace frana {

/// `fields`: those stored of the runs; `scenarios`: the samples have return periods. What is wrong goes to `problems`.
HazardTable read_hazard(const toml::table& table, const std::filesystem::path& file,
                        const std::vector<std::string>& fields, bool scenarios, Problems& problems);

}  // namespace frana
