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
    void set(int x, int y, const Colour& c) {
        const std::size_t at = (static_cast<std::size_t>(y) * width + x) * 3;
        rgb[at] = c.r;
        rgb[at + 1] = c.g;
        rgb[at + 2] = c.b;
    }
    Colour at(int x, int y) const {
        const std::size_t place = (static_cast<std::size_t>(y) * width + x) * 3;
        return {rgb[place], rgb[place + 1], rgb[place + 2]};
    }
};

}  // namespace frana
