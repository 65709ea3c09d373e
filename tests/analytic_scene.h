#pragma once
// Scenes from formulas, for tests: a bed z(x, y), a depth h(x, y), a lattice of points.
#include <algorithm>
#include <cmath>
#include <functional>

#include "scene/scene.h"
#include "solver/depth_averaged.h"

namespace frana::test {

using Function = std::function<double(double x, double y)>;

/// A grid of nx * ny nodes whose node (0, 0) stands at (x0, y0), bed from a formula.
inline Scene scene_on(Index nx, Index ny, double cell, const Function& bed, double x0 = 0.0, double y0 = 0.0) {
    Scene scene;
    GridGeometry g;
    g.nx = nx;
    g.ny = ny;
    g.cell = cell;
    g.x0 = x0;
    g.y0 = y0;
    scene.bed = Raster::filled(g, 0.0);
    for (Index j = 0; j < ny; ++j)
        for (Index i = 0; i < nx; ++i) scene.bed.at(i, j) = bed(g.x(i), g.y(j));
    return scene;
}

/// Adds per_side^2 points a cell on the lattice aligned with the grid, shifted by (shift_x, shift_y) cells, each with
/// the depth at its own place.
inline void fill(Scene& scene, const Function& depth, int per_side = 2, double shift_x = 0.0, double shift_y = 0.0) {
    const GridGeometry& g = scene.bed.geometry;
    const double s = g.cell / per_side;
    for (Index j = 0; j < (g.ny - 1) * per_side; ++j)
        for (Index i = 0; i < (g.nx - 1) * per_side; ++i) {
            const double x = g.x0 + (static_cast<double>(i) + 0.5) * s + shift_x * g.cell;
            const double y = g.y0 + (static_cast<double>(j) + 0.5) * s + shift_y * g.cell;
            if (x < g.x0 || x > g.x_max() || y < g.y0 || y > g.y_max()) continue;
            const double h = depth(x, y);
            if (!(h > 0.0)) continue;
            scene.particles.x.push_back(x);
            scene.particles.y.push_back(y);
            scene.particles.vx.push_back(0.0);
            scene.particles.vy.push_back(0.0);
            scene.particles.volume.push_back(h * s * s);
            scene.particles.depth.push_back(h);
            scene.particles.size.push_back(s);
        }
}

inline void run_to(Simulation& simulation, double end) {
    while (simulation.status().time < end) simulation.advance(end);
}

/// |V_end + V_left - V_0| / V_0 from the masses.
inline double mass_error(const Status& now, double initial) { return std::abs(now.mass + now.mass_left - initial) / initial; }

/// Relative L1 error of the nodal depth against a formula, over the nodes where `where` holds.
inline double depth_error(const Frame& frame, const Function& exact,
                          const std::function<bool(double, double)>& where = [](double, double) { return true; }) {
    double error = 0.0, size = 0.0;
    const double* h = frame.node("depth")->data;
    for (Index j = 0; j < frame.grid.ny; ++j)
        for (Index i = 0; i < frame.grid.nx; ++i) {
            const double x = frame.grid.x(i), y = frame.grid.y(j);
            if (!where(x, y)) continue;
            const double e = exact(x, y);
            error += std::abs(h[j * frame.grid.nx + i] - e);
            size += std::abs(e);
        }
    return error / size;
}

}  // namespace frana::test
