#include "run/folder/cutoff.h"

#include <unistd.h>

#include <chrono>
#include <system_error>

namespace frana {
namespace {

volatile std::sig_atomic_t signal_arrived = 0;

void note_signal(int) { signal_arrived = 1; }

constexpr std::array<int, 3> kSignals = {SIGINT, SIGTERM, SIGHUP};

}  // namespace

Cutoff::Cutoff(std::function<void()> last_words) : last_words_(std::move(last_words)) {
    signal_arrived = 0;
    for (std::size_t i = 0; i < kSignals.size(); ++i) {
        struct sigaction action {};
        action.sa_handler = note_signal;
        sigemptyset(&action.sa_mask);
        action.sa_flags = SA_RESTART | static_cast<int>(SA_RESETHAND);
        sigaction(kSignals[i], nullptr, &previous_[i]);
        // A process told to ignore a signal (nohup, a job in the background of a script) goes on ignoring it.
        if (previous_[i].sa_handler != SIG_IGN) sigaction(kSignals[i], &action, nullptr);
    }
    try {
        watcher_ = std::thread([this] { watch(); });
    } catch (const std::system_error&) {
        // No thread to be had: the end comes after the picture that is drawn.
    }
}

Cutoff::~Cutoff() {
    over_ = true;
    if (watcher_.joinable()) watcher_.join();
    for (std::size_t i = 0; i < kSignals.size(); ++i)
        if (previous_[i].sa_handler != SIG_IGN) sigaction(kSignals[i], &previous_[i], nullptr);
    signal_arrived = 0;
}

bool Cutoff::asked() { return signal_arrived != 0; }

void Cutoff::watch() {
    using std::chrono::milliseconds;
    constexpr milliseconds kNone{0}, kCheck{20}, kPatience{1000};
    for (milliseconds waited = kNone; waited < kPatience; waited += asked() ? kCheck : kNone) {
        if (over_) return;
        std::this_thread::sleep_for(kCheck);
    }
    try {
        last_words_();
    } catch (const std::exception&) {
        // There is nobody left to tell, and nothing that could be done.
    }
    ::_exit(130);
}

}  // namespace frana
