#pragma once
// TOML nodes to checked values. Private to the case reader: no other file of the project sees toml++.
#include <toml++/toml.h>
#include <optional>
#include <string>

#include "scene/parameters.h"
#include "scene/problems.h"

namespace frana {

/// What stands in the file, for messages: `the text "5 m"`, `-3`, `a list of 2 values`, `a date`.
std::string found_text(const toml::node& node);

/// The value of a key in its parameter's unit and range. Nothing when it is not; the reason is then in `problems` under
/// `place` ("case.toml:12: grid.cell"), ordered by `line`.
std::optional<Value> convert(const toml::node& node, const Parameter& parameter, int line, const std::string& place,
                             Problems& problems);

}  // namespace frana
