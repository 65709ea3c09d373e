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

/// A stretch of a file [bytes].
struct FileExtent {
    Index offset = 0, bytes = 0;
};

/// Appends the frame as a group (layout: xdmf_writer.h) and closes the file. The first call with `fresh` replaces
/// whatever stood at `file`. A group of the same number is replaced. `outside` as in observe/file_arrays.h. Returns
/// where the arrays lie: later frames leave those bytes alone. Throws UserError with path and reason when HDF5 cannot
/// write.
std::vector<FileExtent> append_frame(const std::filesystem::path& file, bool fresh, const Frame& frame,
                                     const std::vector<std::uint8_t>& outside);

/// All bytes of a file outside `arrays`: HDF5's own tables, which change in place as the file grows. UserError when it
/// cannot be read.
std::vector<std::uint8_t> tables_of(const std::filesystem::path& file, std::vector<FileExtent> arrays);

/// Makes a file what it was when it was `bytes` long and tables_of() gave `tables`, whatever became of it since.
/// UserError when it is shorter or cannot be written.
void put_tables_back(const std::filesystem::path& file, Index bytes, std::vector<FileExtent> arrays,
                     const std::vector<std::uint8_t>& tables);

}  // namespace frana
