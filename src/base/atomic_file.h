#pragma once
// Files appear whole or not at all: write beside, then rename.
#include <filesystem>
#include <string>

namespace frana {

/// A name beside `target` to write to; `commit()` renames it over the target, otherwise it is removed.
/// Keeps the target's extension, since some writers choose the format by it. Not thread safe.
class AtomicFile {
public:
    explicit AtomicFile(std::filesystem::path target);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;
    const std::filesystem::path& path() const { return temporary_; }
    /// Throws UserError when the rename fails (disk, permissions).
    void commit();

private:
    std::filesystem::path target_;
    std::filesystem::path temporary_;
    bool committed_ = false;
};

/// Writes text to `target` through an AtomicFile. Throws UserError with path and reason.
void write_text(const std::filesystem::path& target, const std::string& text);

}  // namespace frana
