#pragma once
// How high material reaches at a barrier, without its spray.
#include <utility>
#include <vector>

#include "base/types.h"

namespace frana {

/// The elevation below which 99.9 % of the mass at a place lies at one moment. Single drops do not count: where there
/// are that many points, more than two have to be above it. Its memory is reused from one moment to the next.
class RunUp {
public:
    void begin() { reached_.clear(), mass_ = 0.0; }
    /// A point with its elevation [m] and mass [kg].
    void add(double elevation, double mass) { reached_.emplace_back(elevation, mass), mass_ += mass; }
    /// Of what was added since begin(); minus infinity without any [m]. Puts it out of order.
    double level();

private:
    std::vector<std::pair<double, double>> reached_;
    double mass_ = 0.0;
};

}  // namespace frana
