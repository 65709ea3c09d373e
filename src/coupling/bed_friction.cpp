#include "coupling/bed_friction.h"

#include <algorithm>
#include <cmath>

namespace frana {

double friction_of_flow(const Scene& scene, double depth, double cosine, double speed) {
    const double least = friction_at_rest(scene.bed_law);
    // Mud at rest is held by its yield stress, as what creeps is.
    constexpr double kCreep = 1e-3;  // [m/s]
    if (std::holds_alternative<bed::Bingham>(scene.bed_law)) speed = std::max(speed, kCreep);
    if (!(depth > 0.0) || !(speed > 0.0)) return least;
    const double normal_gravity = scene.gravity * cosine;
    const BedState bed{normal_gravity, depth * cosine, 1.0, cosine, scene.gravity, scene.density};
    constexpr double kShort = 2e-5;  // [s], in which no flow changes much
    const double slower =
        std::visit([&](const auto& law) { return law.speed_after(bed, speed, speed, kShort); }, scene.bed_law);
    return std::max(least, (speed - slower) / (kShort * normal_gravity));
}

double BedFriction::coefficient(const Vec3& x) const {
    const FlowMap::Mean here = map_.mean_at(x.head<2>());
    return friction_of_flow(scene_, here.depth, here.cosine, here.speed);
}

}  // namespace frana
