#pragma once
#include <limits>
#include <string>
#include <vector>

#include "checks/bench/suite.h"

namespace frana::bench {

/// What the measured numbers are held against.
struct Gate {
    std::string what;
    double gate = 0.0, aim = 0.0;
    bool at_least = false;                                       ///< otherwise at most
    double measured = std::numeric_limits<double>::quiet_NaN();  ///< not measured
    bool met() const { return at_least ? measured >= gate : measured <= gate; }
};

std::vector<Gate> gates(const Report& report);

/// Whether every number of threads left the same bits.
bool same_bits(const Report& report);

}  // namespace frana::bench
