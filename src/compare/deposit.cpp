#include "compare/deposit.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace frana {

Raster with_deposit(const Raster& final_depth, const Raster* deposited) {
    Raster lying = final_depth;
    if (!deposited) return lying;
    expect(deposited->values.size() == lying.values.size(), "rasters of one run have the same pixels");
    for (std::size_t k = 0; k < lying.values.size(); ++k)
        if (!std::isnan(deposited->values[k])) lying.values[k] += deposited->values[k];
    return lying;
}

DepositErrors deposit_errors(const Raster& simulated, const Raster& surveyed, double limit) {
    const GridGeometry &inner = simulated.geometry, &outer = surveyed.geometry;
    expect(inner.cell == outer.cell, "two deposits on the same pixels");
    const auto left = static_cast<Index>(std::lround((inner.x0 - outer.x0) / outer.cell));
    const auto low = static_cast<Index>(std::lround((inner.y0 - outer.y0) / outer.cell));
    DepositErrors errors;
    double absolute = 0.0, square = 0.0;
    Index compared = 0;
    for (Index j = 0; j < outer.ny; ++j)
        for (Index i = 0; i < outer.nx; ++i) {
            const Index si = i - left, sj = j - low;
            const bool there = si >= 0 && sj >= 0 && si < inner.nx && sj < inner.ny;
            const double value = there ? simulated.at(si, sj) : 0.0;
            const double ours = std::isnan(value) ? 0.0 : value, theirs = surveyed.at(i, j);
            if (std::isnan(theirs)) {
                errors.unsurveyed_volume += ours;
                continue;
            }
            errors.simulated_volume += ours;
            errors.surveyed_volume += theirs;
            if (theirs < 0.0) ++errors.negative;
            if (!(ours > limit || theirs > limit)) continue;
            ++compared;
            absolute += std::abs(ours - theirs);
            square += (ours - theirs) * (ours - theirs);
        }
    const double pixel = outer.cell * outer.cell;
    errors.simulated_volume *= pixel;
    errors.surveyed_volume *= pixel;
    errors.unsurveyed_volume *= pixel;
    errors.compared_area = static_cast<double>(compared) * pixel;
    errors.mae = compared > 0 ? absolute / static_cast<double>(compared) : Raster::nodata;
    errors.rmse = compared > 0 ? std::sqrt(square / static_cast<double>(compared)) : Raster::nodata;
    return errors;
}

}  // namespace frana
