#pragma once
#include <cstdint>
#include <cstring>

namespace frana {

/// A 64-bit sum of bytes, for finding damage and changes (it guards against accidents, not against people). Each step
/// is one to one in what was there before and in the eight bytes that come. So a change within eight bytes is always
/// seen.
class Checksum {
public:
    /// Pieces but the last must be multiples of eight bytes long.
    void add(const void* data, std::size_t bytes) {
        const char* from = static_cast<const char*>(data);
        std::size_t left = bytes;
        for (; left >= 8; left -= 8, from += 8) take(word(from, 8));
        if (left > 0) take(word(from, left));
        length_ += bytes;
    }
    template <class Numbers>
    void add_all(const Numbers& numbers) {
        add(numbers.data(), numbers.size() * sizeof(typename Numbers::value_type));
    }
    std::uint64_t sum() const { return state_ ^ (length_ * kOdd); }

private:
    static constexpr std::uint64_t kOdd = 0x9e3779b97f4a7c15u;
    static std::uint64_t word(const char* from, std::size_t bytes) {
        std::uint64_t result = 0;
        std::memcpy(&result, from, bytes);
        return result;
    }
    void take(std::uint64_t value) {
        state_ = (state_ ^ value) * kOdd;
        state_ ^= state_ >> 32;
    }
    std::uint64_t state_ = kOdd, length_ = 0;
};

}  // namespace frana
