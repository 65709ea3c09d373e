#pragma once
// What the bed law of the case is to 3D points that slide over the ground.
#include "coupling/flow_map.h"
#include "scene/scene.h"
#include "solid3d/surfaces.h"

namespace frana {

/// The deceleration of the mean flow at a place over its normal acceleration, by the law of the nearest node. That flow
/// is as deep and as fast as the points and adjacent particles there on the whole. The lowest points are slower than
/// the rest where material shears. A bed law is one of the mean speed. Where no points stand in the map it is the
/// friction of the slowest flow. THEORY.md (12).
class BedFriction final : public SurfaceFriction {
public:
    /// Both outlive this. `map` may follow the points between steps.
    BedFriction(const Scene& scene, const FlowMap& map) : scene_(scene), map_(map) {}

    double coefficient(const Vec3& x) const override;

private:
    const Scene& scene_;
    const FlowMap& map_;
};

/// The friction coefficient of the scene's bed law at a place on the map. The flow there has that depth along gravity
/// [m] and that speed along the bed [m/s]. The cosine is that of the bed's slope.
double friction_of_flow(const Scene& scene, const Vec2& place, const FlowMap::Mean& flow);

}  // namespace frana
