// `frana convert --points FILE --back DIR`: 3D points, of whatever program, become rasters of depth and velocity on a
// run's grid. A case can go on from them depth-averaged.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <tuple>

#include "base/compensated_sum.h"
#include "convert/gather.h"
#include "frana_commands.h"
#include "io/gdal_writer.h"
#include "io/hdf5_points.h"
#include "run/folder/run_state.h"

namespace frana {
namespace {

/// A total of the points and of the particles they became.
struct Totals {
    CompensatedSum mass, volume, momentum[2], moved;
};

Totals totals_of(const SolidPoints& points) {
    Totals totals;
    for (std::size_t k = 0; k < points.count(); ++k) {
        const double *v = &points.velocity[3 * k], m = points.mass[k];
        totals.mass.add(m);
        totals.volume.add(points.volume[k]);
        for (int axis = 0; axis < 2; ++axis) totals.momentum[axis].add(m * v[axis]);
        totals.moved.add(m * std::hypot(v[0], v[1]));
    }
    return totals;
}

Totals totals_of(const FlowParticles& particles) {
    Totals totals;
    for (std::size_t p = 0; p < particles.count(); ++p) {
        totals.mass.add(particles.mass[p]);
        totals.volume.add(particles.volume[p]);
        totals.momentum[0].add(particles.mass[p] * particles.vx[p]);
        totals.momentum[1].add(particles.mass[p] * particles.vy[p]);
    }
    return totals;
}

std::string line(const char* name, const CompensatedSum& points, const CompensatedSum& particles, double scale) {
    const double error = std::abs(points.value() - particles.value());
    return fmt::format("{:<22} {:>16.9g} {:>16.9g} {:>15.2e}\n", name, points.value(), particles.value(),
                       error > 0.0 ? error / scale : 0.0);
}

std::string balance(const SolidPoints& points, const GatheredFlow& flow) {
    const Totals before = totals_of(points), after = totals_of(flow.particles);
    const double moved = before.moved.value();
    CompensatedSum kinetic;
    for (const double energy : flow.kinetic) kinetic.add(energy);
    std::string text = fmt::format("{:<22} {:>16} {:>16} {:>15}\n", "conserved", "points", "pixels", "relative error") +
                       line("mass [kg]", before.mass, after.mass, before.mass.value()) +
                       line("volume [m3]", before.volume, after.volume, before.volume.value()) +
                       line("momentum_x [kg m/s]", before.momentum[0], after.momentum[0], moved) +
                       line("momentum_y [kg m/s]", before.momentum[1], after.momentum[1], moved);
    text += fmt::format("{} points on {} pixels; {:.6g} J of motion within the particles are given up\n",
                        points.count() - flow.outside, flow.particles.count(), kinetic.value());
    if (flow.outside > 0)
        text += fmt::format("{} points, {:.6g} kg, stand beyond the terrain and are left out\n", flow.outside,
                            flow.mass_outside);
    return text;
}

}  // namespace

int convert_back(const ConvertOptions& options) {
    const Raster bed = bed_of_run(options.run_dir);
    const SolidPoints points = read_points_hdf5(options.points);
    const GatheredFlow flow = points_to_particles(points, bed);
    const FlowRasters rasters = rasters_of(flow, bed);
    std::filesystem::create_directories(options.back);
    const std::tuple<const char*, const Raster&, const char*, const char*> files[] = {
        {"depth.tif", rasters.depth, "m", "depth of the 3D points, their volume over the pixel"},
        {"velocity_x.tif", rasters.velocity_x, "m/s", "mean velocity of the 3D points to the east"},
        {"velocity_y.tif", rasters.velocity_y, "m/s", "mean velocity of the 3D points to the north"}};
    std::cout << balance(points, flow);
    for (const auto& [name, raster, unit, description] : files) {
        write_geotiff(options.back / name, raster, unit, description);
        std::cout << (options.back / name).string() << '\n';
    }
    return 0;
}

}  // namespace frana
