#pragma once
// Where things stand in a map picture. Pixels count from the lower left corner.
#include "vtk_io/figures/canvas.h"
#include "vtk_io/figures/chart_figure_ticks.h"
#include "vtk_io/figures/map_figure.h"
#include "vtk_io/figures/map_range.h"

namespace frana {

/// Thickness of a barrier's line, in sizes of ordinary text.
inline constexpr double kBarrierPen = 0.2;

/// The pen of a line by its kind, in a picture with text of that size [px], and its name in the legend.
Pen line_pen(MapLine kind, double unit);
const char* line_name(MapLine kind);

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

MapLayout lay_out(const MapFigure& figure);

/// "to 214": the largest value, where it lies beyond the range's tip; else empty.
std::string beyond_text(const ColourRange& range);

/// Widths of the strip's items: scale bar with north arrow, then the legend [px].
std::vector<double> strip_widths(const MapLayout& layout);

}  // namespace frana
