#pragma once
#include <optional>
#include <string>

namespace frana {

/// Metres per second of a unit of speed as files write it: "km/h", "m s-1", "knots". Without one it is 1. Nothing: it is
/// none that is known here.
std::optional<double> metres_per_second(const std::string& unit);

}  // namespace frana
