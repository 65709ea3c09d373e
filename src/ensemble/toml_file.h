#pragma once
// TOML files of this room.
#include <toml++/toml.h>

#include <filesystem>
#include <functional>
#include <string>

#include "scene/problems.h"

namespace frana {

/// Its first line there.
inline int line_in(const toml::node& node) { return static_cast<int>(node.source().begin.line); }

/// Throws UserError when it cannot be read.
std::string text_of_file(const std::filesystem::path& file);

/// Passes the root table to `read`; what is no TOML is a problem.
void read_toml(const std::string& text, const std::filesystem::path& file, Problems& problems,
               const std::function<void(const toml::table&)>& read);

}  // namespace frana
