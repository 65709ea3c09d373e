#include "convert/gather.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/compensated_sum.h"
#include "terrain/bed_points.h"
#include "terrain/places.h"

namespace frana {
namespace {

/// Sums over the points of a pixel.
struct Bin {
    CompensatedSum mass, volume, momentum[3], place[2], pressure, kinetic;
    double top = -INFINITY;
};

/// Pixel that a place belongs to; -1 beyond them or over unknown bed.
Index pixel_at(const Raster& bed, double x, double y) {
    const Index pixel = pixel_of(bed.geometry, x, y);
    return pixel < 0 || std::isnan(bed.values[static_cast<std::size_t>(pixel)]) ? -1 : pixel;
}

/// Places are summed relative to the pixel's middle, or large map coordinates would cost digits.
void add_point(Bin& bin, const SolidPoints& points, std::size_t k, double x_middle, double y_middle) {
    const double m = points.mass[k];
    const double *x = &points.position[3 * k], *v = &points.velocity[3 * k];
    bin.mass.add(m);
    bin.volume.add(points.volume[k]);
    for (int axis = 0; axis < 3; ++axis) {
        bin.momentum[axis].add(m * v[axis]);
        bin.kinetic.add(0.5 * m * v[axis] * v[axis]);
    }
    bin.place[0].add(m * (x[0] - x_middle));
    bin.place[1].add(m * (x[1] - y_middle));
    bin.pressure.add(points.volume[k] * points.pressure[k]);
    bin.top = std::max(bin.top, x[2]);
}

/// Elevation at a place, or of the nearest node where the bed around is not known in full.
double bed_near(const Raster& bed, Index pixel, double x, double y) {
    const double z = bed_elevation(bed, x, y);
    return std::isfinite(z) ? z : bed.values[static_cast<std::size_t>(pixel)];
}

void add_particle(GatheredFlow& flow, Index pixel, const Bin& bin, const Raster& bed) {
    const GridGeometry& g = bed.geometry;
    FlowParticles& c = flow.particles;
    const double mass = bin.mass.value(), volume = bin.volume.value();
    const double x = g.x(pixel % g.nx) + bin.place[0].value() / mass,
                 y = g.y(pixel / g.nx) + bin.place[1].value() / mass;
    const double vx = bin.momentum[0].value() / mass, vy = bin.momentum[1].value() / mass;
    c.x.push_back(x);
    c.y.push_back(y);
    c.bed.push_back(bed_near(bed, pixel, x, y));
    c.depth.push_back(volume / (g.cell * g.cell));
    c.vx.push_back(vx);
    c.vy.push_back(vy);
    c.mass.push_back(mass);
    c.volume.push_back(volume);
    c.bed_pressure.push_back(2.0 * bin.pressure.value() / volume);
    c.id.push_back(static_cast<double>(pixel));
    flow.pixel.push_back(pixel);
    flow.top.push_back(bin.top);
    flow.kinetic.push_back(bin.kinetic.value() - 0.5 * mass * (vx * vx + vy * vy));
}

}  // namespace

GatheredFlow points_to_particles(const SolidPoints& points, const Raster& bed) {
    GatheredFlow flow;
    std::map<Index, Bin> bins;  // in the order of the pixels
    CompensatedSum lost;
    const GridGeometry& g = bed.geometry;
    for (std::size_t k = 0; k < points.count(); ++k) {
        const Index pixel = pixel_at(bed, points.position[3 * k], points.position[3 * k + 1]);
        if (pixel < 0) {
            ++flow.outside;
            lost.add(points.mass[k]);
            continue;
        }
        add_point(bins[pixel], points, k, g.x(pixel % g.nx), g.y(pixel / g.nx));
    }
    flow.mass_outside = lost.value();
    for (const auto& [pixel, bin] : bins) add_particle(flow, pixel, bin, bed);
    take_slopes(flow.particles, bed);
    return flow;
}

FlowRasters rasters_of(const GatheredFlow& flow, const Raster& bed) {
    FlowRasters rasters;
    for (Raster* raster : {&rasters.depth, &rasters.velocity_x, &rasters.velocity_y}) {
        *raster = Raster::filled(bed.geometry, 0.0);
        raster->crs_wkt = bed.crs_wkt;
        for (std::size_t k = 0; k < bed.values.size(); ++k)
            if (std::isnan(bed.values[k])) raster->values[k] = Raster::nodata;
    }
    for (std::size_t p = 0; p < flow.particles.count(); ++p) {
        const auto k = static_cast<std::size_t>(flow.pixel[p]);
        rasters.depth.values[k] = flow.particles.depth[p];
        rasters.velocity_x.values[k] = flow.particles.vx[p];
        rasters.velocity_y.values[k] = flow.particles.vy[p];
    }
    return rasters;
}

}  // namespace frana
