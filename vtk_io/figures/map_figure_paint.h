#pragma once
// Terrain and field as one picture: relief in grey, the field's colours laid over it.
#include "terrain/raster.h"
#include "vtk_io/figures/map_figure_layout.h"
#include "vtk_io/figures/pixels.h"

namespace frana {

struct FieldStyle {
    Colormap colormap = Colormap::depth;
    ColourRange range;
    double shown_above = 0.1;
    double light_turn = 0.0;  ///< lamps turned clockwise from the north-west [radians]
};

/// One pixel per node. With r the relief's grey, the colour c of a value becomes 0.88 c (0.62 + 0.45 r) +
/// 0.12 r. Relief shows through, and the colour stays that of the colour bar within a few per cent.
Pixels painted(const Raster& bed, const Raster& field, const FieldStyle& style);

/// One pixel per node of the bed. Its colour is that of the class of the nearest node of `numbers`
/// (MapFigure::classes).
Pixels painted_classes(const Raster& bed, const Raster& numbers, const std::vector<MapClass>& classes);

/// Colour of something opaque on ground of the given grey (`painted` has the formula).
inline Colour colour_on_ground(const Colour& colour, double grey) {
    return mixed(scaled(colours::white, grey), scaled(colour, 0.62 + 0.45 * grey), 0.88);
}

/// Colour of one value on ground of the given grey in [0, 1]: what `painted` takes from a table, without one.
Colour on_ground(double value, double grey, const FieldStyle& style);

}  // namespace frana
