#pragma once
// What is let go, and where: the input of the particle generation. Pure values, no files.
#include <optional>
#include <string>

#include "terrain/raster.h"

namespace frana {

/// One mass at rest or in motion at the start. Where an outline and a depth field are both given, material
/// lies where both have it. With neither, it lies everywhere on the grid.
struct Release {
    std::optional<Polygons> outline;    ///< empty: everywhere the depth field has material
    std::optional<Raster> depth_field;  ///< vertical depth, constant per pixel of its own; NaN or <= 0: none [m]
    double depth = 0.0;                 ///< vertical depth where no depth field is given [m]
    Vec2 velocity{0, 0};                ///< horizontal velocity [m/s]
    std::optional<Raster> velocity_x;   ///< replaces velocity.x() where it has data [m/s]
    std::optional<Raster> velocity_y;   ///< replaces velocity.y() where it has data [m/s]
    double left_out = 0.0;              ///< beyond what was read of the depth field's file [m3]
    std::string name;                   ///< for messages, such as "case.toml:12: release 1"; may be empty
};

}  // namespace frana
