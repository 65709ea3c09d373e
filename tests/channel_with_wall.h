#pragma once
// 3D water that runs against a wall.
#include "analytic_scene.h"

namespace frana::test {

inline Polygons rectangle_of(double x0, double y0, double x1, double y1) {
    Polygons polygons;
    polygons.parts.push_back({{{{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}}});
    return polygons;
}

/// A channel, closed at its sides, with a block of water that runs at 5 m/s towards a wall across it.
inline Scene channel(double height) {
    Scene scene = scene_on(31, 9, 0.5, [](double, double) { return 2.0; });
    scene.sides = Sides::wall;
    fill(scene, [](double x, double) { return x > 4 && x < 8 ? 1.0 : 0.0; });
    scene.particles.vx.assign(scene.particles.x.size(), 5.0);
    scene.end = 1.0;
    Barrier wall;
    wall.name = "wall";
    wall.outline = rectangle_of(10.0, -1.0, 12.0, 5.0);
    wall.height = height;
    scene.barriers = {wall};
    SolidStage stage;
    stage.window = {0, 0, 30, 8};
    stage.closed = {true, true, true, true};
    stage.cell = 0.25;
    stage.spacing = 0.125;
    stage.law = solid::Fluid{};
    scene.solid = stage;
    return scene;
}

/// That with an eighth of the points and half of the steps.
inline Scene coarse_channel(double height) {
    Scene scene = channel(height);
    scene.solid->cell = 0.5, scene.solid->spacing = 0.25;
    return scene;
}

}  // namespace frana::test
