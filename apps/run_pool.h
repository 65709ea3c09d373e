#pragma once
// Many runs at a time, each on one thread.
#include <chrono>
#include <functional>
#include <mutex>
#include <string>

#include "run/interrupt.h"
#include "scene/toolbox.h"

namespace frana {

/// Calls body(0), body(1), ... on so many threads, each number once, until they are done or an end is asked for. The first
/// exception ends it too, and comes out here.
void for_each_run(std::size_t count, int threads, const Interrupt& interrupt,
                  const std::function<void(std::size_t)>& body);

/// `given`, or where that is 0 as OMP_NUM_THREADS or the machine says.
int threads_for_runs(int given);

/// Reads barrier meshes one at a time, for scenes that are built on several threads.
MeshReader meshes_in_turn();

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
