#include "convert/profile.h"

#include <algorithm>
#include <cmath>

#include "base/compensated_sum.h"

namespace frana {

double profile_value(VelocityProfile profile, double s) {
    switch (profile) {
        case VelocityProfile::plug:
            return 1.0;
        case VelocityProfile::linear:
            return 2.0 * s;
        case VelocityProfile::parabolic:
            return 1.5 * s * (2.0 - s);
        case VelocityProfile::bagnold:
            return 5.0 / 3.0 * (1.0 - std::pow(1.0 - s, 1.5));
    }
    return 1.0;
}

double exact_energy_factor(VelocityProfile profile) {
    switch (profile) {
        case VelocityProfile::plug:
            return 1.0;
        case VelocityProfile::linear:
            return 4.0 / 3.0;
        case VelocityProfile::parabolic:
            return 6.0 / 5.0;
        case VelocityProfile::bagnold:
            return 5.0 / 4.0;
    }
    return 1.0;
}

Index layer_count(double depth, double spacing) {
    constexpr double kDigits = 1e-7, kMost = 1e18;
    if (depth >= kMost * spacing) return static_cast<Index>(kMost);
    return static_cast<Index>(std::clamp(std::floor(depth / spacing * (1.0 + kDigits)), 1.0, kMost));
}

std::vector<double> layer_heights(Layers layers, Index count) {
    std::vector<double> heights(static_cast<std::size_t>(count));
    const bool ends = layers == Layers::end_points && count > 1;
    for (Index i = 0; i < count; ++i)
        heights[static_cast<std::size_t>(i)] = ends ? static_cast<double>(i) / static_cast<double>(count - 1)
                                                    : (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    return heights;
}

std::vector<double> layer_speeds(VelocityProfile profile, const std::vector<double>& heights) {
    std::vector<double> speeds(heights.size());
    CompensatedSum sum;
    for (std::size_t i = 0; i < heights.size(); ++i) {
        speeds[i] = profile_value(profile, heights[i]);
        sum.add(speeds[i]);
    }
    const double mean = sum.value() / static_cast<double>(heights.size());
    for (double& speed : speeds) speed /= mean;
    return speeds;
}

double layer_energy_factor(const std::vector<double>& speeds) {
    CompensatedSum sum;
    for (const double speed : speeds) sum.add(speed * speed);
    return sum.value() / static_cast<double>(speeds.size());
}

}  // namespace frana
