#pragma once
// Round numbers for axes, colour bars, contours and scale bars.
#include <string>
#include <utility>
#include <vector>

namespace frana {

/// The largest of ..., 0.1, 0.2, 0.5, 1, 2, 5, 10, ... that is <= value (> 0).
double round_down_125(double value);
/// The smallest of the same series that is >= value (> 0).
double round_up_125(double value);
/// A little above value (> 0), with one or two digits. It is 1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8 times a power of ten.
double round_limit(double value);

struct Ticks {
    std::vector<double> at;
    std::vector<std::string> labels;  ///< with the decimals that the step needs
};

/// Multiples of a 1-2-5 step in [low, high], at most `most` (>= 2) of them unless only one would be left.
Ticks ticks_between(double low, double high, int most);
/// Powers of ten in [low, high] (both > 0), thinned to at most `most`.
Ticks log_ticks(double low, double high, int most);

/// A number with as many decimals as its step needs.
std::string with_step(double value, double step);
/// A length for people: "50 m", "0.2 m", "1.5 km".
std::string length_text(double metres);
/// "peak depth [m]" -> {"peak depth", "m"}; the unit is empty when there is none.
std::pair<std::string, std::string> name_and_unit(const std::string& label);

}  // namespace frana
