#include "scene/ground_classes.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"

namespace frana {
namespace {

/// Of `count` values, `stride` apart: each with the pairs around it of which both are known. The mean is over `reach`
/// cells on either side of a node's middle, so of the outermost pair a part counts.
void smooth_line(const double* from, double* to, Index count, Index stride, double reach) {
    const auto whole = static_cast<Index>(std::ceil(reach - 0.5));
    for (Index k = 0; k < count; ++k) {
        const double middle = from[k * stride];
        double sum = middle, known = 1.0;
        for (Index d = 1; d <= std::min({whole, k, count - 1 - k}); ++d) {
            const double pair = from[(k - d) * stride] + from[(k + d) * stride];
            if (std::isnan(pair)) break;  // beyond a gap is other ground
            const double part = std::min(1.0, reach + 0.5 - static_cast<double>(d));
            sum += part * pair, known += 2.0 * part;
        }
        to[k * stride] = sum / known;
    }
}

/// First derivatives of the ground by central differences.
Vec2 gradient_of(const Raster& bed, Index i, Index j) {
    const double twice = 2.0 * bed.geometry.cell;
    return {(bed.at(i + 1, j) - bed.at(i - 1, j)) / twice, (bed.at(i, j + 1) - bed.at(i, j - 1)) / twice};
}

std::uint8_t class_of(const Raster& bed, Index i, Index j, const GroundBorders& borders) {
    enum : std::uint8_t { kFlat, kOpen, kChannelled, kGully };
    const Vec2 gradient = gradient_of(bed, i, j);
    if (!std::isfinite(gradient.x()) || !std::isfinite(gradient.y())) return kOpen;  // not known: the middle class
    if (std::atan(gradient.norm()) * constants::kRadian < borders.flat_below_deg) return kFlat;
    const double curvature = plan_curvature(bed, i, j);
    return curvature < borders.curvature[0]   ? kFlat
           : curvature < borders.curvature[1] ? kOpen
           : curvature < borders.curvature[2] ? kChannelled
                                              : kGully;
}

}  // namespace

bool averages(double length, double cell) {
    constexpr double round_off = 1e-9;
    return length > (1.0 + round_off) * cell;
}

Raster smoothed(const Raster& raster, double length) {
    const GridGeometry& g = raster.geometry;
    const double most = static_cast<double>(std::max(g.nx, g.ny));
    const double reach = std::min(0.5 * length / g.cell, most);
    if (!averages(length, g.cell)) return raster;
    Raster rows = raster, all = raster;
    for (Index j = 0; j < g.ny; ++j)
        smooth_line(raster.values.data() + j * g.nx, rows.values.data() + j * g.nx, g.nx, 1, reach);
    for (Index i = 0; i < g.nx; ++i) smooth_line(rows.values.data() + i, all.values.data() + i, g.ny, g.nx, reach);
    return all;
}

double plan_curvature(const Raster& bed, Index i, Index j) {
    const double cell2 = bed.geometry.cell * bed.geometry.cell;
    const Vec2 slope = gradient_of(bed, i, j);
    const double z = bed.at(i, j), x = slope.x(), y = slope.y();
    const double xx = (bed.at(i + 1, j) - 2.0 * z + bed.at(i - 1, j)) / cell2;
    const double yy = (bed.at(i, j + 1) - 2.0 * z + bed.at(i, j - 1)) / cell2;
    const double xy =
        (bed.at(i + 1, j + 1) - bed.at(i - 1, j + 1) - bed.at(i + 1, j - 1) + bed.at(i - 1, j - 1)) / (4.0 * cell2);
    const double steep2 = x * x + y * y;
    constexpr double kLevel = 1e-12;  // squared slope below which contours have no direction
    const double bent = xx * y * y - 2.0 * xy * x * y + yy * x * x;
    return steep2 > kLevel && std::isfinite(bent) ? bent / (steep2 * std::sqrt(steep2)) : 0.0;
}

std::vector<std::uint8_t> ground_classes(const Raster& bed, const GroundBorders& borders) {
    const Raster ground = smoothed(bed, borders.length);
    const GridGeometry& g = bed.geometry;
    std::vector<std::uint8_t> classes(bed.values.size());
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i)
            classes[static_cast<std::size_t>(j * g.nx + i)] =
                class_of(ground, std::clamp<Index>(i, 1, g.nx - 2), std::clamp<Index>(j, 1, g.ny - 2), borders);
    return classes;
}

}  // namespace frana
