#include "vtk_io/figures/filmstrip.h"

#include <algorithm>
#include <utility>

#include "base/error.h"
#include "vtk_io/figures/canvas.h"
#include "vtk_io/figures/map_figure_picture.h"
#include "vtk_io/figures/png_file.h"
#include "vtk_io/figures/shared_view.h"

namespace frana {
namespace fs = std::filesystem;
bool render_filmstrip(const Filmstrip& strip, const fs::path& png, std::string& why_not) {
    expect(!strip.maps.empty() && strip.columns > 0, "a filmstrip without maps");
    why_not = no_picture_reason();
    if (!why_not.empty()) return false;
    const int columns = std::min(strip.columns, static_cast<int>(strip.maps.size()));
    std::vector<MapFigure> maps = strip.maps;
    SharedView view;
    for (const MapFigure& map : maps) view.add(map);
    for (MapFigure& map : maps) view.apply(map);
    std::vector<Pixels> pictures(maps.size());
    int wide = 1, high = 1;
    for (std::size_t n = 0; n < maps.size(); ++n) {
        maps[n].width = strip.width / columns;
        maps[n].height = strip.width / columns;
        pictures[n] = map_picture(maps[n]);
        wide = std::max(wide, pictures[n].width);
        high = std::max(high, pictures[n].height);
    }
    const int rows = (static_cast<int>(maps.size()) + columns - 1) / columns;
    Canvas canvas;
    for (int n = 0; n < static_cast<int>(maps.size()); ++n)
        canvas.image(std::move(pictures[static_cast<std::size_t>(n)]), n % columns * wide,
                     (rows - 1 - n / columns) * high);
    Pixels picture(columns * wide, rows * high);
    canvas.paint(picture);
    write_png(picture, png);
    return true;
}

}  // namespace frana
