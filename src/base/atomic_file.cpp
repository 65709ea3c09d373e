#include "base/atomic_file.h"

#include <fmt/core.h>
#include <unistd.h>

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

void write_text(const std::filesystem::path& target, const std::string& text) {
    AtomicFile file(target);
    {
        std::ofstream stream(file.path(), std::ios::binary);
        stream << text;
        stream.flush();
        if (!stream)
            throw UserError(fmt::format("{}: cannot be written; check that the folder exists, its permissions and "
                                        "free space",
                                        target.string()));
    }
    file.commit();
}

}  // namespace frana
