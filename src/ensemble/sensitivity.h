#pragma once
// Which of the keys an outcome depends on.
#include <optional>
#include <vector>

#include "ensemble/design.h"
#include "ensemble/statistics.h"

namespace frana {

/// What a key means for an outcome, of runs whose samples were made for that.
struct Sensitivity {
    double first =
        0.0;  ///< "saltelli": share of the variance by this key alone (Sobol's S) [1]. "morris": mean effect, without
              ///< its sign, of going through the key's whole distribution (mu*), in the outcome's unit
    double total =
        0.0;  ///< "saltelli": share by this key and all that goes with it (T) [1]; "morris": the effects' spread (sigma)
};

/// How many runs each sample of `samples` in the file becomes, with so many keys. It is d + 2 of "saltelli", d + 1 of
/// "morris".
Index runs_each(Method method, Index keys);

/// Points of both: `count` groups of runs_each(), one after the other.
/// saltelli: A, B, then A with one key of B each (Saltelli 2002). A and B are of Sobol's sequence in twice the keys.
/// morris: ways through a grid of four levels (Morris 1991). They change one key after the other, each by half of its
/// distribution.
Design make_sensitivity_design(Method method, Index count, Index keys, std::uint64_t seed);

/// Indices of outcomes of the same runs. S and T by Jansen (1999).
class SensitivityOfRuns {
public:
    /// `has`: of each sample, whether its run has an answer; otherwise its group does not count.
    SensitivityOfRuns(Method method, const Design& design, const std::vector<bool>& has);

    /// By key, of the outcomes of all samples; those of groups that do not count are not used. Empty where fewer than
    /// two groups count, or nothing varies by more than `noise`, the relative round-off of the outcomes.
    std::vector<Sensitivity> of(const std::vector<double>& outcomes, double noise) const;

private:
    std::vector<Sensitivity> by_sobol(const std::vector<double>& outcomes, double noise) const;
    std::vector<Sensitivity> by_morris(const std::vector<double>& outcomes, double noise) const;

    Method method_;
    const Design& design_;
    std::size_t keys_ = 0;
    std::vector<std::size_t> starts_;  ///< first samples of the groups that count
};

/// The same of one outcome: nothing where a run has none.
std::vector<Sensitivity> sensitivities(Method method, const Design& design,
                                       const std::vector<std::optional<double>>& outcomes);

/// Maps of indices. By key, the first and the total index of a field of all runs on each pixel. NaN where it does not vary.
struct SensitivityMaps {
    std::vector<Raster> first, total;
};
/// `samples`: of the runs that `pixels` holds, in its order.
SensitivityMaps sensitivity_maps(Method method, const Design& design, const std::vector<Index>& samples,
                                 const PixelValues& pixels);

}  // namespace frana
