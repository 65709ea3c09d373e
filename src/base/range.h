#pragma once
// The numbers that a key of a case may have.
#include <limits>
#include <string>

namespace frana {

/// Interval of numbers; an open end excludes its limit.
struct Range {
    double low = -std::numeric_limits<double>::infinity();
    double high = std::numeric_limits<double>::infinity();
    bool low_open = false;
    bool high_open = false;

    bool holds(double value) const;
    bool is_all() const;
    std::string text() const;  ///< "above 0 and at most 1", empty for all numbers
    bool operator==(const Range& other) const {
        return low == other.low && high == other.high && low_open == other.low_open && high_open == other.high_open;
    }
};

/// Words for ranges.
namespace ranges {

inline const double infinity = std::numeric_limits<double>::infinity();
inline const Range any_number{};
inline const Range positive{0.0, infinity, true, false};
inline const Range not_negative{0.0, infinity, false, false};
inline const Range fraction{0.0, 1.0, false, false};

inline Range between(double low, double high) { return {low, high, false, false}; }
inline Range at_least(double low) { return {low, infinity, false, false}; }
inline Range above_to(double low, double high) { return {low, high, true, false}; }

}  // namespace ranges
}  // namespace frana
