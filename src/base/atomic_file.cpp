#include "base/atomic_file.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "base/error.h"

namespace frana {

AtomicFile::AtomicFile(std::filesystem::path target) : target_(std::move(target)) {
    temporary_ = target_.parent_path() /
                 fmt::format(".{}.tmp{}{}", target_.stem().string(), ::getpid(), target_.extension().string());
}

AtomicFile::~AtomicFile() {
    std::error_code ignored;
    if (!committed_) std::filesystem::remove(temporary_, ignored);
}

void AtomicFile::commit() {
    std::error_code failure;
    std::filesystem::rename(temporary_, target_, failure);
    if (failure)
        throw UserError(fmt::format("{}: cannot be written: {}; check the folder's permissions and free space",
                                    target_.string(), failure.message()));
    committed_ = true;
}

void AtomicFile::commit_to_disk() {
    flush_to_disk(temporary_);
    commit();
    flush_to_disk(target_.parent_path().empty() ? "." : target_.parent_path());
}

void flush_to_disk(const std::filesystem::path& file) {
    const int opened = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
    const bool done = opened >= 0 && (::fsync(opened) == 0 || errno == EINVAL);  // EINVAL: nothing to flush there
    const int reason = errno;
    if (opened >= 0) ::close(opened);
    if (!done)
        throw UserError(fmt::format("{}: cannot be written to the disk: {}; check the disk and its free space",
                                    file.string(), std::strerror(reason)));
}

void cut_back(const std::filesystem::path& file, std::uintmax_t bytes) {
    std::error_code failure;
    const std::uintmax_t found = std::filesystem::file_size(file, failure);
    if (failure)
        throw UserError(
            fmt::format("{}: cannot be continued: {}; put it back, or run with --overwrite instead of --resume",
                        file.string(), failure.message()));
    if (found < bytes)
        throw UserError(
            fmt::format("{}: found {} bytes; expected at least the {} that it had when the state was saved; "
                        "put it back, or run with --overwrite instead of --resume",
                        file.string(), found, bytes));
    std::filesystem::resize_file(file, bytes, failure);
    if (failure)
        throw UserError(fmt::format("{}: cannot be cut back to {} bytes: {}; check the file's permissions",
                                    file.string(), bytes, failure.message()));
}

void write_text(const std::filesystem::path& target, const std::string& text) {
    AtomicFile file(target);
    {
        std::ofstream stream(file.path(), std::ios::binary);
        // In pieces: Linux may take single writes of more than 2 MB at a tenth of the speed. That is so when it finds
        // no large pages free for its cache.
        constexpr std::size_t kPiece = std::size_t{1} << 20;
        for (std::size_t at = 0; at < text.size() && stream; at += kPiece)
            stream.write(text.data() + at, static_cast<std::streamsize>(std::min(kPiece, text.size() - at)));
        stream.flush();
        if (!stream)
            throw UserError(
                fmt::format("{}: cannot be written; check that the folder exists, its permissions and "
                            "free space",
                            target.string()));
    }
    file.commit();
}

}  // namespace frana
