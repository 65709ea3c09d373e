#pragma once
#include <filesystem>

namespace frana {

/// One run at a time in a folder: holds DIR/.frana.lock while it lives. The system lets go of it when the process ends,
/// however it ends, so that a lock is never stale. Where the file system has no locks, there is none.
class RunLock {
public:
    /// Makes the folder. Throws UserError when another process holds the lock or the file cannot be made.
    explicit RunLock(const std::filesystem::path& run_dir);
    ~RunLock();
    RunLock(const RunLock&) = delete;
    RunLock& operator=(const RunLock&) = delete;

private:
    std::filesystem::path file_;
    int opened_ = -1;
};

/// Whether a process has a run going on in the folder now. False also where the file system has no locks.
bool is_run_going_on(const std::filesystem::path& run_dir);

}  // namespace frana
