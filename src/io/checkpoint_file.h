#pragma once
// The state of a run in an HDF5 file. 512 bytes before HDF5's own hold the file's length and checksum as text. So a
// file that was cut short or damaged is found before HDF5 opens it. Arrays lie under the names that the archive gives
// them, the labels (version, case, ...) in the group "labels".
#include <filesystem>
#include <functional>
#include <map>
#include <string>

#include "observe/archive.h"

namespace frana {

/// First line of a checkpoint. A state with other numbers has another one.
constexpr const char* kCheckpointFormat = "frana checkpoint 6";

/// What says where a state is from: texts by name.
using CheckpointLabels = std::map<std::string, std::string>;

/// Writes what `state` puts into the archive (called twice: once for its size). The file appears whole and on the
/// disk, or the earlier one stays. Returns its size [bytes]. Throws UserError with path and reason.
std::uintmax_t write_checkpoint(const std::filesystem::path& file, const CheckpointLabels& labels,
                                const std::function<void(Archive&)>& state);

/// An opened checkpoint, whole and undamaged. Throws UserError with path and reason when it is not.
class CheckpointFile {
public:
    explicit CheckpointFile(const std::filesystem::path& file);
    const CheckpointLabels& labels() const { return labels_; }
    /// Passes the arrays to `state`.
    void load(const std::function<void(Archive&)>& state) const;

private:
    std::filesystem::path file_;
    CheckpointLabels labels_;
};

}  // namespace frana
