#pragma once
// The folder of a run: which files frana writes there, and which are there now. Also how to make room for new ones.
#include <filesystem>
#include <functional>
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

/// The run's files that are in the folder now, in the order of product_kinds(), names sorted. A file is the run's
/// when its run.json lists it. While the run goes on, a file that has come or changed since it began is too.
std::vector<Product> products_in(const std::filesystem::path& run_dir);

/// The files behind these, with the folder's name.
std::vector<std::filesystem::path> product_files(const std::filesystem::path& run_dir);

/// The same relative to the folder, sorted, with report.md and run.json: what run.json lists as "files".
std::vector<std::string> files_made(const std::filesystem::path& run_dir);

/// Whether a run may take the place of an earlier one.
enum class Overwrite { no, yes };

/// Refuses a folder where a run would replace files. These are files of an earlier run (unless `overwrite`), and files
/// that the case itself reads. So are files that no run left there but whose names each run writes. Touches nothing.
/// `inputs` begins with the case file. Throws UserError.
void require_room_for_run(const std::filesystem::path& run_dir, const std::vector<std::filesystem::path>& inputs,
                          Overwrite overwrite);

/// Refuses a folder where `what` ("an ensemble") would replace files: those of these names, or in folders of these
/// names. If `what` has begun to work there, as its own file `mark` shows, the folder is not refused. Throws UserError.
void require_no_others(const std::filesystem::path& dir, const std::string& mark, const std::vector<std::string>& names,
                       const std::string& what);

/// Refuses to write over a file that is read: `option` names the file to write. Inputs may name a layer. Throws UserError.
void require_no_input(const std::string& option, const std::filesystem::path& out,
                      const std::vector<std::filesystem::path>& inputs);

/// Creates the folder and removes the files of an earlier run, which are those that its run.json lists. Everything
/// else stays. Throws UserError as above, and when the folder is a file, cannot be made or cannot be written to.
void prepare_run_folder(const std::filesystem::path& run_dir, const std::vector<std::filesystem::path>& inputs = {},
                        Overwrite overwrite = Overwrite::no);

/// What run.json says of a run that goes on, and of one that broke off before it could write its end.
inline constexpr char kRunning[] = "running", kStopped[] = "stopped";

/// While it lives, run.json may say that the run goes on. Afterwards it does not. The word is replaced in place, since a
/// full disk takes no new file.
class OpenRecord {
public:
    explicit OpenRecord(std::filesystem::path run_dir) : run_dir_(std::move(run_dir)) {}
    ~OpenRecord();
    OpenRecord(const OpenRecord&) = delete;
    OpenRecord& operator=(const OpenRecord&) = delete;

private:
    std::filesystem::path run_dir_;
};

/// Removes what a run leaves at its end (report, rasters, figures, ...) and half-written files of a run that was
/// killed. Series and tables stay, for the run to go on with. Throws UserError as above.
void clear_for_resume(const std::filesystem::path& run_dir);

/// Removes what a process was writing when it was cut off: half-written files and the pictures of unfinished films.
void remove_half_written(const std::filesystem::path& run_dir);

/// To call once work on the folder of a finished run is done. Adds what has come since to the list in its run.json. A
/// run.json without such a list is left as it is.
std::function<void()> adding_to_files(const std::filesystem::path& run_dir);

/// Does `work`, then that.
void add_to_files(const std::filesystem::path& run_dir, const std::function<void()>& work);

}  // namespace frana
