#pragma once
// Things that stand on the ground of a perspective view in colours of their own: 3D points, barriers.
#include <string>
#include <vector>

#include "vtk_io/figures/map_figure_layout.h"

namespace frana {

/// A colour bar next to the picture.
struct ColourBar {
    Colormap colormap = Colormap::depth;
    ColourRange range;
    std::string label;  ///< name and unit
};

/// All places in map coordinates and elevations [m].
struct Objects3d {
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
    std::vector<Vec3> room;                ///< places that must fit in; none: the balls'
    std::vector<std::vector<Vec3>> edges;  ///< drawn in black
    std::vector<ColourBar> bars;           ///< instead of the field's
    /// A face that the balls hide, drawn flat in the upper left corner.
    struct Inset {
        struct Area {
            std::vector<Vec2> corners;  ///< convex: to the right, upwards [m]
            Colour colour;
        };
        std::vector<Area> areas;  ///< nothing: no inset
        std::string caption;
    } inset;
    bool empty() const { return balls.empty() && facets.empty(); }
};

/// The height that an inset takes of a picture, with its caption, if it is no larger than `most` [px]. 0 without
/// any.
double height_of_inset(const Objects3d::Inset& inset, const Vec2& most, double unit);

/// Draws an inset with its upper left corner there, no larger than `most` [px].
void draw_inset(Canvas& canvas, const Objects3d::Inset& inset, const Vec2& corner, const Vec2& most, double unit);

}  // namespace frana
