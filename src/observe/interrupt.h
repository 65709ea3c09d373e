#pragma once
#include <atomic>
#include <csignal>

namespace frana {

/// Notices Ctrl-C and SIGTERM, so that a run can finish its step and leave valid files. While a listening
/// object lives it owns both signals; the second one kills the program as usual. One listening object at a
/// time.
class Interrupt {
public:
    enum class Listen { no, signals };
    explicit Interrupt(Listen listen = Listen::no);
    ~Interrupt();
    Interrupt(const Interrupt&) = delete;
    Interrupt& operator=(const Interrupt&) = delete;

    /// Ask for a stop from inside the program.
    void request() { requested_ = true; }
    bool requested() const;

private:
    bool listening_ = false;
    std::atomic<bool> requested_{false};
    struct sigaction previous_interrupt_ {};
    struct sigaction previous_terminate_ {};
};

}  // namespace frana
