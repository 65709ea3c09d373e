#pragma once
#include <vector>

#include "law/erosion/state.h"
#include "law/key.h"

namespace frana::erosion {

/// A rate that holds until the bed is as deep as its stress allows (Frank et al. 2015, Nat. Hazards Earth Syst. Sci. 15,
/// 2569, of RAMMS). E = rate while the depth taken is below e_m = k (tau - tau_c), and none for tau <= tau_c. Their
/// numbers are of the debris flows of the Illgraben. A deposit counts as not taken. Where e_m is less than its depth,
/// it is taken more slowly by that share. So a stress just above the threshold does not take all of it.
struct Shear {
    double erosion_rate = 0.025;     ///< [m/s]
    double threshold = 1000.0;       ///< tau_c [Pa]
    double depth_per_stress = 1e-4;  ///< k [m/Pa]

    static constexpr const char* name = "shear";
    static constexpr const char* is = "";
    static constexpr bool kProportional = false;
    static constexpr bool kSeesStress = true;
    static constexpr bool kSeesEroded = true;
    static constexpr bool kSeesLeft = false;
    static std::vector<laws::Key<Shear>> keys() {
        return {{&Shear::erosion_rate, "rate", "m/s", ranges::positive, "speed at which the bed sinks, normal to it",
                 laws::Missing::usual},
                {&Shear::threshold, "threshold", "Pa", ranges::not_negative, "basal stress up to which the bed resists",
                 laws::Missing::usual},
                {&Shear::depth_per_stress, "depth_per_stress", "m/Pa", ranges::positive,
                 "depth that can be taken at most, for each pascal above the threshold", laws::Missing::usual}};
    }

    /// src/shallow/THEORY.md (69)
    template <class Real>
    [[gnu::always_inline]] Real rate(const StateOf<Real>& s) const {
        const Real none{}, one = none + 1.0;
        const Real deepest = depth_per_stress * (s.stress - max(s.bears, none + threshold));
        const Real below = max((deepest - s.eroded) / s.dt, none);
        const auto covered = s.lies > none;
        const Real share = min(max(deepest, none) / select(covered, s.lies, one), one);
        return min(select(covered, s.lies / s.dt + below, below), erosion_rate * select(covered, share, one));
    }
};

}  // namespace frana::erosion
