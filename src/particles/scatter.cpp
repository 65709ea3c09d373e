#include "particles/scatter.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/error.h"
#include "terrain/bed_points.h"

namespace frana {

namespace {

constexpr double kCellsPerEdge = 4.0;  ///< patch cells along the edge of a mean patch: its area to some 7 %

/// x_n = (1/2 + n / g^k) mod 1 for k = 1..D, with g the root of g^(D+1) = g + 1 (D = 2: the plastic number).
/// In fixed point, so that the millionth point is as good as the first.
template <int D>
class Roberts {
public:
    Roberts() {
        double g = 1.5;
        for (int round = 0; round < 64; ++round) g = std::pow(1.0 + g, 1.0 / (D + 1));
        for (int k = 0; k < D; ++k) {
            step_[k] = static_cast<std::uint64_t>(std::ldexp(std::pow(g, -(k + 1)), 64));
            state_[k] = std::uint64_t{1} << 63;
        }
    }
    std::array<double, D> next() {
        std::array<double, D> point;
        for (int k = 0; k < D; ++k) {
            state_[k] += step_[k];
            point[k] = std::ldexp(static_cast<double>(state_[k] >> 11), -53);
        }
        return point;
    }

private:
    std::array<std::uint64_t, D> step_{}, state_{};
};

/// Points sorted into square buckets, row after row, to find the nearest of them to a place. Ties go to the first.
class Nearest {
public:
    Nearest(const std::vector<Vec2>& points, const Box& box, double bucket) : box_(box), per_metre_(1.0 / bucket) {
        nx_ = std::max<Index>(1, static_cast<Index>(std::ceil((box.x1 - box.x0) / bucket)));
        ny_ = std::max<Index>(1, static_cast<Index>(std::ceil((box.y1 - box.y0) / bucket)));
        start_.assign(nx_ * ny_ + 1, 0);
        for (const Vec2& p : points) ++start_[column(p.x()) + nx_ * row(p.y()) + 1];
        for (std::size_t k = 1; k < start_.size(); ++k) start_[k] += start_[k - 1];
        sorted_.resize(points.size());
        std::vector<Index> next(start_.begin(), start_.end() - 1);
        for (const Vec2& p : points) sorted_[next[column(p.x()) + nx_ * row(p.y())]++] = p;
    }

    const std::vector<Vec2>& points() const { return sorted_; }

    /// Number in points(). `hints` are numbers that are likely near, or -1: they bound the search, not its
    /// result.
    Index of(double x, double y, const std::array<Index, 2>& hints) const {
        Best best;
        for (const Index hint : hints)
            if (hint >= 0) consider(hint, x, y, best);
        if (best.number < 0) consider(some_point_near(x, y), x, y, best);
        const double reach = std::sqrt(best.distance2);
        const Index i0 = column(x - reach), i1 = column(x + reach), j1 = row(y + reach);
        for (Index j = row(y - reach); j <= j1; ++j)
            for (Index k = start_[i0 + nx_ * j]; k < start_[i1 + nx_ * j + 1]; ++k) consider(k, x, y, best);
        return best.number;
    }

private:
    struct Best {
        double distance2 = std::numeric_limits<double>::infinity();
        Index number = -1;
    };
    void consider(Index number, double x, double y, Best& best) const {
        const double dx = sorted_[number].x() - x, dy = sorted_[number].y() - y;
        const double d = dx * dx + dy * dy;
        if (d <= best.distance2 && (d < best.distance2 || number < best.number)) best = {d, number};
    }
    /// A point of the first occupied square around (x, y); squares grow bucket by bucket.
    Index some_point_near(double x, double y) const {
        const Index i = column(x), j = row(y);
        for (Index grow = 0; grow <= std::max(nx_, ny_); ++grow)
            for (Index jj = std::max<Index>(j - grow, 0); jj <= std::min(j + grow, ny_ - 1); ++jj) {
                const Index begin = start_[std::max<Index>(i - grow, 0) + nx_ * jj];
                const Index end = start_[std::min(i + grow, nx_ - 1) + nx_ * jj + 1];
                if (begin < end) return begin;
            }
        throw InternalError("internal error: the nearest of no points");
    }
    Index column(double x) const {
        return std::clamp<Index>(static_cast<Index>((x - box_.x0) * per_metre_), 0, nx_ - 1);
    }
    Index row(double y) const { return std::clamp<Index>(static_cast<Index>((y - box_.y0) * per_metre_), 0, ny_ - 1); }

