#include "coupling/bed_friction.h"

#include <algorithm>
#include <cmath>

namespace frana {

double friction_of_flow(const Scene& scene, const Vec2& place, const FlowMap::Mean& flow) {
    const BedLaw law_here = bed_law_at(scene, place);
    const double least = friction_at_rest(law_here);
    if (!hangs_on_speed(law_here)) return least;
    // Mud at rest is held by its yield stress, as what creeps is.
    constexpr double kCreep = 1e-3;  // [m/s]
    const double speed = std::holds_alternative<bed::Bingham>(law_here) ? std::max(flow.speed, kCreep) : flow.speed;
    if (!(flow.depth > 0.0) || !(speed > 0.0)) return least;
    const double normal_gravity = scene.gravity * flow.cosine;
    const BedState bed{normal_gravity, flow.depth * flow.cosine, 1.0, flow.cosine, scene.gravity, scene.density};
    constexpr double kShort = 2e-5;  // [s], in which no flow changes much
    const double slower =
        std::visit([&](const auto& law) { return law.speed_after(bed, speed, speed, kShort); }, law_here);
    return std::max(least, (speed - slower) / (kShort * normal_gravity));
}

double BedFriction::coefficient(const Vec3& x) const {
    FlowMap::Mean flow = map_.mean_at(x.head<2>());
    // No flow is thinner than its points. Where they lie apart, as in spray, the map's mean is.
    if (flow.depth > 0.0) flow.depth = std::max(flow.depth, scene_.solid->spacing);
    return friction_of_flow(scene_, x.head<2>(), flow);
}

}  // namespace frana
