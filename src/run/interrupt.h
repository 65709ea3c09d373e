#pragma once
#include <array>
#include <atomic>
#include <csignal>

namespace frana {

/// Notices Ctrl-C, SIGTERM, a closed terminal (SIGHUP) and a closed pipe behind standard output (SIGPIPE). So a run can
/// finish its step and leave valid files. While a listening object lives it owns these signals. A second one of the
/// same kind kills the program as usual. Not so SIGPIPE, which every further line would raise. One listening object at
/// a time.
class Interrupt {
public:
    enum class Listen { no, signals };
    explicit Interrupt(Listen listen = Listen::no);
    ~Interrupt();
    Interrupt(const Interrupt&) = delete;
    Interrupt& operator=(const Interrupt&) = delete;

    /// Requests a stop from inside the program.
    void request() { requested_ = true; }
    bool requested() const;
    /// Whether it owns the signals.
    bool listens() const { return listening_; }

private:
    bool listening_ = false;
    std::atomic<bool> requested_{false};
    std::array<struct sigaction, 4> previous_{};
};

}  // namespace frana
