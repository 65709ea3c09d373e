#include "coupling/bed_friction.h"

#include <algorithm>
#include <cmath>

namespace frana {

double friction_of_flow(const Scene& scene, double depth, double cosine, double speed) {
    const double least = friction_at_rest(scene.bed_law);
    if (!(depth > 0.0) || !(speed > 0.0)) return least;
    const double normal_gravity = scene.gravity * cosine;
    const BedState bed{normal_gravity, depth * cosine, 1.0, cosine, scene.gravity, scene.density};
    constexpr double kShort = 2e-5;  // [s], in which no flow changes much
    const double slower =
        std::visit([&](const auto& law) { return law.speed_after(bed, speed, speed, kShort); }, scene.bed_law);
    return std::max(least, (speed - slower) / (kShort * normal_gravity));
}

double BedFriction::coefficient(const Vec3& x) const {
    const GridGeometry& g = map_.grid();
    const auto cell = [](double at, Index count) {
        return std::clamp<Index>(static_cast<Index>(std::floor(at)), 0, std::max<Index>(0, count - 2));
    };
    const double u = (x[0] - g.x0) / g.cell, v = (x[1] - g.y0) / g.cell;
    const Index i = cell(u, g.nx), j = cell(v, g.ny), k = j * g.nx + i;
    const double a = std::clamp(u - static_cast<double>(i), 0.0, 1.0),
                 b = std::clamp(v - static_cast<double>(j), 0.0, 1.0);
    const auto between = [&](auto&& of) {
        return (1.0 - b) * ((1.0 - a) * of(k) + a * of(k + 1)) + b * ((1.0 - a) * of(k + g.nx) + a * of(k + g.nx + 1));
    };
    const double depth = between([&](Index n) { return map_.depth(n); });
    const double cosine = between([&](Index n) { return map_.cosine(n); });
    const double speed = between([&](Index n) { return map_.velocity(n).norm(); });
    return friction_of_flow(scene_, depth, cosine, speed);
}

}  // namespace frana
