#pragma once
// What the phases of a step cost.
#include <chrono>
#include <vector>

#include "base/cpu_time.h"
#include "observe/archive.h"
#include "observe/frame.h"

namespace frana {

/// Wall time of the named phases of a step, and CPU time on request.
class StepClock {
public:
    /// Reads the CPU clock too from now on: a system call at both ends of a phase.
    void count_cpu_time() { counts_cpu_ = true; }
    template <class Body>
    auto operator()(const char* phase, Body&& body) {
        const Lap lap(*this, phase);
        return body();
    }
    std::vector<PhaseTime> times() const { return times_; }
    void serialize(Archive& archive) { frana::serialize(archive, "clock", times_); }

private:
    struct Lap {
        StepClock& clock;
        const char* phase;
        double cpu_start;
        std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
        Lap(StepClock& c, const char* p) : clock(c), phase(p), cpu_start(c.cpu_now()) {}
        ~Lap() {
            const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
            clock.add(phase, wall.count(), clock.cpu_now() - cpu_start);
        }
    };
    double cpu_now() const { return counts_cpu_ ? thread_cpu_seconds() : 0.0; }
    void add(const char* phase, double seconds, double cpu_seconds);
    std::vector<PhaseTime> times_;
    bool counts_cpu_ = false;
};

}  // namespace frana
