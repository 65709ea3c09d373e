#include "ensemble/calibration.h"

#include <algorithm>

namespace frana {

std::vector<double> values_of(const Calibration& c, std::size_t key) {
    std::vector<double> all;
    for (const auto& u : c.posterior.points()) all.push_back(c.plan.vary[key].distribution.number(u[key]));
    return all;
}

std::vector<KeyPair> pairs_of(const Calibration& c) {
    const std::vector<double> w = c.posterior.weights();
    std::vector<KeyPair> all;
    for (std::size_t b = 1; b < c.plan.vary.size(); ++b)
        for (std::size_t a = 0; a < b; ++a)
            all.push_back(
                {c.plan.vary[a].key, c.plan.vary[b].key, correlation_of(values_of(c, a), values_of(c, b), w)});
    return all;
}

std::vector<double> density_of(const Calibration& c, std::size_t key) {
    constexpr std::size_t bins = 20;
    std::vector<double> density(bins, 0.0);
    const std::vector<double> w = c.posterior.weights();
    for (std::size_t i = 0; i < w.size(); ++i) {
        const auto bin = static_cast<std::size_t>(c.posterior.points()[i][key] * static_cast<double>(bins));
        density[std::min(bins - 1, bin)] += w[i] * static_cast<double>(bins);
    }
    return density;
}

}  // namespace frana
