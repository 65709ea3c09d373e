#pragma once
// How wide a flow may become, before it is computed: from its release and the valley below.
#include "particles/seeds.h"
#include "terrain/raster.h"

namespace frana {

struct ExpectedWidth {
    double width = Raster::nodata;    ///< median along the path, no wider than the release; NaN: not known [m]
    double release = Raster::nodata;  ///< of the release, across the steepest path [m]
};

/// The release is taken for the rectangle with its second moments. It lies along and across the first part of the
/// steepest path. A section of the valley across that path is filled until it holds the rectangle's section (volume
/// over length). It is as wide as the flow there. On open ground the release's width counts. The path ends where the
/// straight line to it from the release's middle falls less than `friction` [1]. With 0 it ends at the edge of the
/// terrain.
ExpectedWidth expected_width(const Raster& bed, const Seeds& release, double friction);

}  // namespace frana
