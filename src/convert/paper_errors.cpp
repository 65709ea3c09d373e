#include "convert/paper_errors.h"

#include <cmath>

#include "base/compensated_sum.h"

namespace frana {

ConversionErrors conversion_errors(Index particles, const std::function<ErrorParticle(Index)>& particle, double spacing,
                                   const ExactTotals& exact) {
    ConversionErrors errors;
    CompensatedSum volume, mass, momentum;
    for (Index p = 0; p < particles; ++p) errors.points += static_cast<double>(layer_count(particle(p).depth, spacing));
    for (Index p = 0; p < particles; ++p) {
        const ErrorParticle c = particle(p);
        const auto layers = static_cast<double>(layer_count(c.depth, spacing));
        const double dm = c.mass / layers - exact.mass / errors.points;
        const double dp = c.momentum / layers - exact.momentum / errors.points;
        volume.add(c.volume);
        mass.add(c.volume * dm * dm);
        momentum.add(c.volume * dp * dp);
    }
    errors.mass = std::sqrt(mass.value() / volume.value());
    errors.momentum = std::sqrt(momentum.value() / volume.value());
    return errors;
}

ConversionErrors conversion_errors(const SolidPoints& points, const ExactTotals& exact) {
    // Each point is a particle of one layer.
    const auto particle = [&](Index k) {
        const auto at = static_cast<std::size_t>(k);
        return ErrorParticle{0.0, points.mass[at], points.volume[at], points.mass[at] * points.velocity[3 * at]};
    };
    return conversion_errors(static_cast<Index>(points.count()), particle, 1.0, exact);
}

}  // namespace frana
