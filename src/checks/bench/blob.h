#pragma once
#include "scene/scene.h"

namespace frana::bench {

/// A moving, spreading blob: what is timed.
struct Blob {
    Index particles = 500000;  ///< exactly so many, four a cell
    double emptiness = 0.0;    ///< cells of the grid over cells with material, at least; 0: a tight grid
    bool friction = true;      ///< Voellmy
    bool rheology = true;      ///< Bingham
    bool topography = true;    ///< an undulating slope of 27 degrees; otherwise level ground
    double resting = 0.0;      ///< share of the points, those behind a line across the blob, that start at rest
    bool sleeps = true;        ///< scheme.sleep
    bool single = false;       ///< scheme.precision = "float"
    bool erodes = false;       ///< 1 m of loose ground, of which the growth law takes a little
    Index houses = 0;          ///< of 10 m x 10 m, in rows along the grid's edge, where no flow is
    bool zones = false;        ///< two bed laws in stripes of ten cells, of nearly the same friction
};

/// Cells of 5 m, up to 4 m of material, 8 m/s downhill and up to 3 m/s outwards. The blob stands on the same tiles of
/// any grid, with 48 cells of room to each side.
Scene blob_scene(const Blob& blob);

}  // namespace frana::bench
