#include "convert/paper_errors.h"

#include <cmath>

#include "base/compensated_sum.h"

namespace frana {

ConversionErrors conversion_errors(Index columns, const std::function<ErrorColumn(Index)>& column, double spacing,
                                   const ExactTotals& exact) {
    ConversionErrors errors;
    CompensatedSum volume, mass, momentum;
    for (Index p = 0; p < columns; ++p) errors.points += static_cast<double>(layer_count(column(p).depth, spacing));
    for (Index p = 0; p < columns; ++p) {
        const ErrorColumn c = column(p);
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
    // Each point is a column of one layer.
    const auto column = [&](Index k) {
        const auto at = static_cast<std::size_t>(k);
        return ErrorColumn{0.0, points.mass[at], points.volume[at], points.mass[at] * points.velocity[3 * at]};
    };
    return conversion_errors(static_cast<Index>(points.count()), column, 1.0, exact);
}

}  // namespace frana
