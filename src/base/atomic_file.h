#pragma once
// Files appear whole or not at all: write under another name, then rename.
#include <cstdint>
#include <filesystem>
#include <string>

namespace frana {

/// A name next to `target` to write to; `commit()` renames it over the target, otherwise it is removed. Keeps the
/// target's extension, since some writers choose the format by it. Not thread safe.
class AtomicFile {
public:
    explicit AtomicFile(std::filesystem::path target);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;
    const std::filesystem::path& path() const { return temporary_; }
    /// Throws UserError when the rename fails (disk, permissions).
    void commit();
    /// The same, and the bytes are on the disk before the name is. A power cut leaves the old file or the new one.
    void commit_to_disk();

private:
    std::filesystem::path target_;
    std::filesystem::path temporary_;
    bool committed_ = false;
};

/// Has the system write a file's (or a folder's) bytes to the disk now. Throws UserError.
void flush_to_disk(const std::filesystem::path& file);

/// Takes back what was appended to a file since it was `bytes` long. Throws UserError when it is shorter or not there.
void cut_back(const std::filesystem::path& file, std::uintmax_t bytes);

/// Writes text to `target` through an AtomicFile. Throws UserError with path and reason.
void write_text(const std::filesystem::path& target, const std::string& text);

}  // namespace frana
