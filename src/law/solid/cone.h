#pragma once
// What granular laws share: an elastic solid in a cone of strength, whose flow conserves the volume.
#include <cmath>

#include "law/solid/elastic.h"

namespace frana::solid {

/// Volume over that without stress of points that have parted: twice as far apart in each direction. What flies apart
/// further leaves room between points, which need not close before they carry pressure again.
constexpr double kLoosest = 8.0;

/// A step of granular material, src/solid3d/THEORY.md (22). State: logarithmic elastic strain [1], then the volume gained
/// at the apex, ln J [1]. `apex` is the volume strain at which nothing is carried any more [1]. `left(size, room)` is the
/// |s| that flow leaves of the trial's [Pa], where the volume strain is `room` below the apex. At the apex the material
/// parts. The volume it gained has to be closed before it carries pressure again (Tampubolon et al. 2017, sec. 4.3.4).
template <class Real, class Left>
[[gnu::always_inline]] inline void flow_in_cone(const DeformationOf<Real>& d, Real& j, Given<Real>* state,
                                                const Elastic& elastic, double apex, const Left& left) {
    const Square<Real> grown = grown_in<Real>(d);
    const SymOf<Real> trial = carried<Real>(SymOf<Real>::read(state), grown);
    j *= volume_ratio<Real>(grown);
    const Real volume = trial.trace() + state[6];
    const auto parted = volume >= apex;
    const SymOf<Real> shear_strain = trial.deviator();
    const Real size = 2.0 * elastic.shear * shear_strain.norm();
    const Real strength = left(size, apex - volume);
    const Real yielding = strength / select(size > 0.0, size, Real{} + 1.0);
    const Real kept = select(parted, Real{}, select(size > strength, yielding, Real{} + 1.0));
    (shear_strain * kept).plus_isotropic(select(parted, Real{} + apex, volume) / 3.0).write(state);
    const Real gap = select(parted, volume - apex, Real{}), widest = Real{} + std::log(kLoosest);
    state[6] = min(gap, widest);
    j = min(j, Real{} + kLoosest);
}

}  // namespace frana::solid
