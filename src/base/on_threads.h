#pragma once
#include <functional>
#include <system_error>
#include <thread>
#include <vector>

namespace frana {

/// Runs `work` on so many threads at the same time, this one among them, and waits for all. It is to share out what there is to
/// do, and throws nothing. Fewer threads where the system gives no more.
inline void on_threads(std::size_t threads, const std::function<void()>& work) {
    std::vector<std::thread> others;
    for (std::size_t n = 1; n < threads; ++n) try {
            others.emplace_back(work);
        } catch (const std::system_error&) {
            break;
        }
    work();
    for (std::thread& other : others) other.join();
}

}  // namespace frana
