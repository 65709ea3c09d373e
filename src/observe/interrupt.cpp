#include "observe/interrupt.h"

#include "base/error.h"

namespace frana {
namespace {

volatile std::sig_atomic_t signal_arrived = 0;

void note_signal(int) { signal_arrived = 1; }

struct sigaction once() {
    struct sigaction action {};
    action.sa_handler = note_signal;
    sigemptyset(&action.sa_mask);
    // The default action comes back after the first signal: whoever presses Ctrl-C twice wants out now.
    action.sa_flags = static_cast<int>(SA_RESETHAND) | SA_RESTART;
    return action;
}

}  // namespace

Interrupt::Interrupt(Listen listen) : listening_(listen == Listen::signals) {
    if (!listening_) return;
    signal_arrived = 0;
    const struct sigaction action = once();
    expect(sigaction(SIGINT, &action, &previous_interrupt_) == 0, "SIGINT handler");
    expect(sigaction(SIGTERM, &action, &previous_terminate_) == 0, "SIGTERM handler");
}

Interrupt::~Interrupt() {
    if (!listening_) return;
    sigaction(SIGINT, &previous_interrupt_, nullptr);
    sigaction(SIGTERM, &previous_terminate_, nullptr);
}

bool Interrupt::requested() const { return requested_ || (listening_ && signal_arrived != 0); }

}  // namespace frana
