#pragma once
// A depth-averaged state of uneven particles, for tests of the way into 3D and back.
#include <cmath>

#include "convert/flow_particles.h"

namespace flow_maker {

/// A plane that falls with 0.5 in x and climbs with 0.25 in y, at large map coordinates; nodes `cell` apart.
inline frana::Raster tilted_bed(frana::Index nodes, double cell) {
    frana::GridGeometry geometry;
    geometry.nx = geometry.ny = nodes;
    geometry.x0 = 512345.5;
    geometry.y0 = 5123456.5;
    geometry.cell = cell;
    frana::Raster bed = frana::Raster::filled(geometry, 0.0);
    for (frana::Index j = 0; j < nodes; ++j)
        for (frana::Index i = 0; i < nodes; ++i)
            bed.at(i, j) = 900.0 - 0.5 * cell * static_cast<double>(i) + 0.25 * cell * static_cast<double>(j);
    return bed;
}

/// One particle per pixel but for the outermost ones, depths from 0 to 7 m, velocities in all directions and rest.
inline frana::FlowParticles uneven_flow(const frana::Raster& bed, double density, double gravity) {
    const frana::GridGeometry& g = bed.geometry;
    frana::FlowParticles c;
    for (frana::Index j = 1; j + 1 < g.ny; ++j)
        for (frana::Index i = 1; i + 1 < g.nx; ++i) {
            const double u = static_cast<double>(i), v = static_cast<double>(j);
            const double h = std::max(0.0, 3.5 * (1.0 + std::sin(0.7 * u) * std::cos(1.3 * v)) - 0.2);
            c.x.push_back(g.x(i) + 0.2 * g.cell * std::sin(3.0 * u + v));
            c.y.push_back(g.y(j) + 0.2 * g.cell * std::cos(2.0 * u - v));
            c.depth.push_back(h);
            c.vx.push_back(i % 7 == 0 ? 0.0 : 12.0 * std::sin(u));
            c.vy.push_back(i % 7 == 0 ? 0.0 : 3.0 * std::cos(v) - 1.0);
            c.volume.push_back(g.cell * g.cell * (h + 0.01));
            c.mass.push_back(density * c.volume.back());
            c.bed_pressure.push_back(density * gravity * h);
            c.id.push_back(static_cast<double>(c.id.size()) + 100.0);
            c.bed.push_back(bed.at(0, 0) - 0.5 * (c.x.back() - g.x0) + 0.25 * (c.y.back() - g.y0));
            for (const double stress : {40.0, -15.0, 7.0}) c.stress.push_back(stress * std::cos(u));
        }
    take_slopes(c, bed);
    return c;
}

}  // namespace flow_maker
