#include "checks/bench/team_clock.h"

#include <omp.h>
#include <pthread.h>

#include <algorithm>
#include <chrono>

namespace frana::bench {

double wall_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

TeamClock::TeamClock(int threads) : clocks_(static_cast<std::size_t>(threads)) {
    omp_set_dynamic(0);
    omp_set_num_threads(threads);
#pragma omp parallel num_threads(threads)
    pthread_getcpuclockid(pthread_self(), &clocks_[static_cast<std::size_t>(omp_get_thread_num())]);
}

std::vector<double> TeamClock::cpu_now() const {
    std::vector<double> now;
    for (const clockid_t clock : clocks_) {
        std::timespec time{};
        clock_gettime(clock, &time);
        now.push_back(static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec));
    }
    return now;
}

void TeamClock::start() {
    cpu_start_ = cpu_now();
    wall_start_ = wall_seconds();
}

Lap TeamClock::stop() const {
    Lap lap;
    lap.wall = wall_seconds() - wall_start_;
    const std::vector<double> now = cpu_now();
    for (std::size_t n = 0; n < now.size(); ++n) lap.cpu = std::max(lap.cpu, now[n] - cpu_start_[n]);
    return lap;
}

}  // namespace frana::bench
