#include "vtk_io/figures/map_figure_paint.h"

#include <algorithm>
#include <cmath>

#include "vtk_io/hillshade.h"

namespace frana {

Colour colour_on_ground(const Colour& colour, double grey) {
    return mixed(scaled(colours::white, grey), scaled(colour, 0.62 + 0.45 * grey), 0.88);
}

Colour on_ground(double value, double grey, const FieldStyle& style) {
    if (!(std::abs(value) > style.shown_above)) return scaled(colours::white, grey);
    const double t = (value - style.range.low) / (style.range.high - style.range.low);
    return colour_on_ground(colour_at(style.colormap, t), grey);
}

Pixels painted(const Raster& bed, const Raster& field, const FieldStyle& style) {
    const GridGeometry& g = bed.geometry;
    Pixels pixels(static_cast<int>(g.nx), static_cast<int>(g.ny));
    const auto shade = hillshade(bed, shading_exaggeration(bed), style.light_turn);
    const ReliefGrey relief(shade);
    for (int y = 0; y < pixels.height; ++y)
        for (int x = 0; x < pixels.width; ++x) {
            const double s = shade[static_cast<std::size_t>(y) * pixels.width + x];
            pixels.set(x, y, std::isnan(s) ? colours::no_data : on_ground(field.at(x, y), relief(s), style));
        }
    return pixels;
}

Pixels painted_classes(const Raster& bed, const Raster& numbers, const std::vector<MapClass>& classes) {
    const GridGeometry &g = bed.geometry, &of = numbers.geometry;
    Pixels pixels(static_cast<int>(g.nx), static_cast<int>(g.ny));
    const auto shade = hillshade(bed, shading_exaggeration(bed));
    const ReliefGrey relief(shade);
    const auto nearest = [](double place, Index count) {
        return std::clamp(static_cast<Index>(std::lround(place)), Index{0}, count - 1);
    };
    for (int y = 0; y < pixels.height; ++y)
        for (int x = 0; x < pixels.width; ++x) {
            const double s = shade[static_cast<std::size_t>(y) * pixels.width + x];
            const double number =
                numbers.at(nearest((g.x(x) - of.x0) / of.cell, of.nx), nearest((g.y(y) - of.y0) / of.cell, of.ny));
            const bool classed = number >= 1.0 && number <= static_cast<double>(classes.size());
            const double grey = std::isnan(s) ? 0.0 : relief(s);
            const Colour ground = std::isnan(s) ? colours::no_data : scaled(colours::white, grey);
            pixels.set(x, y,
                       !classed || std::isnan(s)
                           ? ground
                           : colour_on_ground(classes[static_cast<std::size_t>(number) - 1].colour, grey));
        }
    return pixels;
}

}  // namespace frana
