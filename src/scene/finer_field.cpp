// A depth field on pixels that are no larger than the cells.
#include <algorithm>
#include <cmath>

#include "scene/scene_parts.h"

namespace frana {
namespace {

/// The least and the largest depth of pixel (i, j) and the eight around it, of those that have material.
struct DepthRange {
    double low, high;
};
DepthRange range_around(const Raster& field, Index i, Index j) {
    const GridGeometry& g = field.geometry;
    DepthRange range{field.at(i, j), field.at(i, j)};
    for (Index b = std::max<Index>(j - 1, 0); b <= std::min(j + 1, g.ny - 1); ++b)
        for (Index a = std::max<Index>(i - 1, 0); a <= std::min(i + 1, g.nx - 1); ++a)
            if (const double depth = field.at(a, b); depth > 0.0)
                range.low = std::min(range.low, depth), range.high = std::max(range.high, depth);
    return range;
}

/// The share of the differences from a pixel's own depth with which all depths of its parts stay within a range.
double share_within(const DepthRange& range, double own, double lowest, double highest) {
    double share = 1.0;
    if (highest > range.high) share = std::min(share, (range.high - own) / (highest - own));
    if (lowest < range.low) share = std::min(share, (own - range.low) / (own - lowest));
    return share;
}

/// Between the middles of pixel (i, j) and its neighbours, at (u, v) pixels from its middle. Where a neighbour has no
/// material the pixel's own depth stands for it, so that material ends where it did.
double between(const Raster& field, Index i, Index j, double u, double v) {
    const GridGeometry& g = field.geometry;
    const double own = field.at(i, j);
    const auto depth = [&](Index a, Index b) {
        const bool there = a >= 0 && b >= 0 && a < g.nx && b < g.ny && field.at(a, b) > 0.0;
        return there ? field.at(a, b) : own;
    };
    const Index di = u < 0.0 ? -1 : 1, dj = v < 0.0 ? -1 : 1;
    const double fu = std::abs(u), fv = std::abs(v);
    return (1 - fu) * (1 - fv) * own + fu * (1 - fv) * depth(i + di, j) + (1 - fu) * fv * depth(i, j + dj) +
           fu * fv * depth(i + di, j + dj);
}

/// The depths of the parts of pixel (i, j) that are `u` and `v` pixels from its middle, row after row. Their mean is
/// the pixel's own depth.
std::vector<double> parts_of(const Raster& field, Index i, Index j, const std::vector<double>& u,
                             const std::vector<double>& v) {
    std::vector<double> parts;
    double sum = 0.0;
    for (const double b : v)
        for (const double a : u) sum += parts.emplace_back(between(field, i, j, a, b));
    const double own = field.at(i, j);
    const double keep = own * double(parts.size()) / sum;  // the pixel's volume stays the same
    double lowest = own, highest = own;
    for (double& depth : parts) {
        depth *= keep;
        lowest = std::min(lowest, depth), highest = std::max(highest, depth);
    }
    const double share = share_within(range_around(field, i, j), own, lowest, highest);
    if (share < 1.0)
        for (double& depth : parts) depth = own + share * (depth - own);
    return parts;
}

/// Nodes of a row that lie in a pixel, and where [pixels from its middle]. Those beyond the row count too: a part of a
/// terrain then has the same depths as all of it.
struct NodesInPixel {
    Index first;
    std::vector<double> places;
    NodesInPixel(double middle, double size, double start, double cell) {
        constexpr double kRoundOff = 1e-9;
        const auto after = [&](double edge) {
            return static_cast<Index>(std::ceil((edge - start) / cell - kRoundOff));
        };
        first = after(middle - 0.5 * size);
        for (Index n = first; n < after(middle + 0.5 * size); ++n)
            places.push_back((start + static_cast<double>(n) * cell - middle) / size);
    }
};

}  // namespace

Raster finer_field(const Raster& field, double cell) {
    constexpr double round_off = 1e-9;
    const GridGeometry& g = field.geometry;
    const auto parts = static_cast<Index>(std::ceil(g.cell / cell - round_off));
    if (parts <= 1) return field;
    const double fine = g.cell / double(parts);
    const double first = 0.5 * (fine - g.cell);  // of the first part's middle, from the pixel's
    Raster result = Raster::filled({g.nx * parts, g.ny * parts, g.x0 + first, g.y0 + first, fine}, Raster::nodata);
    result.crs_wkt = field.crs_wkt;
    result.source = field.source;
    std::vector<double> places;
    for (Index n = 0; n < parts; ++n) places.push_back((first + double(n) * fine) / g.cell);
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i) {
            if (!(field.at(i, j) > 0.0)) continue;
            const std::vector<double> depths = parts_of(field, i, j, places, places);
            for (std::size_t k = 0; k < depths.size(); ++k) {
                const auto n = static_cast<Index>(k);
                result.at(i * parts + n % parts, j * parts + n / parts) = depths[k];
            }
        }
    return result;
}

Raster on_closer_nodes(const Raster& field, const GridGeometry& grid) {
    const GridGeometry& g = field.geometry;
    Raster result = Raster::filled(grid, Raster::nodata);
    result.crs_wkt = field.crs_wkt, result.source = field.source;
    for (Index j = 0; j < g.ny; ++j) {
        const NodesInPixel rows(g.y(j), g.cell, grid.y0, grid.cell);
        for (Index i = 0; i < g.nx; ++i) {
            const double own = field.at(i, j);
            if (std::isnan(own)) continue;
            const NodesInPixel row(g.x(i), g.cell, grid.x0, grid.cell);
            const std::vector<double> depths =
                own > 0.0 ? parts_of(field, i, j, row.places, rows.places) : std::vector<double>();
            const auto wide = static_cast<Index>(row.places.size()), high = static_cast<Index>(rows.places.size());
            for (Index b = 0; b < high; ++b)
                for (Index a = 0; a < wide; ++a) {
                    const Index x = row.first + a, y = rows.first + b;
                    if (x < 0 || y < 0 || x >= grid.nx || y >= grid.ny) continue;
                    result.at(x, y) = depths.empty() ? 0.0 : depths[static_cast<std::size_t>(b * wide + a)];
                }
        }
    }
    return result;
}

}  // namespace frana
