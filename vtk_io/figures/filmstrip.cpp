#include "vtk_io/figures/filmstrip.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "vtk_io/figures/canvas.h"
#include "vtk_io/figures/map_figure_furniture.h"
#include "vtk_io/figures/map_figure_picture.h"
#include "vtk_io/figures/png_file.h"
#include "vtk_io/figures/shared_view.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

/// The maps in their rows, and what they share: colours on the right, scale and legend below.
struct Sheet {
    std::vector<MapFigure> maps;
    int columns, rows;
    int wide, high;  ///< of each map [px]
    SharedView view;
    MapLayout layout;

    explicit Sheet(const Filmstrip& strip)
        : maps(strip.maps), columns(std::min(strip.columns, static_cast<int>(maps.size()))) {
        rows = (static_cast<int>(maps.size()) + columns - 1) / columns;
        for (const MapFigure& map : maps) view.add(map);
        wide = high = static_cast<int>((strip.width - bar_room(strip.width)) / columns);
        for (MapFigure& map : maps) {
            view.apply(map);
            map.width = wide;
            map.height = high;
            map.explained = false;
        }
        layout = lay_out(maps.front());
        layout.strip = in_rows(strip_widths(layout), 1.4 * layout.unit, columns * wide - 2.0 * layout.unit);
        layout.strip_top = layout.row_height() * layout.strip.count;
    }

    static double bar_room(int width) { return 0.075 * width; }
    int foot() const { return static_cast<int>(std::ceil(layout.strip_top + 0.5 * layout.unit)); }
};

}  // namespace

bool render_filmstrip(const Filmstrip& strip, const fs::path& png, std::string& why_not) {
    expect(!strip.maps.empty() && strip.columns > 0, "a filmstrip without maps");
    why_not = no_picture_reason();
    if (!why_not.empty()) return false;
    Sheet sheet(strip);
    std::vector<Pixels> pictures;
    for (const MapFigure& map : sheet.maps) pictures.push_back(map_picture(map));
    sheet.wide = sheet.high = 1;
    for (const Pixels& picture : pictures) {
        sheet.wide = std::max(sheet.wide, picture.width);
        sheet.high = std::max(sheet.high, picture.height);
    }
    Canvas canvas;
    const int top = sheet.foot() + sheet.rows * sheet.high, right = sheet.columns * sheet.wide;
    for (int n = 0; n < static_cast<int>(pictures.size()); ++n)
        canvas.image(std::move(pictures[static_cast<std::size_t>(n)]), n % sheet.columns * sheet.wide,
                     sheet.foot() + (sheet.rows - 1 - n / sheet.columns) * sheet.high);
    const double u = 1.2 * sheet.layout.unit;
    const MapFigure& map = sheet.maps.front();
    draw_colour_bar(canvas, {right + 0.5 * u, sheet.foot() + 3.0 * u, right + 1.6 * u, top - 3.0 * u},
                    sheet.view.range(), map.colormap, map.field_label, u);
    draw_strip(canvas, sheet.layout);
    Pixels picture(right + static_cast<int>(Sheet::bar_room(strip.width)), top);
    canvas.paint(picture);
    write_png(picture, png);
    return true;
}

}  // namespace frana
