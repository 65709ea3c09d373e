#pragma once
// What a run brought to the gauges of its case, for the report.
#include <filesystem>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace frana {

/// A gauge's speeds [m/s], 0 where its depth [m] is too small to count.
std::vector<double> speeds_that_count(const std::vector<double>& depth, std::vector<double> speed,
                                      double footprint_depth);

/// A section of report.md: place, arrival and largest values of each gauge, from the series in gauges/ that
/// figures/gauges_flow.png draws. It has arrived once it is deeper than `footprint_depth` [m]. Empty without gauges. A
/// gauge whose series cannot be read has a row that says so. Where flow becomes bed, it says that depths leave that out.
std::string gauge_section(const std::vector<Gauge>& gauges, double footprint_depth, bool becomes_bed,
                          const std::filesystem::path& run_dir);

}  // namespace frana
