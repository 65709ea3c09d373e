#include "waiting.h"

#include <pthread.h>
#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <thread>

namespace frana {
namespace {

std::atomic<int> waiting{0};
std::atomic<bool> python_ends{false};
std::thread::id ends_it;  ///< the thread that runs what is left of Python

/// In a child the threads of its parent are not there.
[[maybe_unused]] const int forgets_after_fork = pthread_atfork(nullptr, nullptr, [] { waiting = 0; });

}  // namespace

Waiting::Waiting() {
    if (outlived()) {
        const pybind11::gil_scoped_release release;
        for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
    }
    ++waiting;
}

Waiting::~Waiting() { --waiting; }

bool Waiting::outlived() { return python_ends && std::this_thread::get_id() != ends_it; }

void end_all_waiting() {
    ends_it = std::this_thread::get_id();
    python_ends = true;
    const pybind11::gil_scoped_release release;
    for (int look = 0; waiting > 0 && look < 3000; ++look) std::this_thread::sleep_for(std::chrono::milliseconds(10));
}

}  // namespace frana
