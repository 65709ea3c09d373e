#pragma once
#include <filesystem>

#include "checks/fuzz/cfl_map.h"

namespace frana {

/// The largest stable scheme.cfl over the points a cell: a panel a shape function, a curve a transfer. Without a
/// renderer says so on stderr and makes no file.
void draw_cfl_map(const std::vector<fuzz::CflRow>& rows, const std::filesystem::path& png);

}  // namespace frana
