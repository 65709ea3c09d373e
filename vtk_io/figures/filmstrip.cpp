#include "vtk_io/figures/filmstrip.h"

#include <vtkNew.h>
#include <vtkRenderer.h>

#include <algorithm>

#include "base/error.h"
#include "vtk_io/figures/offscreen.h"
#include "vtk_io/figures/offscreen_canvas.h"
#include "vtk_io/figures/shared_view.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

/// The map alone, by way of a file that does not stay.
bool drawn(const MapFigure& map, const fs::path& next_to, Pixels& pixels, std::string& why_not) {
    const fs::path file = fs::path(next_to).replace_extension(".part.png");
    const bool done = render_map(map, file, why_not);
    if (done) pixels = read_png(file);
    std::error_code ignored;
    fs::remove(file, ignored);
    return done;
}

}  // namespace

bool render_filmstrip(const Filmstrip& strip, const fs::path& png, std::string& why_not) {
    expect(!strip.maps.empty() && strip.columns > 0, "a filmstrip without maps");
    why_not = no_renderer_reason();
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
        if (!drawn(maps[n], png, pictures[n], why_not)) return false;
        wide = std::max(wide, pictures[n].width);
        high = std::max(high, pictures[n].height);
    }
    const int rows = (static_cast<int>(maps.size()) + columns - 1) / columns;
    const auto window = Offscreen::open(columns * wide, rows * high, why_not);
    if (!window) return false;
    Canvas canvas;
    for (int n = 0; n < static_cast<int>(maps.size()); ++n)
        canvas.image(pictures[static_cast<std::size_t>(n)], n % columns * wide, (rows - 1 - n / columns) * high);
    vtkNew<vtkRenderer> renderer;
    canvas.show(renderer);
    window->add(renderer);
    return window->save(png, why_not);
}

}  // namespace frana
