#pragma once
// What varies spatially besides the elevations, read anew for another part of a large terrain: friction, loose
// material, trees.
#include <functional>
#include <memory>

#include "scene/case_file.h"
#include "scene/scene.h"
#include "scene/toolbox.h"

namespace frana {

/// Whether a case has any of them.
bool has_fields(const CaseFile& file);
/// WiderTerrain::fields of a case on a terrain: nothing when it has none.
std::function<GroundFields(const Raster& part)> fields_later(const CaseFile& file, const GisReader& reader,
                                                             const GridGeometry& terrain);

}  // namespace frana
