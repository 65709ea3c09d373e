#include "frana_export.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>

#include "base/error.h"
#include "io/hdf5_points.h"
#include "vtk_io/points_vtp.h"

namespace frana {

std::string export_format(const std::filesystem::path& file, const std::vector<std::string>& more) {
    std::string extension = file.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (extension == ".hdf5") extension = ".h5";
    std::vector<std::string> known{".h5", ".json", ".csv", ".vtp"};
    known.insert(known.end(), more.begin(), more.end());
    if (std::find(known.begin(), known.end(), extension) != known.end()) return extension;
    std::string listed;
    for (const std::string& one : known) listed += (listed.empty() ? "" : one == known.back() ? " or " : ", ") + one;
    throw UserError(
        fmt::format("--out {}: found the extension \"{}\"; expected {}; name the file after the format you "
                    "want",
                    file.string(), file.extension().string(), listed));
}

void make_folder_of(const std::filesystem::path& file) {
    if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path());
}

void write_points(const std::filesystem::path& file, const std::string& format, const PointTable& table,
                  const double* places) {
    make_folder_of(file);
    if (format == ".h5") return write_points_hdf5(file, table);
    if (format == ".json") return write_points_json(file, table);
    if (format == ".csv") return write_points_csv(file, table);
    write_points_vtp(file, table, places);
}

}  // namespace frana
