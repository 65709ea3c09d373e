#pragma once
// A simulated extent, which consists of pixels, held against a surveyed one, which consists of polygons.
#include <functional>

#include "compare/outline.h"

namespace frana {

/// Areas [m2]. The survey is the reference: hit + missed is all of it.
struct Overlap {
    double hit = 0.0;             ///< simulated and surveyed (true positive)
    double beyond = 0.0;          ///< simulated only (false positive)
    double missed = 0.0;          ///< surveyed only (false negative), with what lies outside the raster
    double missed_outside = 0.0;  ///< the part of it outside the raster, where nothing could be simulated

    double simulated() const { return hit + beyond; }
    double surveyed() const { return hit + missed; }
    double iou() const { return hit / (hit + beyond + missed); }
    double precision() const { return hit / simulated(); }  ///< NaN when nothing was simulated
    double recall() const { return hit / surveyed(); }
    double f1() const { return 2.0 * hit / (simulated() + surveyed()); }
    double area_ratio() const { return simulated() / surveyed(); }
    /// |A_sim - A_survey| / A_survey [%], the figure of Fois et al. (2024), section 4.3.
    double area_difference_percent() const;
    /// Area in one extent only, over the survey's [%]; unlike the above it sees a wrong place.
    double symmetric_difference_percent() const { return 100.0 * (beyond + missed) / surveyed(); }
};

/// Calls body(i, j, area) for every pixel, rows from the south: the rings' area within it, exact [m2].
void for_each_pixel_area(const GridGeometry& grid, const Rings& rings,
                         const std::function<void(Index i, Index j, double area)>& body);

/// Pixels of `depth` above `limit` against the rings of a survey (see rings_of). The survey's area in each pixel is
/// exact, so the sums are those of a polygon overlay, to round-off.
Overlap overlap(const Raster& depth, double limit, const Rings& survey);

}  // namespace frana
