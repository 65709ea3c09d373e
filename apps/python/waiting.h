#pragma once
// Threads that wait for a run at Python's exit. One that takes the interpreter's lock after that is ended in the midst
// of C++, which aborts the process.
namespace frana {

/// While one lives, a thread of Python waits for work of ours, or calls back. To be made with the interpreter's lock.
/// Once Python has ended, a daemon thread that waits for one sleeps for good without the lock. There is nothing that it
/// could go back to.
class Waiting {
public:
    Waiting();
    ~Waiting();
    Waiting(const Waiting&) = delete;
    Waiting& operator=(const Waiting&) = delete;
    /// Whether this is a daemon thread while Python ends: what it waits for should come to its end.
    static bool outlived();
};

/// Tells all waiting threads that Python ends, and waits for them with the lock released, half a minute at most.
void end_all_waiting();

}  // namespace frana
