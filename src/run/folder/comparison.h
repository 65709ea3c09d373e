#pragma once
// A comparison with a survey as files and for people.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "compare/comparison.h"
#include "run/folder/products.h"
#include "scene/survey_files.h"

namespace frana {

/// What lies at the end without free water: all but that is a deposit. Nothing without that raster [m].
std::optional<Raster> solids_at_end(const std::vector<ProductRaster>& rasters);

/// The run's rasters held against a survey that was read. `bed` is null when the terrain is not known; `starts` and `later`:
/// SimulatedRun's `starts` and `released_later`.
Comparison compare_rasters(const std::vector<ProductRaster>& rasters, const Raster* bed, double limit,
                           const Survey& survey, const std::vector<Vec2>& starts = {}, const Raster* later = nullptr);

/// Reads the files onto the grid of `like` (a raster of the run); any may be empty. Remarks go to `log`.
/// UserError for a file that cannot be used.
Survey read_survey_files(const SurveyFiles& files, const Raster& like, std::vector<std::string>& log);

/// compare.json as text: contract in the README. Numbers that do not exist are null.
std::string comparison_json(const Comparison& comparison);

/// The scores as `json` and, where changes of the bed were compared along a path, NAME_bed_change.csv in `run_dir`. For
/// each step of the path that has distance, middle and volumes. Also what all steps so far gave less what they took.
/// UserError when they cannot be written.
void write_scores(const std::filesystem::path& run_dir, const std::filesystem::path& json, const Comparison& comparison,
                  const std::string& name = "compare");

/// The scores as a section of report.md: heading, tables, remarks. No picture.
std::string comparison_section(const Comparison& comparison);

/// The most telling scores in a line.
std::string comparison_line(const Comparison& comparison);

}  // namespace frana
