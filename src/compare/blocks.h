#pragma once
// Heights compared with surveyed ones by blocks. Trifles decide on which pixel a thin flow stops, but not how much of
// it lies on an acre.
#include "terrain/raster.h"

namespace frana {

/// Differences of the means over blocks in which one of the two has something.
struct BlockErrors {
    double rms = 0.0;     ///< root of their mean square [m]; 0 where there is no such block, which is no likeness
    double number = 0.0;  ///< of blocks; one that was surveyed in part counts for that part
};

/// Averages both over the pixels of square blocks of about `side` [m], a pixel at least, from the survey's south-west corner.
/// `surveyed` has the pixels of `simulated`, and may have more around them; there nothing was simulated. A pixel where one of
/// the two is NaN belongs to no block.
BlockErrors block_errors(const Raster& simulated, const Raster& surveyed, double side);

}  // namespace frana
