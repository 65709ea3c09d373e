#pragma once
#include "terrain/outline_area.h"

namespace frana {

/// Area within rings that may overlap or cross, each place counted once [m2]. Exact but for round-off. Rings are
/// oriented as those of rings_of(). What is the wrong way round counts for nothing. Cost: edges times those at the same height.
double union_area(const Rings& rings);

}  // namespace frana
