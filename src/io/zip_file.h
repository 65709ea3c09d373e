#pragma once
#include <filesystem>
#include <string>

namespace frana {

/// An archive of one file of text, the same bytes for the same text. It appears whole or not at all. UserError when it
/// cannot be written.
void write_zip(const std::filesystem::path& archive, const std::string& name, const std::string& text);

}  // namespace frana
