#pragma once
// Time of an OpenMP team: on the wall, and by the processors' own clocks.
#include <ctime>
#include <vector>

namespace frana::bench {

/// A span of time [s].
struct Lap {
    double wall = 0.0;
    double cpu = 0.0;  ///< of the thread of the team that computed most: what the team takes without other work
};

/// From its construction on, teams have `threads` threads. On a machine with other work a thread waits for its turn.
/// Wall time counts that, CPU time does not. Waiting for one's own team is spent spinning and counts in both, nearly.
class TeamClock {
public:
    explicit TeamClock(int threads);
    void start();
    Lap stop() const;

private:
    std::vector<double> cpu_now() const;

    std::vector<clockid_t> clocks_;  ///< one per thread
    std::vector<double> cpu_start_;
    double wall_start_ = 0.0;
};

/// Time of a steady clock [s].
double wall_seconds();

}  // namespace frana::bench
