#pragma once
// Pictures as PNG files.
#include <filesystem>

#include "vtk_io/figures/pixels.h"

namespace frana {

/// Writes the picture whole or not at all. Several threads may write at the same time. UserError when the file cannot be
/// written.
void write_png(const Pixels& picture, const std::filesystem::path& png);

/// The pixels of a PNG file with 8 bits a channel, alpha dropped. UserError when it cannot be read.
Pixels read_png(const std::filesystem::path& png);

}  // namespace frana
