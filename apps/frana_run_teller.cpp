#include "frana_run_teller.h"

#include <fmt/core.h>

#include <iostream>

namespace frana {

void RunTeller::done(bool failed) {
    const std::lock_guard<std::mutex> alone(mutex_);
    ++done_, failed_ += failed;
    const double every = json_ ? 1.0 : 5.0;  // [s]
    const double now = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    if (quiet_ || (now - told_ < every && done_ < runs_)) return;
    told_ = now;
    const double left = now * static_cast<double>(runs_ - done_) / static_cast<double>(done_);
    const double share = static_cast<double>(done_) / static_cast<double>(runs_);
    std::cout << (json_ ? fmt::format(
                              "{{\"event\": \"progress\", \"done\": {}, \"runs\": {}, \"failed\": {}, \"share\": {}, "
                              "\"wall\": {}, \"eta\": {}}}\n",
                              done_, runs_, failed_, share, now, left)
                        : fmt::format("{} of {} runs, {} failed, {:.0f} s, {:.0f} s left\n", done_, runs_, failed_, now,
                                      left))
              << std::flush;
}

}  // namespace frana
