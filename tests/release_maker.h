#pragma once
// Releases whose area and volume are known without the code under test.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "particles/generate.h"

namespace release_maker {

using frana::GridGeometry;
using frana::Index;
using frana::Polygon;
using frana::Polygons;
using frana::Raster;
using frana::Release;
using frana::Vec2;
using Ring = std::vector<Vec2>;

constexpr double pi = 3.14159265358979323846;

/// Half the cross products of the edges; the sign is the orientation.
inline double shoelace(const Ring& ring) {
    double twice = 0.0;
    for (std::size_t k = 0; k < ring.size(); ++k) {
        const Vec2 a = ring[k] - ring[0], b = ring[(k + 1) % ring.size()] - ring[0];
        twice += a.x() * b.y() - a.y() * b.x();
    }
    return 0.5 * twice;
}

/// The ring cut off where normal . x > limit (Sutherland and Hodgman 1974); the area stays right for any
/// ring.
inline Ring cut(const Ring& ring, const Vec2& normal, double limit) {
    Ring left;
    for (std::size_t k = 0; k < ring.size(); ++k) {
        const Vec2 a = ring[k], b = ring[(k + 1) % ring.size()];
        const double over_a = normal.dot(a) - limit, over_b = normal.dot(b) - limit;
        if (over_a <= 0.0) left.push_back(a);
        if ((over_a <= 0.0) != (over_b <= 0.0)) left.push_back(a + (b - a) * (over_a / (over_a - over_b)));
    }
    return left;
}

inline double area_in_box(const Ring& ring, double x0, double y0, double x1, double y1) {
    Ring rest = cut(cut(ring, Vec2(1, 0), x1), Vec2(-1, 0), -x0);
    rest = cut(cut(rest, Vec2(0, 1), y1), Vec2(0, -1), -y0);
    return rest.size() < 3 ? 0.0 : std::abs(shoelace(rest));
}

/// Outer ring minus holes, within a box.
inline double area_in_box(const Polygons& polygons, double x0, double y0, double x1, double y1) {
    double area = 0.0;
    for (const Polygon& part : polygons.parts)
        for (std::size_t r = 0; r < part.rings.size(); ++r)
            area += (r == 0 ? 1.0 : -1.0) * area_in_box(part.rings[r], x0, y0, x1, y1);
    return area;
}

inline double volume_in_box(const Release& release, double x0, double y0, double x1, double y1) {
    if (!release.depth_field) return release.depth * area_in_box(*release.outline, x0, y0, x1, y1);
    const GridGeometry& g = release.depth_field->geometry;
    double volume = 0.0;
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i) {
            const double depth = release.depth_field->at(i, j);
            if (!(depth > 0.0)) continue;
            const double a = std::max(x0, g.x(i) - 0.5 * g.cell), b = std::min(x1, g.x(i) + 0.5 * g.cell);
            const double c = std::max(y0, g.y(j) - 0.5 * g.cell), d = std::min(y1, g.y(j) + 0.5 * g.cell);
            if (a >= b || c >= d) continue;
            volume += depth * (release.outline ? area_in_box(*release.outline, a, c, b, d) : (b - a) * (d - c));
        }
    return volume;
}

inline Ring star(const Vec2& centre, double outer, double inner, int points, double turn = 0.0) {
    Ring ring;
    for (int k = 0; k < 2 * points; ++k) {
        const double angle = turn + pi * k / points, radius = k % 2 ? inner : outer;
        ring.emplace_back(centre.x() + radius * std::cos(angle), centre.y() + radius * std::sin(angle));
    }
    return ring;
}

inline Ring rotated_square(const Vec2& centre, double edge, double angle) {
    return star(centre, edge / std::sqrt(2.0), edge / std::sqrt(2.0), 2, angle);
}

inline Release release_of(std::vector<Polygon> parts, double depth) {
    Release release;
    release.outline = Polygons{std::move(parts), "", "outline.geojson"};
    release.depth = depth;
    return release;
}

inline Release release_of_ring(Ring ring, double depth) { return release_of({Polygon{{std::move(ring)}}}, depth); }

inline Ring rectangle_ring(double x0, double y0, double x1, double y1) {
    return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

/// A smooth positive depth with a corner of nodata.
inline Raster bumpy_depth(const GridGeometry& geometry) {
    Raster depth = Raster::filled(geometry, 0.0);
    depth.source = "depth.tif";
    for (Index j = 0; j < geometry.ny; ++j)
        for (Index i = 0; i < geometry.nx; ++i)
            depth.at(i, j) =
                i + j < 4 ? Raster::nodata
                          : 1.5 + std::sin(0.9 * static_cast<double>(i)) * std::cos(1.3 * static_cast<double>(j));
    return depth;
}

inline Raster flat_bed(Index nx, Index ny, double cell, double x0 = 0.0, double y0 = 0.0) {
    return Raster::filled({nx, ny, x0, y0, cell}, 100.0);
}

struct Made {
    frana::Seeds seeds;
    std::vector<frana::ReleaseReport> reports;
    std::vector<std::string> log;

    bool said(const std::string& words) const {
        for (const auto& line : log)
            if (line.find(words) != std::string::npos) return true;
        return false;
    }
    double volume() const {
        long double sum = 0.0L;
        for (const double v : seeds.volume) sum += v;
        return static_cast<double>(sum);
    }
};

inline Made make(const std::vector<Release>& releases, const Raster& bed, const frana::ParticleOptions& options = {}) {
    Made made;
    made.seeds = frana::make_seeds(releases, bed, options, made.reports, made.log);
    return made;
}

inline frana::ParticleOptions per_cell(double number) { return {number, {}, frana::Placement::lattice}; }
inline frana::ParticleOptions count_of(Index count, frana::Placement placement = frana::Placement::lattice) {
    return {4.0, count, placement};
}

}  // namespace release_maker
