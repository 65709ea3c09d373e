// A slab slides down a plane: the solver as a library, without a file.
#include <fmt/format.h>

#include <algorithm>

#include "run/simulation.h"
#include "scene/scene.h"

int main() {
    frana::Scene scene;
    scene.bed = frana::Raster::filled({60, 12, 0.0, 0.0, 1.0}, 0.0);
    for (frana::Index n = 0; n < 60 * 12; ++n) scene.bed.values[n] = 30.0 - 0.5 * (n % 60);
    frana::Seeds& s = scene.particles;
    for (int n = 0; n < 400; ++n) {  // 10 m x 10 m, 1 m deep, four particles a cell
        s.x.push_back(5.25 + 0.5 * (n % 20)), s.y.push_back(0.75 + 0.5 * (n / 20)), s.size.push_back(0.5);
        s.depth.push_back(1.0), s.volume.push_back(0.25), s.vx.push_back(0.0), s.vy.push_back(0.0);
    }
    scene.bed_law = frana::bed::Coulomb{0.3};
    scene.sides = frana::Sides::wall;
    const auto simulation = frana::make_simulation(scene);
    while (simulation->status().time < 3.0) simulation->advance(3.0);
    double front = 0.0;
    const frana::Frame frame = simulation->frame();
    const frana::Field& at = *frame.particle("position");
    for (frana::Index n = 0; n < at.count; ++n) front = std::max(front, at.data[3 * n]);
    fmt::print("mass {:.6f} kg, runout {:.2f} m\n", simulation->status().mass, front - 15.0);
}
