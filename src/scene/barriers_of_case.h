#pragma once
#include <string>
#include <vector>

#include "scene/case_file.h"
#include "scene/scene.h"
#include "scene/toolbox.h"

namespace frana {

/// The barriers of a case on a terrain, to be shown. Those given as meshes have neither outline nor line, nor a shape.
/// UserError when a file is not there any more. Remarks go to `log`.
std::vector<Barrier> barriers_of_case(const CaseFile& file, const GisReader& reader, const Raster& bed,
                                      std::vector<std::string>& log);

}  // namespace frana
