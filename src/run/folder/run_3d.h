#pragma once
// Pictures of 3D points, from the frames of a run.
#include <string>
#include <vector>

#include "run/folder/run_figures.h"

namespace frana {

/// For a run with 3D points: figures/view_points.png and section_points.png at the last output. Where a barrier has a
/// load, also figures/view_impact.png and section_impact.png at the output with the largest. With `source.time`
/// view_points_tTs.png and section_points_tTs.png at the output nearest to it as well. Nothing for a run without.
void add_3d(const FigureSource& source, Gallery& gallery);

/// figures/film_points.mp4 or .gif: that view at every output time that has points. Nothing for a run
/// without.
void add_film_3d(const FigureSource& source, const std::string& kind, Gallery& gallery);

}  // namespace frana
