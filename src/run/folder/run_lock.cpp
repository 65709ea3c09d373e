#include "run/folder/run_lock.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "base/error.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

/// Whether the file that was opened still has its name; the run that ended may have removed it in between.
bool has_its_name(int opened, const fs::path& file) {
    struct stat here {
    }, there{};
    return ::fstat(opened, &here) == 0 && ::stat(file.c_str(), &there) == 0 && here.st_ino == there.st_ino;
}

std::string holder(const fs::path& file) {
    std::string process;
    std::ifstream(file) >> process;
    return process.empty() ? "another process" : "process " + process;
}

}  // namespace

RunLock::RunLock(const fs::path& run_dir) : file_(run_dir / ".frana.lock") {
    std::error_code ignored;
    fs::create_directories(run_dir, ignored);  // prepare_run_folder says what is wrong
    for (int attempt = 0; attempt < 100; ++attempt) {
        opened_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
        if (opened_ < 0 && errno == ELOOP)
            throw UserError(
                fmt::format("{}: found a link; expected the lock of a run, whose content is replaced; "
                            "remove the link, or choose another folder with --out",
                            file_.string()));
        if (opened_ < 0) return;  // the same
        const bool locked = ::flock(opened_, LOCK_EX | LOCK_NB) == 0;
        const bool busy = !locked && errno == EWOULDBLOCK;
        if (!busy && has_its_name(opened_, file_)) break;
        ::close(opened_);
        opened_ = -1;
        if (busy)
            throw UserError(
                fmt::format("{}: found a run of {} that is still going on there; expected a folder of its "
                            "own; wait for its end, or choose another folder with --out",
                            run_dir.string(), holder(file_)));
    }
    if (opened_ < 0) return;
    const std::string process = fmt::format("{}\n", ::getpid());
    if (::ftruncate(opened_, 0) != 0 || ::write(opened_, process.data(), process.size()) < 0)
        return;  // only the other's message would be poorer
}

RunLock::~RunLock() {
    if (opened_ < 0) return;
    ::unlink(file_.c_str());
    ::close(opened_);
}

bool is_run_going_on(const fs::path& run_dir) {
    const int opened = ::open((run_dir / ".frana.lock").c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
    if (opened < 0) return false;
    const bool held = ::flock(opened, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    ::close(opened);
    return held;
}

}  // namespace frana
