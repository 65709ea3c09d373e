#pragma once
// Which of the keys an outcome hangs on.
#include <optional>
#include <vector>

#include "ensemble/design.h"

namespace frana {

/// What a key means for an outcome, of runs whose samples were made for that.
struct Sensitivity {
    double first =
        0.0;  ///< "saltelli": share of the variance by this key alone (Sobol's S) [1]; "morris": mean effect, without
              ///< its sign, of going through the key's whole distribution (mu*), in the outcome's unit
    double total =
        0.0;  ///< "saltelli": share by this key and all that goes with it (T) [1]; "morris": the effects' spread (sigma)
};

/// How many runs each sample of `samples` in the file becomes, with so many keys: d + 2 of "saltelli", d + 1 of "morris".
Index runs_each(Method method, Index keys);

/// Points of both: `count` groups of runs_each(), one after the other.
/// saltelli: A, B, then A with one key of B each (Saltelli 2002), A and B of Sobol's sequence in twice the keys.
/// morris: ways through a grid of four levels that change one key after the other, each by half of its distribution (Morris
/// 1991).
Design make_sensitivity_design(Method method, Index count, Index keys, std::uint64_t seed);

/// By key. `outcomes`: of each sample, nothing where its run has no answer; its group then does not count. S and T by Jansen
/// (1999). Empty where fewer than two groups count, or nothing varies.
std::vector<Sensitivity> sensitivities(Method method, const Design& design,
                                       const std::vector<std::optional<double>>& outcomes);

}  // namespace frana
