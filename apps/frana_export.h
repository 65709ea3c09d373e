#pragma once
// What the commands that export points have in common.
#include <filesystem>
#include <string>
#include <vector>

#include "base/point_table.h"

namespace frana {

/// The format that a file name gives: ".h5", ".json", ".csv", ".vtp" or one of `more`. It is clear before any work is
/// done. UserError for another extension.
std::string export_format(const std::filesystem::path& file, const std::vector<std::string>& more = {});

/// Writes the table in one of the four formats, making the file's folder. `places` holds x, y, z per point [m], for
/// VTK. UserError when the file cannot be written.
void write_points(const std::filesystem::path& file, const std::string& format, const PointTable& table,
                  const double* places);

/// Makes the folder of a file that is to be written.
void make_folder_of(const std::filesystem::path& file);

}  // namespace frana
