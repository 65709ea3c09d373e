#pragma once
// A map before it is a file.
#include "vtk_io/figures/map_figure.h"

namespace frana {

/// The map of render_map. Several threads may make theirs at the same time.
Pixels map_picture(const MapFigure& figure);

}  // namespace frana
