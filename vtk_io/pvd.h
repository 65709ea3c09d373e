#pragma once
// ParaView's collection file: a list of times and the file of each.
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "observe/archive.h"

namespace frana {

/// One line of a .pvd: a time [s] and the file that holds it, relative to the .pvd's folder.
struct PvdEntry {
    double time = 0.0;
    std::string file;
};

/// Writes a .pvd whole by atomic rename; times have all their digits. Throws UserError with path and reason.
void write_pvd(const std::filesystem::path& pvd, const std::vector<PvdEntry>& entries);

/// Reads a .pvd. Throws UserError when it is missing or not a .pvd.
std::vector<PvdEntry> read_pvd(const std::filesystem::path& pvd);

/// A series that grows while a run goes on. Each new file is listed at once, and a number given again replaces its
/// line. A .pvd that is opened meanwhile names only files that exist.
class PvdSeries {
public:
    /// `pvd` stands in the run directory; files are `stem`/`stem`_NNNNNN`extension` next to it.
    PvdSeries(std::filesystem::path pvd, std::string stem, std::string extension);
    /// Where the file of this frame goes; makes the folder. Throws UserError when that fails.
    std::filesystem::path file(std::int64_t number) const;
    /// Call after the file was written.
    void add(std::int64_t number, double time);
    /// Saves the list, or takes it up again: files of the series that are not on it are removed. Throws UserError
    /// when one on it is not there.
    void serialize(Archive& archive);

private:
    void take_back_others() const;
    std::string relative(std::int64_t number) const;
    std::filesystem::path pvd_;
    std::string stem_, extension_;
    std::vector<PvdEntry> entries_;
};

}  // namespace frana
