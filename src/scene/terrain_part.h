#pragma once
// The part of a large terrain that a run begins with. Columns on it grow it before they come near its edge
// (coupling/growing_columns.h), so no result depends on where the terrain ends beyond it.
#include <optional>

#include "scene/case_file.h"
#include "scene/scene.h"
#include "scene/toolbox.h"

namespace frana {

struct TerrainPart {
    NodeBox box;
    std::vector<Vec2> shown;  ///< places of profiles and the survey [m]
};
/// The nodes around the releases, and those of gauges, profiles and the survey. Nothing where the run needs all of
/// `whole`, which is a raster without values: with other models than columns, with walls at the sides, barriers of
/// any shape, looks in situ or output.extent = "terrain"; with a release without an outline; and where the part would be all of it.
std::optional<TerrainPart> part_to_begin_with(const CaseFile& file, const Scene& scene, const GisReader& reader,
                                              const Raster& whole);

}  // namespace frana
