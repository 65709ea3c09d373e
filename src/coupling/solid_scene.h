#pragma once
// The 3D scene that a stage of a case describes.
#include "convert/flow_particles.h"
#include "scene/scene.h"
#include "solid3d/mpm3d.h"

namespace frana {

/// What is chosen when a stage begins, from the material there and the stage's keys.
struct SolidStart {
    double sound_speed = 0.0;  ///< of fluids, and of sand or grains by the bed's friction [m/s]
    double top = 0.0;          ///< elevation where the space ends [m]
    double friction =
        0.0;             ///< inside of sand that has the bed's friction: as large as that of any of its particles [1]
    double blur = 0.0;   ///< time over which forces on barriers are averaged: see BarrierLoads [s]
    double depth = 0.0;  ///< of the flow along gravity, mean by mass [m]
    double speed = 0.0;  ///< of the flow, or that of its own weight where that is more, mean by mass [m/s]
    bool stuck = false;  ///< the lowest material does not slide on the bed
};

/// Sound is ten times as fast as the fastest of `particles`, or as one that falls by its own depth. So the density
/// changes by 1 % (Monaghan 1994). There is room four times as high above the lowest ground as their energy reaches. A
/// first contact with a barrier lasts as long as sound takes through the flow. Means over twenty times that do not
/// depend on it.
SolidStart choose_start(const Scene& scene, const FlowParticles& particles);

/// Largest cell that resolves how a flow of fluid or mud shears above a bed that holds it [m]. There the speed over
/// three quarters of a cell is at most the shear velocity. Any cell, of what has no such stress. THEORY.md (13).
double resolving_cell(const SolidLaw& law, double density, double depth, double speed);

/// Grid, law and surfaces of scene.solid, without points. The ground comes first, then the window's closed sides,
/// then the barriers in their order. Open sides lie a cell of the terrain's grid outside the window. Particles that
/// cross its edge are wider than a point.
SolidScene solid_scene(const Scene& scene, const SolidStart& start);

/// [xmin, ymin, xmax, ymax] of the window [m]: the edges of its nodes' cells, or the outer nodes of the
/// terrain.
std::array<double, 4> window_of(const Scene& scene);

/// The same, where points may start: out to half a cell of the terrain's grid beyond open sides.
std::array<double, 4> reach_of(const Scene& scene);

/// Nodes of the terrain in the window: 1; row after row from the south.
std::vector<std::uint8_t> nodes_in_window(const Scene& scene);

/// These, and besides those around the window's open sides whose particles points can feel. They go as far out as
/// points may come. They include the reach of their nodes and of what stands there.
std::vector<std::uint8_t> nodes_at_edge(const Scene& scene);

}  // namespace frana
