#include "mpm/step_clock.h"

namespace frana {

void StepClock::add(const char* phase, double seconds, double cpu_seconds) {
    for (PhaseTime& time : times_)
        if (time.name == phase) {
            time.seconds += seconds;
            time.cpu_seconds += cpu_seconds;
            time.calls += 1;
            return;
        }
    times_.push_back({phase, seconds, cpu_seconds, 1});
}

}  // namespace frana
