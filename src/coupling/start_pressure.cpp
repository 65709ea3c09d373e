#include "coupling/start_pressure.h"

#include <algorithm>
#include <cmath>

#include "terrain/places.h"

namespace frana {
namespace {

/// Sums over the particles around a node for a plane through their surfaces; places from the node, in cells.
struct PlaneSums {
    double w = 0.0, x = 0.0, y = 0.0, s = 0.0, xx = 0.0, xy = 0.0, yy = 0.0, xs = 0.0, ys = 0.0;

    void add(double weight, const Vec2& at, double surface) {
        w += weight, x += weight * at.x(), y += weight * at.y(), s += weight * surface;
        xx += weight * at.x() * at.x(), xy += weight * at.x() * at.y(), yy += weight * at.y() * at.y();
        xs += weight * at.x() * surface, ys += weight * at.y() * surface;
    }
    /// Slope of the plane per cell; false where the particles are too few or stand in a row.
    bool slope(Vec2& result) const {
        constexpr double kLeast = 1e-3;  // variance of places across the row [cells^2]; that of a full cell is 0.17
        if (!(w > 0.0)) return false;
        const double a = xx / w - x * x / (w * w), b = xy / w - x * y / (w * w), d = yy / w - y * y / (w * w);
        const double det = a * d - b * b;
        if (!(a + d > kLeast && det > kLeast * (a + d))) return false;  // of one particle a and d are round-off
        const double p = xs / w - x * s / (w * w), q = ys / w - y * s / (w * w);
        result = {(d * p - b * q) / det, (a * q - b * p) / det};
        return true;
    }
};

/// Sums at the nodes around particles, and at no others of the terrain.
class SurfaceSums {
public:
    SurfaceSums(const GridGeometry& g, const FlowParticles& particles) : geometry_(g), i_(g.nx), j_(g.ny) {
        Index i_end = 0, j_end = 0;
        for (std::size_t k = 0; k < particles.count(); ++k) {
            const NodeSquare c(g, particles.x[k], particles.y[k]);
            i_ = std::min(i_, c.i), i_end = std::max(i_end, c.i + 2);
            j_ = std::min(j_, c.j), j_end = std::max(j_end, c.j + 2);
        }
        row_ = std::max<Index>(0, i_end - i_);
        sums_.resize(static_cast<std::size_t>(row_ * std::max<Index>(0, j_end - j_)));
    }
    /// Calls visit(sums, weight, place from the node in cells) for the four nodes around a particle.
    template <class Visit>
    void each_corner(double x, double y, Visit&& visit) {
        const NodeSquare c(geometry_, x, y);
        for (Index k = 0; k < 4; ++k) {
            const NodeAt node = c.node(k);
            const Vec2 from(c.s - static_cast<double>(node.i - c.i), c.t - static_cast<double>(node.j - c.j));
            visit(sums_[static_cast<std::size_t>((node.j - j_) * row_ + node.i - i_)],
                  (1.0 - std::abs(from.x())) * (1.0 - std::abs(from.y())), from);
        }
    }

private:
    const GridGeometry& geometry_;
    Index i_, j_, row_;
    std::vector<PlaneSums> sums_;
};

}  // namespace

void take_start_pressure(FlowParticles& particles, const Scene& scene) {
    const GridGeometry& g = scene.bed.geometry;
    SurfaceSums nodes(g, particles);
    for (std::size_t k = 0; k < particles.count(); ++k)
        nodes.each_corner(particles.x[k], particles.y[k], [&](PlaneSums& node, double weight, const Vec2& from) {
            node.add(weight, from, particles.bed[k] + particles.depth[k]);
        });
    for (std::size_t k = 0; k < particles.count(); ++k) {
        const Vec2 bed(particles.slope_x[k], particles.slope_y[k]);
        Vec2 sum = Vec2::Zero();
        double known = 0.0;
        nodes.each_corner(particles.x[k], particles.y[k], [&](const PlaneSums& node, double weight, const Vec2&) {
            Vec2 slope;
            if (node.slope(slope)) sum += weight / g.cell * slope, known += weight;
        });
        const Vec2 surface = known > 0.0 ? Vec2(sum / known) : bed;
        const double q = std::clamp(bed.dot(surface), 0.0, bed.squaredNorm());
        particles.bed_pressure[k] = scene.density * scene.gravity * particles.depth[k] / (1.0 + q);
    }
}

}  // namespace frana
