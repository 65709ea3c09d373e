#pragma once
// Memory for arrays that one loop runs through together.
#include <atomic>
#include <cstddef>
#include <new>
#include <vector>

namespace frana {

/// Allocator whose blocks start at different cache lines of a page. Large blocks all come page-aligned from the system.
/// A loop over some of them would then read and write addresses whose lower twelve bits agree. Processors take a read
/// behind such a write for dependent (4K aliasing: gathering took twice as long).
template <class T>
struct Staggered {
    using value_type = T;
    Staggered() = default;
    template <class U>
    Staggered(const Staggered<U>&) {}

    T* allocate(std::size_t count) {
        static std::atomic<unsigned> turn{0};
        const std::size_t shift = kLine * (1 + turn.fetch_add(1, std::memory_order_relaxed) % kPlaces);
        char* const block = static_cast<char*>(::operator new(count * sizeof(T) + shift));
        *reinterpret_cast<std::size_t*>(block + shift - sizeof(std::size_t)) = shift;
        return reinterpret_cast<T*>(block + shift);
    }
    void deallocate(T* data, std::size_t) {
        char* const start = reinterpret_cast<char*>(data);
        ::operator delete(start - *reinterpret_cast<std::size_t*>(start - sizeof(std::size_t)));
    }
    bool operator==(const Staggered&) const { return true; }
    bool operator!=(const Staggered&) const { return false; }

private:
    static constexpr std::size_t kLine = 64, kPlaces = 31;
};

/// One quantity of all points.
template <class Real>
using ArrayOf = std::vector<Real, Staggered<Real>>;
using Array = ArrayOf<double>;

/// Sets the size; grows by no more than an eighth beyond that.
template <class Values>
void resize_sparingly(Values& array, std::size_t count) {
    if (count > array.capacity()) array.reserve(count + count / 8);
    array.resize(count);
}

/// Fills `count` places with `value`, with room to grow as above.
template <class Values>
void assign_sparingly(Values& array, std::size_t count, const typename Values::value_type& value) {
    array.clear();
    if (count > array.capacity()) array.reserve(count + count / 8);
    array.resize(count, value);
}

}  // namespace frana
