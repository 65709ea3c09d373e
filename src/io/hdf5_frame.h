#pragma once
// Frames into an HDF5 file. Includes HDF5: only for .cpp files of this room.
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "observe/frame.h"

namespace frana {

/// Name of a frame's group in the file.
std::string frame_group(Index number);

/// Appends the frame as a group (layout: xdmf_writer.h) and closes the file; the first call with `fresh`
/// replaces whatever stood at `file`. A group of the same number is replaced. `outside` as in
/// observe/file_columns.h. Throws UserError with path and reason when HDF5 cannot write.
void append_frame(const std::filesystem::path& file, bool fresh, const Frame& frame,
                  const std::vector<std::uint8_t>& outside);

}  // namespace frana
