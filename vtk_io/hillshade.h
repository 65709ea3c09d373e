#pragma once
// Relief shading, and rasters brought to the resolution of a picture.
#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "base/colour.h"
#include "terrain/raster.h"

namespace frana {

/// How values between nodes are found. linear leaves the nodes' values as they are. smooth is the cubic B-spline, which
/// rounds off noise of the size of a cell and has a continuous slope.
enum class Between { linear, smooth };

/// The raster at the nodes of `target`, for pictures (never for computing). It is interpolated where the target is
/// finer. Where it is coarser than 1.5 cells, block means come first. NaN outside the raster's pixels and where the
/// nearest node has none. A stencil that touches NaN falls back to the valid corners of the linear one.
Raster resampled(const Raster& raster, const GridGeometry& target, Between between);

/// Light on the surface in [0, 1] per node, NaN where the bed has none. Four lamps stand 45 degrees high, at azimuths
/// 315 (weight 0.5), 270 (0.2), 360 (0.2) and 225 (0.1). So no slope is wholly dark and all stay readable. Slopes are
/// multiplied by `exaggeration`, lamps turned clockwise by `turn` [radians].
std::vector<float> hillshade(const Raster& bed, double exaggeration, double turn = 0.0);

/// The factor that gives gentle terrain enough contrast: mean slope brought to 0.6, at least 1 and at most 5.
double shading_exaggeration(const Raster& bed);

/// Brings shades to grey levels in [0.42, 0.98]: light enough for black lines on top. The contrast is the same
/// whichever way the terrain faces. It spans the 1st to 99th percentile, at least 0.35 of shade apart; the median
/// becomes 0.8.
class ReliefGrey {
public:
    explicit ReliefGrey(const std::vector<float>& shade);
    double operator()(double shade) const {
        const double place = (shade - low_) / span_;  // NaN gives the darkest
        return levels_[place > 0.0 ? nearest_whole(std::min(place, 1.0) * (kLevels - 1)) : 0];
    }

private:
    static constexpr int kLevels = 2048;  // eight for each that a picture can show
    double low_ = 0.0, span_ = 1.0;
    std::array<double, kLevels> levels_{};
};

}  // namespace frana
