#include "shallow/sub_points.h"

namespace frana {

template <class Real>
void deposit_quadratic_sub_points(Flow& flow, Index p) {
    deposit_sub_points<Quadratic, Real>(flow, p);
}

template void deposit_quadratic_sub_points<double>(Flow&, Index);
template void deposit_quadratic_sub_points<float>(Flow&, Index);

}  // namespace frana
