#include "checks/verify/body.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "base/constants.h"

namespace frana::verify {

Frame3 turned_about_y(double degrees) {
    const double a = degrees * constants::kPi / 180.0;
    return {(Mat3() << std::cos(a), 0, std::sin(a), 0, 1, 0, -std::sin(a), 0, std::cos(a)).finished()};
}

void for_each_part(const Vec3& low, const Vec3& high, double cell, int per_cell,
                   const std::function<void(const Vec3& place, double volume)>& take) {
    Index count[3];
    Vec3 size;
    for (int axis = 0; axis < 3; ++axis) {
        count[axis] = std::max<Index>(1, std::lround((high[axis] - low[axis]) / cell * per_cell));
        size[axis] = (high[axis] - low[axis]) / static_cast<double>(count[axis]);
    }
    for (Index k = 0; k < count[2]; ++k)
        for (Index j = 0; j < count[1]; ++j)
            for (Index i = 0; i < count[0]; ++i)
                take(low + Vec3((static_cast<double>(i) + 0.5) * size[0], (static_cast<double>(j) + 0.5) * size[1],
                                (static_cast<double>(k) + 0.5) * size[2]),
                     size.prod());
}

GridGeometry3d grid_around(const Frame3& frame, const Vec3& low, const Vec3& high, double cell) {
    constexpr double kRoom = 4.0;  // cells: what mirror particles of points on a surface reach
    Vec3 least = frame.at(low), most = least;
    for (int corner = 1; corner < 8; ++corner) {
        const Vec3 x =
            frame.at({corner & 1 ? high[0] : low[0], corner & 2 ? high[1] : low[1], corner & 4 ? high[2] : low[2]});
        least = least.cwiseMin(x), most = most.cwiseMax(x);
    }
    GridGeometry3d g;
    g.cell = cell;
    for (int axis = 0; axis < 3; ++axis) {
        g.origin[axis] = cell * (std::floor(least[axis] / cell) - kRoom);
        g.nodes[axis] = static_cast<Index>(std::ceil(most[axis] / cell) + kRoom - g.origin[axis] / cell) + 1;
    }
    return g;
}

void add_slice(SolidScene& scene, double width) {
    scene.surfaces.push_back(Surface::plane({0, 0, 0}, {0, 1, 0}));
    scene.surfaces.push_back(Surface::plane({0, width, 0}, {0, -1, 0}));
}

void add_quarter(SolidScene& scene) {
    scene.surfaces.push_back(Surface::symmetry_plane({0, 0, 0}, {1, 0, 0}));
    scene.surfaces.push_back(Surface::symmetry_plane({0, 0, 0}, {0, 1, 0}));
}

Measurement run_body(Mpm3d& flow, double end, const std::function<void(const Mpm3d&)>& each) {
    const auto start = std::chrono::steady_clock::now();
    const SolidStatus first = flow.status();
    // What momentum goes round: that of the points, whichever way they go, and what is given to them.
    double given = std::sqrt(2.0 * first.kinetic * first.mass);
    while (flow.status().time < end) {
        flow.advance(end);
        if (each) each(flow);
    }
    const SolidStatus& now = flow.status();
    Measurement m;
    m.particles = now.points;
    m.steps = now.step;
    m.wall_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    given += now.weight_impulse.norm();
    for (const Vec3& impulse : flow.body().impulse) given += impulse.norm();
    m.add("momentum_residual", given > 0.0 ? flow.momentum_residual().norm() / given : 0.0);
    return m;
}

void add_energies(Measurement& m, const Mpm3d& flow, double turned_over) {
    const SolidStatus& now = flow.status();
    m.add("numerical_loss", now.numerical() / turned_over);
    m.add("material_loss", now.material / turned_over);
}

Measurement joined(const Measurement& before, const Measurement& now) {
    Measurement m = now;
    m.steps += before.steps;
    m.wall_seconds += before.wall_seconds;
    for (Extra& extra : m.extras)
        if (extra.name == "momentum_residual" && before.steps > 0)
            extra.value = std::max(extra.value, before.value("momentum_residual"));
    return m;
}

}  // namespace frana::verify
