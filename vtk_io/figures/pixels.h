#pragma once
// Images as plain data.
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/colour.h"

namespace frana {

/// An RGB image; row 0 is the lowest one, three bytes a pixel.
struct Pixels {
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> rgb;

    Pixels() = default;
    Pixels(int w, int h) : width(w), height(h), rgb(static_cast<std::size_t>(w) * h * 3, 255) {}
    void set(int x, int y, const Colour& c);
    Colour at(int x, int y) const;
};

}  // namespace frana
