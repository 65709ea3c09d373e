#pragma once
// Error over run time, and the worth of the scheme's components.
#include <filesystem>
#include <string>
#include <vector>

#include "checks/verify/problem.h"

namespace frana {

/// Runs the problems with several presets and points a cell, each on its own grids. By default they are those that
/// other codes were measured on. Draws their errors over wall time, together with the other codes', into a PNG. Prints
/// what it measures.
void draw_work_precision(std::vector<const verify::Problem*> problems, const std::filesystem::path& png);

/// Prints the table of the component study; also into `table` unless that is empty.
void print_study(const std::filesystem::path& table);

/// Whether all of these have blocks to show instead.
bool draws_blocks(const std::vector<const verify::Problem*>& problems);
/// The blocks of structured problems as they end, one picture each: PNG's name with theirs behind it.
void draw_blocks(const std::vector<const verify::Problem*>& problems, const std::filesystem::path& png);

}  // namespace frana
