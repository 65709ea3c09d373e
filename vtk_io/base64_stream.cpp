#include "vtk_io/base64_stream.h"

#include <vtkObjectFactory.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <vector>

namespace frana {
namespace {

constexpr char kLetters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/// Two letters for each number of twelve bits.
const std::vector<std::array<char, 2>>& pairs() {
    static const std::vector<std::array<char, 2>> all = [] {
        std::vector<std::array<char, 2>> made(4096);
        for (std::size_t k = 0; k < made.size(); ++k) made[k] = {kLetters[k >> 6], kLetters[k & 63]};
        return made;
    }();
    return all;
}

void encode(const unsigned char* three, const std::array<char, 2>* table, char* letters) {
    const std::uint32_t bits = std::uint32_t{three[0]} << 16 | std::uint32_t{three[1]} << 8 | std::uint32_t{three[2]};
    std::memcpy(letters, &table[bits >> 12], 2);
    std::memcpy(letters + 2, &table[bits & 4095], 2);
}

}  // namespace

vtkStandardNewMacro(Base64Stream);

int Base64Stream::StartWriting() {
    resting_ = 0;
    return Superclass::StartWriting();
}

int Base64Stream::Write(const void* data, std::size_t length) {
    const auto* from = static_cast<const unsigned char*>(data);
    const std::array<char, 2>* const table = pairs().data();
    letters_.resize(4 * ((resting_ + length) / 3));
    char* to = letters_.data();
    if (resting_ > 0) {
        const std::size_t more = std::min(3 - resting_, length);
        std::copy_n(from, more, rest_.begin() + static_cast<std::ptrdiff_t>(resting_));
        resting_ += more, from += more, length -= more;
        if (resting_ < 3) return 1;
        encode(rest_.data(), table, to);
        to += 4;
    }
    for (; length >= 3; from += 3, length -= 3, to += 4) encode(from, table, to);
    std::copy_n(from, length, rest_.begin());
    resting_ = length;
    return WriteStream(letters_.data(), letters_.size());
}

int Base64Stream::EndWriting() {
    if (resting_ == 0) return 1;
    std::array<char, 4> last{};
    std::fill(rest_.begin() + static_cast<std::ptrdiff_t>(resting_), rest_.end(), static_cast<unsigned char>(0));
    encode(rest_.data(), pairs().data(), last.data());
    std::fill(last.begin() + static_cast<std::ptrdiff_t>(resting_) + 1, last.end(), '=');
    resting_ = 0;
    return WriteStream(last.data(), last.size());
}

}  // namespace frana
