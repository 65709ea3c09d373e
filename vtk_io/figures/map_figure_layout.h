#pragma once
// Where things stand in a map picture. Pixels count from the lower left corner.
#include "vtk_io/figures/chart_figure_ticks.h"
#include "vtk_io/figures/map_figure.h"
#include "vtk_io/figures/offscreen_canvas.h"

namespace frana {

/// The texts above and below a picture.
struct Captions {
    TextStyle title_style, footer_style;
    std::vector<std::string> title, footer;
    double title_height() const { return 1.3 * title_style.size * static_cast<double>(title.size()); }
    double footer_height() const { return 1.35 * footer_style.size * static_cast<double>(footer.size()); }
};
/// Size of ordinary text for a picture of that size [px].
double text_unit(int width, int height);
Captions make_captions(const std::string& title, const std::string& footer, double unit, double width);
void draw_captions(Canvas& canvas, const Captions& captions, int width, int height);

/// An entry of the legend under the picture.
struct LegendEntry {
    enum class Kind { line, cased_line, point, area } kind = Kind::line;
    Pen pen;
    std::string text;
};
/// Items of given widths put in rows no wider than `width`; (x, row) of each, and the number of rows.
struct Rows {
    std::vector<std::pair<double, int>> places;
    int count = 1;
};
Rows in_rows(const std::vector<double>& widths, double gap, double width);

/// Limits of the colours: given, or zero (the smallest value, when negative) to a round number at or above
/// the 99.5th percentile of the values shown; symmetric about zero for the diverging map.
struct ColourRange {
    double low = 0.0, high = 1.0;
    bool more_below = false, more_above = false;
};
ColourRange colour_range(const std::vector<double>& field, double shown_above, Colormap map,
                         const std::optional<std::pair<double, double>>& given);

/// [xmin, ymin, xmax, ymax] of all nodes where |field| exceeds the limit, half a cell wider; nothing when
/// none.
std::optional<std::array<double, 4>> covered_extent(const GridGeometry& grid, const std::vector<double>& field,
                                                    double shown_above);
/// The smallest rectangle round both.
std::array<double, 4> united(const std::array<double, 4>& a, const std::array<double, 4>& b);
std::array<double, 4> extent_of(const Polygons& polygons);

struct MapLayout {
    int width = 0, height = 0;  ///< of the picture [px]
    double unit = 20.0;         ///< size of ordinary text [px]
    Rectangle frame;            ///< the map itself [px], whole numbers
    double x0 = 0.0, y0 = 0.0;  ///< map coordinates of the frame's lower left corner [m]
    double metres_per_pixel = 1.0;
    Ticks x_ticks, y_ticks;
    Captions captions;
    ColourRange colours;
    double scale_length = 0.0;      ///< of the scale bar [m]
    double contour_interval = 0.0;  ///< [m]; 0: no contours
    std::vector<LegendEntry> legend;
    Rows strip;              ///< scale bar first, then the legend's entries
    double strip_top = 0.0;  ///< upper edge of the strip under the map [px]

    Vec2 pixel(const Vec2& map) const {
        return {frame.x0 + (map.x() - x0) / metres_per_pixel, frame.y0 + (map.y() - y0) / metres_per_pixel};
    }
    /// Nodes at the centres of the frame's pixels.
    GridGeometry pixel_grid() const;
    TextStyle text(Across across, Upward upward) const { return {unit, across, upward, 0.0, false, false, {}}; }
    double row_height() const { return 2.3 * unit; }
};

/// The field where |outlined| exceeds the limit, elsewhere NaN; every number of it is then shown.
std::vector<double> inside_outline(std::vector<double> field, const std::vector<double>& outlined, double shown_above);
constexpr double kAll = -1.0;  ///< "shown above" that hides NaN only
/// The limits of the colours of a field that is shown where `outlined` exceeds the limit; empty: where the field does.
ColourRange colours_within(const std::vector<double>& field, const std::vector<double>& outlined, double shown_above,
                           Colormap map, const std::optional<std::pair<double, double>>& given);

MapLayout lay_out(const MapFigure& figure);

}  // namespace frana
