#pragma once
// A study whose flow left the terrain: its figures agree on any cell where they end at the terrain's edge.
#include "run/converge/study.h"

namespace frana {

/// Says so where more than a noticeable share left in one of the runs. A verdict that the answer has converged is taken
/// back: what was judged on the terrain stays in its sentence.
void doubt_left(ConvergenceStudy& study);

}  // namespace frana
