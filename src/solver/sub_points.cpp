#include "solver/sub_points.h"

namespace frana {

void deposit_quadratic_sub_points(Flow& flow, Index p) { deposit_sub_points<Quadratic>(flow, p); }

}  // namespace frana
