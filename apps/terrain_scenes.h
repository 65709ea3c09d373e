#pragma once
// The made-up ground of the cases: formulas on nodes, no files.
#include <cmath>
#include <string>
#include <vector>

#include "terrain/raster.h"

namespace frana {

/// A raster that a case reads, with the name of its file.
struct MadeRaster {
    std::string file;  ///< "dem.tif"
    Raster raster;
};

/// Outlines that a case reads: rings, not closed.
struct MadeOutline {
    std::string file;  ///< "release.geojson"
    std::vector<Vec2> ring;
    std::vector<std::vector<Vec2>> others = {};  ///< further ones in the same file
};

/// Everything that is generated for one case.
struct MadeScene {
    std::vector<MadeRaster> rasters;
    std::vector<MadeOutline> outlines;
};

/// Lake at rest of Fois et al. (2024), section 4.1, first bed. Z = 5 exp(-2/5 |x - (5, 5)|^2) on [0, 10]^2, 50 x 50
/// cells (eq. 34).
MadeScene lake_z1();
/// The second bed: 4 on [4, 8]^2, otherwise 0 (eq. 34).
MadeScene lake_z2();
/// Collapse onto an obstacle, section 4.2: Z = 60 - x/3 + 15 exp(-((x - 50)^2 + (y - 10)^2)/7) on [0, 150] x
/// [0, 20] (eq. 37). A block of 37.5 x 14 m stands upstream of the obstacle.
MadeScene obstacle();
/// Section 4.3 on made-up ground. A mountainside of 28 degrees stands above a valley floor with a river, 1500 x 1350 m.
/// On it stand 1.2e6 m3 of rock, 38 m deep and 400 m long. There is a made-up survey of its trace (terrain_bindo.cpp
/// has the design).
MadeScene bindo();
/// Sliding to the wall, Fois et al. (2025), section 4.4.1: Z = 10 - x/3 down to x = 10, then flat, on [0, 25] x [0, 5].
/// The water is on [1.5, 5], and a wall at x = 20.
MadeScene wall();
/// Section 4.4.2 on made-up ground: a hill of 750 x 1000 m with cliffs. 5.8e3 m3 of mud lie on a terrace of it.
/// terrain_barrier_hill.cpp has the design.
MadeScene barrier_hill();
/// Section 4.3: h = 10 - sin(2x) cos(y) on [0, 5]^2, on flat ground (eq. 10).
MadeScene conversion();
/// A flat plate of 0.8 x 0.8 m. In its middle is the foot of a column of sand of 0.1 m radius.
MadeScene column_collapse();
/// Flume of van den Bout et al. (2021), section 3, as it is assumed here, unrolled. x is along its floor, 42 degrees up
/// to x = 0 and 5 behind; it is 0.5 m wide. A block of 0.30 x 0.25 m lies above the break and an obstacle below it.
MadeScene clay_flume();
/// Blocks of 100 x 60 m after section 4 there. Some lie over a convex slope of 10, then 30 degrees (scenarios 2A, 2B).
/// Others go down 25 degrees into a valley. Its floor falls off to both sides (3A, 3B), or rises a little (3C).
MadeScene blocks();
/// A V-shaped gully, 14 m deep, and the fan before it. It falls by 28 degrees at its head and 5 at its mouth. Its bed
/// has a debris of 12 000 m2; 5 m cells.
MadeScene debris_flow();
/// Fois et al. (2025), section 4.1: h = 1 + 2 exp(-((x - 50)^2 + (y - 50)^2)/150) on 100 x 100 pixels, on
/// flat ground.
MadeScene tiff_particles();
/// A parabola of 34 degrees at its head and 12 at its foot, then flat ground. A channel runs down its middle; 5 m
/// cells.
MadeScene avalanche_track();
/// A gully of 30 degrees at its head and 9 at its mouth, and the fan before it. It has a raster of the loose ground in
/// its bed and a scar at its head; 2.5 m cells.
MadeScene loose_gully();
/// A fan of 8 degrees at its apex and 4 at its foot below a gully. It has its outline and nine houses; 2.5 m cells.
MadeScene fan();
/// Two gullies 230 m apart on a slope, 32 degrees at its head and 3 at its foot. It is rough by a metre or two. It has the
/// scars of two slides and of one that is feared; 10 m cells.
MadeScene two_gullies();
/// A mountain valley with bends. A moraine of 26 m across it is cut through to its floor. There are an outline of the
/// lake behind it, and a plain below; 10 m cells.
MadeScene moraine_lake();

/// A scene by name.
struct NamedScene {
    const char* name;
    const char* meaning;
    MadeScene (*make)();
};
const std::vector<NamedScene>& made_scenes();

/// f(x, y) on the nodes of [0, width] x [0, height].
template <class Formula>
Raster on_nodes(double width, double height, double cell, const Formula& f) {
    GridGeometry geometry;
    geometry.cell = cell;
    geometry.nx = static_cast<Index>(std::lround(width / cell)) + 1;
    geometry.ny = static_cast<Index>(std::lround(height / cell)) + 1;
    Raster raster = Raster::filled(geometry, 0.0);
    for (Index j = 0; j < geometry.ny; ++j)
        for (Index i = 0; i < geometry.nx; ++i) raster.at(i, j) = f(geometry.x(i), geometry.y(j));
    return raster;
}

/// 0 below 0, 1 above 1, a cubic with level ends between.
inline double smooth_step(double s) {
    s = s < 0.0 ? 0.0 : s > 1.0 ? 1.0 : s;
    return s * s * (3.0 - 2.0 * s);
}

}  // namespace frana
