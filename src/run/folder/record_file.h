#pragma once
// What is read back of a record: run.json, converge.json, ...
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/types.h"

namespace frana {

/// The JSON of a file; discarded, and so no object, where there is none or where it is none.
nlohmann::ordered_json json_in(const std::filesystem::path& file);

/// Whether a record has a list of the files that were made.
bool lists_files(const nlohmann::ordered_json& record);

/// Where what came in by inflows or later began to flow, by a run.json. For a run without material at the start.
std::vector<Vec2> starts_in(const nlohmann::ordered_json& record);

}  // namespace frana
