#pragma once
// The part of a large terrain that a run begins with. Particles extend it before they come near its edge
// (coupling/growing_particles.h). So no result depends on where the terrain ends beyond it.
#include <optional>

#include "scene/case_file.h"
#include "scene/scene.h"
#include "scene/toolbox.h"

namespace frana {

struct TerrainPart {
    NodeBox box;
    std::vector<Vec2> shown;  ///< places of profiles, the survey and barriers [m]
};
/// The nodes around the releases and a 3D stage's window, and those of gauges, profiles, barriers and the survey.
/// `whole` is a raster without values. Nothing where the run needs all of it, or where the part would be all of it. So
/// with structured solids, free water, a 3D stage without a window, walls at the sides, barriers given as meshes,
/// [[insitu]], or output.extent = "terrain". So with friction from a table of classes, ground rasters in another CRS,
/// and spatially varying friction with deposition. So too with a release by neither an outline nor a raster of its mask
/// or depth.
std::optional<TerrainPart> part_to_begin_with(const CaseFile& file, const Scene& scene, const GisReader& reader,
                                              const Raster& whole);

}  // namespace frana
