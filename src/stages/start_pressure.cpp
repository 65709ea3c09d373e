#include "stages/start_pressure.h"

#include <algorithm>
#include <cmath>

namespace frana {
namespace {

/// Sums over the columns around a node for a plane through their surfaces; places from the node, in cells.
struct PlaneSums {
    double w = 0.0, x = 0.0, y = 0.0, s = 0.0, xx = 0.0, xy = 0.0, yy = 0.0, xs = 0.0, ys = 0.0;

    void add(double weight, const Vec2& at, double surface) {
        w += weight, x += weight * at.x(), y += weight * at.y(), s += weight * surface;
        xx += weight * at.x() * at.x(), xy += weight * at.x() * at.y(), yy += weight * at.y() * at.y();
        xs += weight * at.x() * surface, ys += weight * at.y() * surface;
    }
    /// Slope of the plane per cell; false where the columns are too few or stand in a row.
    bool slope(Vec2& result) const {
        constexpr double kLeast =
            1e-3;  // variance of places across the row [cells^2]; that of a full cell is 0.17
        if (!(w > 0.0)) return false;
        const double a = xx / w - x * x / (w * w), b = xy / w - x * y / (w * w), d = yy / w - y * y / (w * w);
        const double det = a * d - b * b;
        if (!(a + d > kLeast && det > kLeast * (a + d))) return false;  // of one column a and d are round-off
        const double p = xs / w - x * s / (w * w), q = ys / w - y * s / (w * w);
        result = {(d * p - b * q) / det, (a * q - b * p) / det};
        return true;
    }
};

/// Calls visit(node, weight, place from the node in cells) for the four nodes around a column.
template <class Visit>
void for_each_corner(const GridGeometry& g, double x, double y, Visit&& visit) {
    const double u = std::clamp((x - g.x0) / g.cell, 0.0, static_cast<double>(g.nx - 1));
    const double v = std::clamp((y - g.y0) / g.cell, 0.0, static_cast<double>(g.ny - 1));
    const Index i = std::min(static_cast<Index>(u), g.nx - 2), j = std::min(static_cast<Index>(v), g.ny - 2);
    for (Index n = j; n <= j + 1; ++n)
        for (Index m = i; m <= i + 1; ++m) {
            const Vec2 from(u - static_cast<double>(m), v - static_cast<double>(n));
            visit(static_cast<std::size_t>(n * g.nx + m),
                  (1.0 - std::abs(from.x())) * (1.0 - std::abs(from.y())), from);
        }
}

}  // namespace

void take_start_pressure(FlowColumns& columns, const Scene& scene) {
    const GridGeometry& g = scene.bed.geometry;
    std::vector<PlaneSums> nodes(static_cast<std::size_t>(g.size()));
    for (std::size_t k = 0; k < columns.count(); ++k)
        for_each_corner(g, columns.x[k], columns.y[k],
                        [&](std::size_t node, double weight, const Vec2& from) {
                            nodes[node].add(weight, from, columns.bed[k] + columns.depth[k]);
                        });
    for (std::size_t k = 0; k < columns.count(); ++k) {
        const Vec2 bed(columns.slope_x[k], columns.slope_y[k]);
        Vec2 sum = Vec2::Zero();
        double known = 0.0;
        for_each_corner(g, columns.x[k], columns.y[k], [&](std::size_t node, double weight, const Vec2&) {
            Vec2 slope;
            if (nodes[node].slope(slope)) sum += weight / g.cell * slope, known += weight;
        });
        const Vec2 surface = known > 0.0 ? Vec2(sum / known) : bed;
        const double q = std::clamp(bed.dot(surface), 0.0, bed.squaredNorm());
        columns.bed_pressure[k] = scene.density * scene.gravity * columns.depth[k] / (1.0 + q);
    }
}

}  // namespace frana
