#pragma once
// A finished run read back for pictures and comparisons.
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "run/folder/run_figures.h"
#include "scene/case_file.h"

namespace frana {

/// The title in the folder's run.json. UserError when the folder holds no finished run.
std::string title_of_run(const std::filesystem::path& run_dir);

/// The case of the folder's resolved.toml; files that it names may have gone. UserError when it is not there.
CaseFile case_of_run(const std::filesystem::path& run_dir);

/// Of the elevation model that the case names, the nodes that `choose` wants of it. UserError when it has gone.
Raster dem_of_case(const CaseFile& run_case, const std::function<NodeBox(const Raster& whole)>& choose);

/// What became of its releases that were to enter later: names, and times of those that did. UserError without run.json.
std::vector<LateEntry> late_of_run(const std::filesystem::path& run_dir);

/// Title, footer, limit of the covered area, rasters and terrain of a run, from its files. The terrain is that of
/// terrain.vti, else the elevation model that the case names, on the rasters' nodes. Without either it is empty, and
/// `warnings` says so. Profiles, gauges and the survey are left out. UserError when the folder holds no finished run.
FigureSource read_finished_run(const std::filesystem::path& run_dir, std::vector<std::string>& warnings);

/// Profiles, gauges, sections, inflows and barriers of the run's case for the maps of `source`. What names a file that
/// has gone is left out, and `warnings` says so. UserError without resolved.toml.
void read_places(FigureSource& source, std::vector<std::string>& warnings);

}  // namespace frana
