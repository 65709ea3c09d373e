#pragma once
#include <string>
#include <vector>

#include "scene/case_file.h"
#include "scene/toolbox.h"

namespace frana {

/// A key that holds points, or names a vector file of one line, which is brought to `crs_wkt`. Coincident points are
/// dropped. Throws UserError; remarks go to `log`.
Polyline read_line(const CaseFile& file, const std::string& key, const GisReader& reader, const std::string& crs_wkt,
                   std::vector<std::string>& log);

/// Likewise a key that holds the corners of an area, or names a vector file of polygons.
Polygons read_outline(const CaseFile& file, const std::string& key, const GisReader& reader, const std::string& crs_wkt,
                      std::vector<std::string>& log);

}  // namespace frana
