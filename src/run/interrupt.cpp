#include "run/interrupt.h"

#include "base/error.h"

namespace frana {
namespace {

volatile std::sig_atomic_t signal_arrived = 0;

void note_signal(int) { signal_arrived = 1; }

constexpr std::array<int, 4> kSignals = {SIGINT, SIGTERM, SIGHUP, SIGPIPE};

struct sigaction action_of(int signal) {
    struct sigaction action {};
    action.sa_handler = note_signal;
    sigemptyset(&action.sa_mask);
    // The default action comes back after the first signal: a second Ctrl-C ends the program at once.
    action.sa_flags = SA_RESTART | (signal == SIGPIPE ? 0 : static_cast<int>(SA_RESETHAND));
    return action;
}

}  // namespace

Interrupt::Interrupt(Listen listen) : listening_(listen == Listen::signals) {
    if (!listening_) return;
    signal_arrived = 0;
    for (std::size_t i = 0; i < kSignals.size(); ++i) {
        // A process told to ignore a hang-up (nohup) goes on ignoring it.
        expect(sigaction(kSignals[i], nullptr, &previous_[i]) == 0, "signal handler");
        if (kSignals[i] == SIGHUP && previous_[i].sa_handler == SIG_IGN) continue;
        const struct sigaction action = action_of(kSignals[i]);
        expect(sigaction(kSignals[i], &action, nullptr) == 0, "signal handler");
    }
}

Interrupt::~Interrupt() {
    if (!listening_) return;
    for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &previous_[i], nullptr);
}

bool Interrupt::requested() const { return requested_ || (listening_ && signal_arrived != 0); }

}  // namespace frana
