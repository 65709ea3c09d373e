#pragma once
// The files of a survey, named by a case or on a command line. Those that need care are read here.
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "scene/toolbox.h"

namespace frana {

class CaseFile;

/// Empty: not given.
struct SurveyFiles {
    std::filesystem::path footprint, deposit, path, bed_change;
    double bed_change_noise = 0.1;  ///< [m]
};

/// [survey] of a case.
SurveyFiles survey_files(const CaseFile& file);

/// The one line of a vector file. UserError unless it holds one, with a length and a part within `extent` of the terrain
/// (xmin, ymin, xmax, ymax).
Polyline read_survey_path(const GisReader& reader, const std::filesystem::path& file,
                          const std::array<double, 4>& extent, const std::string& crs_wkt,
                          std::vector<std::string>& log);

/// Thickness of a surveyed deposit [m], as GisReader::read_deposit. UserError for a raster of elevations.
Raster read_survey_deposit(const GisReader& reader, const std::filesystem::path& file, const GridGeometry& grid,
                           const std::string& crs_wkt, std::vector<std::string>& log);

/// Difference of two surveys [m] on the pixels of `grid`. It is widened to all of the raster, as for a deposit. NaN:
/// not surveyed. UserError when no pixel of `grid` was surveyed.
Raster read_bed_change(const GisReader& reader, const std::filesystem::path& file, const GridGeometry& grid,
                       const std::string& crs_wkt, std::vector<std::string>& log);

}  // namespace frana
