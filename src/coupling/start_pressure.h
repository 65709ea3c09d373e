#pragma once
// The pressure that particles have on their bed when they become points.
#include "convert/flow_particles.h"
#include "scene/scene.h"

namespace frana {

/// THEORY (5): fills bed_pressure [Pa], rho g h / (1 + grad Z . grad s), Z bed, s surface; what bears a particle whose
/// mass follows its bed, w = v . grad Z, while its surface drives it, dv/dt = -(g + dw/dt) grad s. A lake at rest
/// bears its whole weight, g; a sheet as deep everywhere g cos^2 of the slope. The factor stays between these two. grad
/// s is that of the plane through the particles around (least squares). Where they define none, it is that of the bed.
void take_start_pressure(FlowParticles& particles, const Scene& scene);

}  // namespace frana
