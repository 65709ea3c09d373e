#include "io/deflate.h"

#include <cpl_conv.h>
#include <cpl_string.h>
#include <fmt/core.h>

#include <climits>
#include <memory>
#include <new>

#include "base/error.h"

namespace frana {
namespace {

constexpr int kLevel = 9;  // pages are written once and sent around

}  // namespace

std::vector<std::uint8_t> deflated(const std::vector<std::uint8_t>& bytes) {
    std::size_t size = 0;
    const std::unique_ptr<void, void (*)(void*)> packed(
        CPLZLibDeflate(bytes.data(), bytes.size(), kLevel, nullptr, 0, &size), VSIFree);
    if (!packed) throw std::bad_alloc();
    const auto* const first = static_cast<const std::uint8_t*>(packed.get());
    return {first, first + size};
}

std::vector<std::uint8_t> inflated(const std::vector<std::uint8_t>& bytes, std::size_t size) {
    std::vector<std::uint8_t> whole(size + 1);  // one more: something too long is not cut without a word
    std::size_t found = 0;
    if (!CPLZLibInflate(bytes.data(), bytes.size(), whole.data(), whole.size(), &found) || found != size)
        throw UserError(fmt::format("found {} packed bytes that are not {} bytes made small; make the file again",
                                    bytes.size(), size));
    whole.resize(size);
    return whole;
}

std::string base64(const std::vector<std::uint8_t>& bytes) {
    expect(bytes.size() < static_cast<std::size_t>(INT_MAX) / 2, "what becomes text fits one");
    const std::unique_ptr<char, void (*)(void*)> text(CPLBase64Encode(static_cast<int>(bytes.size()), bytes.data()),
                                                      VSIFree);
    return text.get();
}

std::vector<std::uint8_t> from_base64(const std::string& text) {
    std::vector<std::uint8_t> bytes(text.begin(), text.end());
    bytes.push_back(0);  // GDAL decodes a text in its place
    bytes.resize(static_cast<std::size_t>(CPLBase64DecodeInPlace(bytes.data())));
    return bytes;
}

}  // namespace frana
