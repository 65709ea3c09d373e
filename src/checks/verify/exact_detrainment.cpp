#include "checks/verify/exact_detrainment.h"

#include <cmath>

namespace frana::verify {

SlabState DetrainedSlab::at(double t) const {
    const double u = speed + acceleration * t;
    return {u, speed * t + 0.5 * acceleration * t * t,
            thickness - pressure / (density * acceleration) * std::log(u / speed)};
}

std::vector<Residual> detrained_slab_residuals() {
    const DetrainedSlab slab;
    constexpr double kTime = 12.0, kShort = 1e-4;
    const double change = (slab.at(kTime + kShort).thickness - slab.at(kTime - kShort).thickness) / (2.0 * kShort);
    return {{"thickness of 20 s", slab.at(20.0).thickness - 1.768951, 5e-7},
            {"rho dh/dt = -K/u", slab.density * change * slab.at(kTime).speed / slab.pressure + 1.0, 1e-8}};
}

}  // namespace frana::verify
