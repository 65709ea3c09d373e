#pragma once
// What a raster says of its values.
#include <filesystem>
#include <string>
#include <utility>

namespace frana {

/// Unit and description of a raster's band, each maybe empty. UserError: no raster.
std::pair<std::string, std::string> band_words(const std::filesystem::path& file);

}  // namespace frana
