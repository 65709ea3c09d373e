#include "compare/deposit.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "compare/pixel_pairs.h"

namespace frana {

Raster with_deposit(const Raster& final_depth, const Raster* deposited) {
    Raster lying = final_depth;
    if (!deposited) return lying;
    expect(deposited->values.size() == lying.values.size(), "rasters of one run have the same pixels");
    for (std::size_t k = 0; k < lying.values.size(); ++k)
        if (!std::isnan(deposited->values[k])) lying.values[k] += deposited->values[k];
    return lying;
}

Raster deepest_cover(const Raster& peak_depth, const Raster& lying) {
    Raster cover = peak_depth;
    expect(lying.values.size() == cover.values.size(), "rasters of one run have the same pixels");
    for (std::size_t k = 0; k < cover.values.size(); ++k) cover.values[k] = std::fmax(cover.values[k], lying.values[k]);
    return cover;
}

double volume_of(const Raster& depth) {
    double sum = 0.0;
    for (const double h : depth.values)
        if (h > 0.0) sum += h;
    return sum * depth.geometry.cell * depth.geometry.cell;
}

DepositErrors deposit_errors(const Raster& simulated, const Raster& surveyed, double limit) {
    DepositErrors errors;
    double absolute = 0.0, square = 0.0;
    Index compared = 0;
    for_each_pair(simulated, surveyed, [&](Index, Index, double value, double theirs) {
        const double ours = std::isnan(value) ? 0.0 : value;
        if (std::isnan(theirs)) {
            errors.unsurveyed_volume += ours;
            return;
        }
        errors.simulated_volume += ours;
        errors.surveyed_volume += theirs;
        if (theirs < 0.0) ++errors.negative;
        if (!(ours > limit || theirs > limit)) return;
        ++compared;
        absolute += std::abs(ours - theirs);
        square += (ours - theirs) * (ours - theirs);
    });
    const double pixel = surveyed.geometry.cell * surveyed.geometry.cell;
    errors.simulated_volume *= pixel;
    errors.surveyed_volume *= pixel;
    errors.unsurveyed_volume *= pixel;
    errors.compared_area = static_cast<double>(compared) * pixel;
    errors.mae = compared > 0 ? absolute / static_cast<double>(compared) : Raster::nodata;
    errors.rmse = compared > 0 ? std::sqrt(square / static_cast<double>(compared)) : Raster::nodata;
    return errors;
}

}  // namespace frana
