#pragma once
// The files that a calibration leaves, and what they say to people.
#include <filesystem>
#include <string>
#include <vector>

#include "ensemble/calibration.h"

namespace frana {

/// Writes calibrate.json, report.md, runs.csv, posterior.csv and the pictures. Returns their names. Throws UserError.
std::vector<std::string> write_calibration(const std::filesystem::path& dir, const Calibration& calibration);

/// For people: the best values, what is known of them, and how near the events are met.
std::string calibration_section(const Calibration& calibration);

}  // namespace frana
