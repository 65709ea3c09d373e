#pragma once
// Numbers that one advises.
#include <cmath>

namespace frana {

/// The largest of 1, 2, 2.5, 5, 10, ..., their tenths, hundredths and so on up to `most`, a number above 0.
inline double round_number_below(double most) {
    const double power = std::pow(10.0, std::floor(std::log10(most)));
    double best = power;
    for (const double step : {2.0, 2.5, 5.0})
        if (step * power <= most) best = step * power;
    return best;
}

}  // namespace frana
