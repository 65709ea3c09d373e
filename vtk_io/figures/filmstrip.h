#pragma once
// One field at several times, side by side.
#include <filesystem>
#include <string>
#include <vector>

#include "vtk_io/figures/map_figure.h"

namespace frana {

/// Maps of the same terrain at several times, each with its own title.
struct Filmstrip {
    std::vector<MapFigure> maps;  ///< drawn with one colour range and one view, those of all together
    int columns = 3;
    int width = 1800;  ///< of the picture [px]
};

/// Draws the maps in rows into one PNG, with one colour bar and one legend for all. False with a reason when pictures are
/// switched off (no file is made); UserError when the file cannot be written.
bool render_filmstrip(const Filmstrip& strip, const std::filesystem::path& png, std::string& why_not);

}  // namespace frana
