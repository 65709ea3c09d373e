#pragma once
// Reading ahead. Processors follow a few streams through memory by themselves. A loop that does much work on numbers
// from a dozen arrays and as many rows of nodes loses them. It then waits for memory at each new line. Short loops of
// plain reads before it have many lines under way: an eighth of a step. Prefetch instructions in the same places gained
// nothing.
#include <cstddef>

namespace frana {

constexpr std::size_t kCacheLine = 64;  ///< [bytes]

/// Reads what lies there, for nothing.
inline void touch(const void* p) { static_cast<void>(*static_cast<const volatile char*>(p)); }

/// The same for every line of `count` places of an array; the last one may be left out.
template <class T>
inline void touch(const T* first, std::ptrdiff_t count) {
    const char* const begin = reinterpret_cast<const char*>(first);
    const std::size_t bytes = static_cast<std::size_t>(count) * sizeof(T);
    for (std::size_t n = 0; n < bytes; n += kCacheLine) touch(begin + n);
}

}  // namespace frana
