#pragma once
// The folder of a run: which files frana writes there, which are there now, and how to make room for new
// ones.
#include <filesystem>
#include <string>
#include <vector>

namespace frana {

/// A kind of file that frana leaves in a run folder.
struct ProductKind {
    std::string folder;   ///< relative to the run folder, empty for the run folder itself
    std::string pattern;  ///< ECMAScript regular expression of the whole file name
    std::string meaning;  ///< for people
    bool one_of_many;     ///< a frame: named by its folder and number in listings
};

const std::vector<ProductKind>& product_kinds();

/// A file (or a series of frames) that is there.
struct Product {
    std::string path;  ///< relative to the run folder: "rasters/peak_depth.tif", "particles/" for a series
    std::string meaning;
    std::size_t files = 1;
};

/// What frana's files there are in the folder now, in the order of product_kinds(), names sorted.
std::vector<Product> products_in(const std::filesystem::path& run_dir);

/// The files behind these, with the folder's name.
std::vector<std::filesystem::path> product_files(const std::filesystem::path& run_dir);

/// Creates the folder and removes the files of an earlier run. Files that frana does not write stay. Throws
/// UserError when the folder is a file, cannot be made or cannot be written to.
void prepare_run_folder(const std::filesystem::path& run_dir);

/// Removes what a run leaves at its end (report, rasters, figures, ...) and half-written files of a run that was
/// killed; series and tables stay, for the run to go on with. Throws UserError as above.
void clear_for_resume(const std::filesystem::path& run_dir);

}  // namespace frana
