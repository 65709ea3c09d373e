#pragma once
// Things that stand on the ground of a perspective view in colours of their own: points in space, barriers.
#include <string>
#include <vector>

#include "vtk_io/map_figure_layout.h"

namespace frana {

/// A colour bar beside the picture.
struct ColourBar {
    Colormap colormap = Colormap::depth;
    ColourRange range;
    std::string label;  ///< name and unit
};

/// All places in map coordinates and elevations [m].
struct SpaceObjects {
    struct Ball {
        Vec3 centre{0, 0, 0};
        float radius = 0.5F;  ///< [m]
        Colour colour;
    };
    struct Facet {
        std::vector<Vec3> corners;  ///< in one plane, convex or not
        Colour colour;
    };
    std::vector<Ball> balls;
    std::vector<Facet> facets;
    std::vector<std::vector<Vec3>> edges;  ///< drawn in black
    std::vector<ColourBar> bars;           ///< instead of the field's
    bool empty() const { return balls.empty() && facets.empty(); }
};

}  // namespace frana
