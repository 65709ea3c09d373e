#pragma once
// A comparison with a survey as files and for people.
#include <filesystem>
#include <string>
#include <vector>

#include "compare/comparison.h"
#include "run/folder/products.h"

namespace frana {

/// A survey's files; the last two may be empty.
struct SurveyFiles {
    std::filesystem::path footprint, deposit, path;
};

/// The run's rasters held against a survey that was read. `bed` is null when the terrain is not known.
Comparison compare_rasters(const std::vector<ProductRaster>& rasters, const Raster* bed, double limit,
                           const Survey& survey);

/// Reads the files onto the grid of `like` (a raster of the run). Remarks go to `log`. UserError for a file that
/// cannot be used.
Survey read_survey_files(const SurveyFiles& files, const Raster& like, std::vector<std::string>& log);

/// compare.json as text: contract in the README. Numbers that do not exist are null.
std::string comparison_json(const Comparison& comparison);

/// The scores as a section of report.md: heading, tables, remarks. No picture.
std::string comparison_section(const Comparison& comparison);

/// The most telling scores in a line.
std::string comparison_line(const Comparison& comparison);

}  // namespace frana
