#pragma once
// Bytes made small, and bytes as text: zlib and base64 as GDAL has them.
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace frana {

/// In the format of zlib (RFC 1950), which browsers call "deflate". The same bytes give the same bytes.
std::vector<std::uint8_t> deflated(const std::vector<std::uint8_t>& bytes);

/// What was deflated: `size` bytes. UserError when it is anything else.
std::vector<std::uint8_t> inflated(const std::vector<std::uint8_t>& bytes, std::size_t size);

/// RFC 4648, with padding.
std::string base64(const std::vector<std::uint8_t>& bytes);
std::vector<std::uint8_t> from_base64(const std::string& text);

}  // namespace frana
