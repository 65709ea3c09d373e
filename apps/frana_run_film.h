#pragma once
// Pictures of the depth through time, from the frames of a run.
#include <string>
#include <vector>

#include "frana_run_figures.h"

namespace frana {

/// figures/filmstrip_depth.png, the depth at up to six output times side by side; nothing for a run without frames on
/// the grid.
void draw_filmstrip(const FigureSource& source, std::vector<DrawnFigure>& figures, std::vector<std::string>& warnings);

/// figures/film_depth.mp4 or .gif (`kind`: "mp4" or "gif"), the depth at every output time in one view and one range of
/// colours, about eight seconds long with 2 to 25 pictures a second. One warning and no film without the program
/// ffmpeg, frames on the grid or a renderer.
void draw_film(const FigureSource& source, const std::string& kind, std::vector<DrawnFigure>& figures,
               std::vector<std::string>& warnings);

}  // namespace frana
