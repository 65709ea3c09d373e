#pragma once
// What is said on standard output while many runs go on.
#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>

namespace frana {

/// A line now and then while runs go on, from any thread.
class RunTeller {
public:
    /// `progress`: "json" for a line of JSON a second, empty for people.
    RunTeller(std::size_t runs, bool quiet, const std::string& progress)
        : runs_(runs), quiet_(quiet), json_(progress == "json") {}
    void done(bool failed);

private:
    const std::size_t runs_;
    const bool quiet_, json_;
    std::mutex mutex_;
    std::size_t done_ = 0, failed_ = 0;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    double told_ = 0.0;
};

}  // namespace frana
