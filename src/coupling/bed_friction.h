#pragma once
// What the bed law of the case is to 3D points that slide over the ground.
#include "coupling/flow_map.h"
#include "scene/scene.h"
#include "solid3d/surfaces.h"

namespace frana {

/// The law's deceleration of a flow that is as deep and as fast as the points, and columns beside them, are there on the whole,
/// over its normal acceleration. The lowest points are slower than the rest where material shears, and a bed law is one of the mean speed. Where
/// no points stand in the map it is the friction of the slowest flow. THEORY.md (12).
class BedFriction final : public SurfaceFriction {
public:
    /// Both outlive this. `map` may follow the points between steps.
    BedFriction(const Scene& scene, const FlowMap& map) : scene_(scene), map_(map) {}

    double coefficient(const Vec3& x) const override;

private:
    const Scene& scene_;
    const FlowMap& map_;
};

/// The friction coefficient of the scene's bed law at a speed along the bed [m/s] under a flow of that depth along gravity [m].
/// `cosine`: of the bed's slope.
double friction_of_flow(const Scene& scene, double depth, double cosine, double speed);

}  // namespace frana
