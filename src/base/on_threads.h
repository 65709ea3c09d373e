#pragma once
#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
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

/// Calls `work` with each of the numbers below `count`, on so many threads. All are done, whatever fails. The first in
/// their order that failed is the one that is thrown.
inline void for_each_on_threads(std::size_t count, int threads, const std::function<void(std::size_t)>& work) {
    std::vector<std::exception_ptr> failed(count);
    std::atomic<std::size_t> next{0};
    on_threads(std::min(static_cast<std::size_t>(std::max(threads, 1)), count), [&] {
        for (std::size_t k = next++; k < count; k = next++) try {
                work(k);
            } catch (...) {
                failed[k] = std::current_exception();
            }
    });
    for (const std::exception_ptr& failure : failed)
        if (failure) std::rethrow_exception(failure);
}

}  // namespace frana