    Box box_;
    double per_metre_ = 1.0;  ///< buckets to the metre
    Index nx_ = 1, ny_ = 1;
    std::vector<Index> start_;
    std::vector<Vec2> sorted_;
};

/// Relative density of particles at a place, at most 1. It is |grad Z| of the nearest node over its mean where there is
/// material, held within [1/3, 3], over 3.
class SteepnessDensity {
public:
    SteepnessDensity(const Raster& bed, const Material& material) : grid_(bed.geometry) {
        double sum = 0.0, number = 0.0;
        density_.reserve(bed.values.size());
        for (Index j = 0; j < grid_.ny; ++j)
            for (Index i = 0; i < grid_.nx; ++i) {
                density_.push_back(bed_steepness(bed, grid_.x(i), grid_.y(j)));
                if (!material.contains(static_cast<double>(i) * grid_.cell, static_cast<double>(j) * grid_.cell))
                    continue;
                sum += density_.back();
                number += 1.0;
            }
        const double mean = sum / std::max(number, 1.0);
        for (double& d : density_) d = mean > 0.0 ? std::clamp(d / mean, 1.0 / 3.0, 3.0) / 3.0 : 1.0;
    }
    /// Local coordinates.
    double at(double x, double y) const {
        const Index i = std::min(static_cast<Index>(std::floor(x / grid_.cell + 0.5)), grid_.nx - 1);
        const Index j = std::min(static_cast<Index>(std::floor(y / grid_.cell + 0.5)), grid_.ny - 1);
        return density_[i + grid_.nx * j];
    }

private:
    GridGeometry grid_;
    std::vector<double> density_;
};

/// The first `count` points of a sequence that `accept` takes.
template <int D, class Accept>
std::vector<Vec2> first_points(const Material& material, Index count, Accept&& accept) {
    const Box& box = material.box();
    std::vector<Vec2> points;
    points.reserve(count);
    Roberts<D> sequence;
    // Even a material that fills less than a ten-thousandth of its own box is met by this many trials.
    const Index most = 100000 * count + 10000000;
    for (Index trial = 0; static_cast<Index>(points.size()) < count; ++trial) {
        if (trial == most)
            throw UserError(
                fmt::format("{}: its material fills too little of its bounding box for a quasi-random "
                            "placement; use particles.placement = \"lattice\"",
                            material.name()));
        const auto u = sequence.next();
        const double x = box.x0 + u[0] * (box.x1 - box.x0), y = box.y0 + u[1] * (box.y1 - box.y0);
        if (material.contains(x, y) && accept(x, y, u)) points.emplace_back(x, y);
    }
    return points;
}

std::vector<Vec2> points_of(const Material& material, Index count, Density density, const Raster& bed) {
    if (density == Density::even)
        return first_points<2>(material, count, [](double, double, const auto&) { return true; });
    const SteepnessDensity steepness(bed, material);
    return first_points<3>(material, count,
                           [&](double x, double y, const auto& u) { return u[2] < steepness.at(x, y); });
}

/// On the map, not beyond the outer nodes: of water a point may lie in the pixels beyond.
Vec2 on_grid(const Vec2& point, const GridGeometry& g) {
    const auto within = [&](double at, Index count) {
        return std::clamp(at, 0.0, static_cast<double>(count - 1) * g.cell);
    };
    return {g.x0 + within(point.x(), g.nx), g.y0 + within(point.y(), g.ny)};
}

void require_ground(const Material& material, const std::vector<Vec2>& points, const Raster& bed) {
    const GridGeometry& g = bed.geometry;
    for (const Vec2& p : points)
        if (const Vec2 at = on_grid(p, g); !std::isfinite(bed_elevation(bed, at.x(), at.y())))
            throw UserError(
                fmt::format("{}: material lies on nodata of the elevation model {} near pixel column {}, "
                            "row {} (x = {:.2f}, y = {:.2f}); fill the gap (gdal_fillnodata.py) or move "
                            "the release",
                            material.name(), bed.source, std::lround(p.x() / g.cell),
                            g.ny - 1 - std::lround(p.y() / g.cell), g.x0 + p.x(), g.y0 + p.y()));
}

/// A particle too close to others to own a cell takes half of what the owner of its cell has. Halves are exact.
void share_with_empty(const Lattice& cells, const Nearest& nearest, std::vector<double>& volumes,
                      std::vector<double>& areas) {
    const std::vector<Vec2>& points = nearest.points();
    const auto distance2 = [&](std::size_t p, std::size_t q) { return (points[p] - points[q]).squaredNorm(); };
    for (std::size_t p = 0; p < points.size(); ++p) {
        if (areas[p] > 0.0) continue;
        const double x = cells.x(cells.column(points[p].x())), y = cells.y(cells.row(points[p].y()));
        auto owner = static_cast<std::size_t>(nearest.of(x, y, {-1, -1}));
        if (!(areas[owner] > 0.0))  // the cell's own material is below round-off: take the nearest with something
            for (std::size_t q = 0; q < points.size(); ++q)
                if (areas[q] > 0.0 && (!(areas[owner] > 0.0) || distance2(p, q) < distance2(p, owner))) owner = q;
        volumes[p] = volumes[owner] *= 0.5;
        areas[p] = areas[owner] *= 0.5;
    }
}

}  // namespace

OutlineFaults place_scattered(const Material& material, Index count, double area, Density density, const Raster& bed,
                              Seeds& seeds) {
    const double spacing = std::sqrt(area / static_cast<double>(count));
    const Nearest nearest(points_of(material, count, density, bed), material.box(), spacing);
    const std::vector<Vec2>& points = nearest.points();
    require_ground(material, points, bed);
    std::vector<double> volumes(count, 0.0), areas(count, 0.0);

    const Lattice cells{spacing / kCellsPerEdge, material.box().x0, material.box().y0};
    std::vector<Index> owners(cells.column(material.box().x1) + 2, -1);  // of the last row seen, by column
    OutlineFaults faults = material.integrate(cells, material.box(), [&](const PatchRow& row) {
        Index west = -1;
        const double y = cells.y(row.row);
        for (Index k = 0; k < row.count; ++k) {
            if (!(row.area[k] > 0.0)) continue;
            const Index column = row.first_column + k;
            const Index owner = nearest.of(cells.x(column), y, {west, owners[column]});
            owners[column] = west = owner;
            volumes[owner] += row.volume[k];
            areas[owner] += row.area[k];
        }
    });
    share_with_empty(cells, nearest, volumes, areas);
    for (Index p = 0; p < count; ++p) {
        const Vec2 at = on_grid(points[p], bed.geometry);
        seeds.x.push_back(at.x());
        seeds.y.push_back(at.y());
        seeds.volume.push_back(volumes[p]);
        seeds.depth.push_back(volumes[p] / areas[p]);
        seeds.size.push_back(std::sqrt(areas[p]));
    }
    return faults;
}

}  // namespace frana
