#include "coupling/run_up.h"

#include <algorithm>
#include <cmath>

namespace frana {

double RunUp::level() {
    constexpr double kAbove = 1e-3;    // of the mass
    constexpr std::size_t kDrops = 2;  // points that are spray by themselves
    if (reached_.empty()) return -INFINITY;
    std::make_heap(reached_.begin(), reached_.end());
    double above = 0.0;
    std::size_t passed = 0;
    while (reached_.size() > 1) {
        above += reached_.front().second;
        if (passed >= kDrops && above > kAbove * mass_) break;
        std::pop_heap(reached_.begin(), reached_.end());
        reached_.pop_back(), ++passed;
    }
    return reached_.front().first;
}

}  // namespace frana
