#pragma once
// The simulated and the surveyed extent as ParaView's files, draped over the terrain.
#include <filesystem>

#include "terrain/outline_area.h"
#include "terrain/raster.h"

namespace frana {

/// Writes into `run_dir`:
/// survey_areas.vtp: a quadrilateral for every pixel that is simulated (`depth` above `limit` [m]) or surveyed to
///   some part. Cell data `agreement` (1 simulated and surveyed, 2 simulated only, 3 surveyed only) and
///   `surveyed_share` [1], exact.
///   A pixel counts as surveyed from half of its area on, and is left out when it is neither.
/// survey_outlines.vtp: a closed line for every ring of the two extents.
///   Cell data `extent` (1 simulated, along pixel edges; 2 surveyed), points at most a cell apart.
/// Heights are the bed's; what lies outside of the terrain is left out. `bed` has the pixels of `depth`. Throws
/// UserError when a file cannot be written.
void write_survey(const std::filesystem::path& run_dir, const Raster& bed, const Raster& depth, double limit,
                  const Rings& survey);

}  // namespace frana
