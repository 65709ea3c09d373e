#pragma once
#include <array>
#include <atomic>
#include <csignal>
#include <functional>
#include <thread>

namespace frana {

/// Ctrl-C, SIGTERM and a hang-up while pictures are drawn. While an object lives they request an end instead of ending
/// the program. Drawing code checks asked() between pictures. A picture that does not end by itself is abandoned after
/// a second. Then the last words are spoken on another thread, and the process ends with exit code 130. Pictures appear
/// by a rename, so none is half there. A second signal ends the program at once. One object at a time.
class Cutoff {
public:
    /// `last_words`: leaves the results in order and says so. It must not touch the data of a picture that is being
    /// drawn.
    explicit Cutoff(std::function<void()> last_words);
    ~Cutoff();
    Cutoff(const Cutoff&) = delete;
    Cutoff& operator=(const Cutoff&) = delete;

    /// Whether an end was requested while an object lives.
    static bool asked();

private:
    void watch();

    std::function<void()> last_words_;
    std::atomic<bool> over_{false};
    std::thread watcher_;
    std::array<struct sigaction, 3> previous_{};
};

}  // namespace frana
