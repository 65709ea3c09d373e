#include "vtk_io/figures/pixels.h"

namespace frana {

void Pixels::set(int x, int y, const Colour& c) {
    const std::size_t at = (static_cast<std::size_t>(y) * width + x) * 3;
    rgb[at] = c.r;
    rgb[at + 1] = c.g;
    rgb[at + 2] = c.b;
}

Colour Pixels::at(int x, int y) const {
    const std::size_t place = (static_cast<std::size_t>(y) * width + x) * 3;
    return {rgb[place], rgb[place + 1], rgb[place + 2]};
}

}  // namespace frana
