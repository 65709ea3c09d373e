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

void LayerDepth::add(const Vec2& place, double volume) {
    const auto square = [&](double at) { return static_cast<Index>(std::floor(at / side_)); };
    parts_.emplace_back(std::pair(square(place.x()), square(place.y())), volume);
}

double LayerDepth::largest() {
    std::sort(parts_.begin(), parts_.end());
    double most = 0.0, volume = 0.0;
    for (std::size_t n = 0; n < parts_.size(); ++n) {
        volume = n > 0 && parts_[n].first == parts_[n - 1].first ? volume + parts_[n].second : parts_[n].second;
        most = std::max(most, volume);
    }
    return most / (side_ * side_);
}

}  // namespace frana
