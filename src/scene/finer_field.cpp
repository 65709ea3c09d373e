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

/// The depths of the parts of pixel (i, j) that are `places` pixels from its middle, along both axes, row after row. Their
/// mean is the pixel's own depth.
std::vector<double> parts_of(const Raster& field, Index i, Index j, const std::vector<double>& places) {
    std::vector<double> parts;
    double sum = 0.0;
    for (const double b : places)
        for (const double a : places) sum += parts.emplace_back(between(field, i, j, a, b));
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

/// The parts of a row that the square of a node covers, and the share of the node's width that each of them has.
struct CoveredParts {
    Index first;
    std::vector<double> shares;
};

/// Of each node, in a row of nodes and one of `count` parts. Places are those of the first middles [m].
std::vector<CoveredParts> parts_below(Index nodes, double start, double cell, Index count, double parts_start,
                                      double part) {
    constexpr double kRoundOff = 1e-6;   // of coordinates up to 1e9 parts; it makes no slivers
    const auto edge = [&](Index node) {  // west of it, in parts from the west edge of the first
        const double at = (start - parts_start + (static_cast<double>(node) - 0.5) * cell) / part + 0.5;
        return std::abs(at - std::round(at)) < kRoundOff ? std::round(at) : at;
    };
    std::vector<CoveredParts> below;
    for (Index node = 0; node < nodes; ++node) {
        const double low = std::max(edge(node), 0.0), high = std::min(edge(node + 1), static_cast<double>(count));
        CoveredParts& of = below.emplace_back(CoveredParts{static_cast<Index>(std::floor(low)), {}});
        for (auto k = static_cast<double>(of.first); k < high; k += 1.0)
            of.shares.push_back((std::min(high, k + 1.0) - std::max(low, k)) * part / cell);
    }
    return below;
}

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
            const std::vector<double> depths = parts_of(field, i, j, places);
            for (std::size_t k = 0; k < depths.size(); ++k) {
                const auto n = static_cast<Index>(k);
                result.at(i * parts + n % parts, j * parts + n / parts) = depths[k];
            }
        }
    return result;
}

Raster on_closer_nodes(const Raster& field, const GridGeometry& grid) {
    const Raster fine = finer_field(field, grid.cell);
    const GridGeometry &g = field.geometry, &parts = fine.geometry;
    const Index in_pixel = parts.nx / g.nx;
    Raster result = Raster::filled(grid, Raster::nodata);
    result.crs_wkt = field.crs_wkt, result.source = field.source;
    const auto rows = parts_below(grid.ny, grid.y0, grid.cell, parts.ny, parts.y0, parts.cell);
    const auto across = parts_below(grid.nx, grid.x0, grid.cell, parts.nx, parts.x0, parts.cell);
    for (Index j = 0; j < grid.ny; ++j)
        for (Index i = 0; i < grid.nx; ++i) {
            const CoveredParts &row = rows[static_cast<std::size_t>(j)],
                               &across_node = across[static_cast<std::size_t>(i)];
            double mean = 0.0;
            bool known = false;
            for (std::size_t v = 0; v < row.shares.size(); ++v)
                for (std::size_t u = 0; u < across_node.shares.size(); ++u) {
                    const Index x = across_node.first + static_cast<Index>(u), y = row.first + static_cast<Index>(v);
                    if (std::isnan(field.at(x / in_pixel, y / in_pixel))) continue;
                    known = true;
                    if (fine.at(x, y) > 0.0) mean += row.shares[v] * across_node.shares[u] * fine.at(x, y);
                }
            if (known) result.at(i, j) = mean;
        }
    return result;
}

}  // namespace frana
