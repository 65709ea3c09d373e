#include "compare/bed_change.h"

#include <algorithm>
#include <cmath>

#include "compare/pixel_pairs.h"
#include "compare/runout.h"

namespace frana {
namespace {

void add(BedVolumes& volumes, double volume) {
    (volume < 0.0 ? volumes.eroded : volumes.deposited) += std::abs(volume);
}

double beyond(double change, double noise) { return std::abs(change) > noise ? change : 0.0; }

}  // namespace

Raster surface_change(const Raster& bed_change, const Raster* lying, const Raster* arrival_time, const Raster* later) {
    Raster change = bed_change;
    for (std::size_t k = 0; k < change.values.size(); ++k) {
        const auto known = [](double value) { return std::isnan(value) ? 0.0 : value; };
        change.values[k] = known(change.values[k]) + (lying ? known(lying->values[k]) : 0.0);
        if (arrival_time && arrival_time->values[k] == 0.0) change.values[k] = Raster::nodata;
        if (later && later->values[k] > 0.0) change.values[k] = Raster::nodata;
    }
    return change;
}

BedChangeErrors bed_change_errors(const Raster& simulated, const Raster& surveyed, double noise) {
    BedChangeErrors errors;
    errors.noise = noise;
    const double pixel = surveyed.geometry.cell * surveyed.geometry.cell;
    double absolute = 0.0, square = 0.0;
    Index compared = 0;
    for_each_pair(simulated, surveyed, [&](Index, Index, double ours, double theirs) {
        if (std::isnan(ours)) return add(errors.release, std::isnan(theirs) ? 0.0 : pixel * beyond(theirs, noise));
        if (std::isnan(theirs)) return add(errors.unsurveyed, pixel * beyond(ours, noise));
        if (std::abs(ours) <= noise) add(errors.within_noise, pixel * ours);
        const double a = beyond(ours, noise), b = beyond(theirs, noise);
        if (a == 0.0 && b == 0.0) return;
        add(errors.simulated, pixel * a);
        add(errors.surveyed, pixel * b);
        const bool alike = (a < 0.0 && b < 0.0) || (a > 0.0 && b > 0.0);
        if (!alike) errors.misplaced += pixel * std::abs(a - b);
        ++compared;
        absolute += std::abs(ours - theirs);
        square += (ours - theirs) * (ours - theirs);
    });
    const auto count = static_cast<double>(compared);
    errors.compared_area = count * pixel;
    errors.mae = compared > 0 ? absolute / count : Raster::nodata;
    errors.rmse = compared > 0 ? std::sqrt(square / count) : Raster::nodata;
    return errors;
}

std::vector<BedChangeStep> bed_change_along(const Polyline& path, const Raster& simulated, const Raster& surveyed,
                                            double noise) {
    const double length = length_of(path), pixel = surveyed.geometry.cell * surveyed.geometry.cell;
    if (!(length > 0.0)) return {};
    constexpr double most = 1e5;  // of a path that is drawn to nowhere
    const double count = std::min(most, std::ceil(length / (2.0 * surveyed.geometry.cell))), step = length / count;
    std::vector<BedChangeStep> steps(static_cast<std::size_t>(count));
    for (std::size_t k = 0; k < steps.size(); ++k) {
        steps[k].distance = (static_cast<double>(k) + 0.5) * step;
        steps[k].point = point_along(path, steps[k].distance);
    }
    for_each_pair(simulated, surveyed, [&](Index i, Index j, double ours, double theirs) {
        if (std::isnan(ours) || std::isnan(theirs)) return;
        const double a = beyond(ours, noise), b = beyond(theirs, noise);
        if (a == 0.0 && b == 0.0) return;
        const double along = place_along(path, {surveyed.geometry.x(i), surveyed.geometry.y(j)}).place;
        const double place = std::clamp(along / step, 0.0, count - 1.0);
        BedChangeStep& here = steps[static_cast<std::size_t>(place)];
        add(here.simulated, pixel * a);
        add(here.surveyed, pixel * b);
    });
    return steps;
}

}  // namespace frana
