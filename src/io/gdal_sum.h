#pragma once
#include <filesystem>
#include <string>

namespace frana {

/// A sum of what a file holds, for seeing that it has changed, as 16 hexadecimal digits. What GDAL reads along with it
/// counts (the parts of a shapefile, the sources of a VRT, a world file). Statistics and overviews do not, which
/// programs that only read a file leave next to it. "missing" where there is none.
std::string sum_of_input(const std::filesystem::path& file);

}  // namespace frana
