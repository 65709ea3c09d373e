#include "base/range.h"

#include <fmt/format.h>

#include <cmath>

namespace frana {

bool Range::holds(double value) const {
    const bool above = low_open ? value > low : value >= low;
    return above && (high_open ? value < high : value <= high);
}

bool Range::is_all() const { return std::isinf(low) && std::isinf(high); }

std::string Range::text() const {
    std::string limits;
    if (!std::isinf(low)) limits = fmt::format("{}{:g}", low_open ? "above " : "at least ", low);
    if (std::isinf(high)) return limits;
    return limits + fmt::format("{}{}{:g}", limits.empty() ? "" : " and ", high_open ? "below " : "at most ", high);
}

}  // namespace frana
