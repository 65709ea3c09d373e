#include "vtk_io/figures/map_figure_paint.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "vtk_io/hillshade.h"

namespace frana {

Colour on_ground(double value, double grey, const FieldStyle& style) {
    if (!(std::abs(value) > style.shown_above)) return scaled(colours::white, grey);
    const double t = (value - style.range.low) / (style.range.high - style.range.low);
    return colour_on_ground(colour_at(style.colormap, t), grey);
}

namespace {

/// A colour map's colours, finer than eye and file tell apart.
class ColourTable {
public:
    explicit ColourTable(Colormap map) {
        for (std::size_t k = 0; k < colours_.size(); ++k)
            colours_[k] = colour_at(map, static_cast<double>(k) / (kColours - 1));
    }
    const Colour& operator()(double t) const {
        return colours_[t > 0.0 ? nearest_whole(std::min(t, 1.0) * (kColours - 1)) : 0];
    }

private:
    static constexpr int kColours = 4096;
    std::array<Colour, kColours> colours_;
};

}  // namespace

Pixels painted(const Raster& bed, const Raster& field, const FieldStyle& style) {
    const GridGeometry& g = bed.geometry;
    Pixels pixels(static_cast<int>(g.nx), static_cast<int>(g.ny));
    const auto shade = hillshade(bed, shading_exaggeration(bed), style.light_turn);
    const ReliefGrey relief(shade);
    const ColourTable table(style.colormap);
    const double scale = 1.0 / (style.range.high - style.range.low);
    for (int y = 0; y < pixels.height; ++y)
        for (int x = 0; x < pixels.width; ++x) {
            const double s = shade[static_cast<std::size_t>(y) * pixels.width + x], value = field.at(x, y);
            const double grey = relief(s);
            const bool shown = std::abs(value) > style.shown_above;
            pixels.set(x, y,
                       std::isnan(s) ? colours::no_data
                       : shown       ? colour_on_ground(table(scale * (value - style.range.low)), grey)
                                     : scaled(colours::white, grey));
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
