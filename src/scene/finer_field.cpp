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
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i) {
            if (!(field.at(i, j) > 0.0)) continue;
            double sum = 0.0;
            const auto each = [&](auto&& use) {
                for (Index b = 0; b < parts; ++b)
                    for (Index a = 0; a < parts; ++a) use(a, b, result.at(i * parts + a, j * parts + b));
            };
            const auto place = [&](Index n) { return (first + double(n) * fine) / g.cell; };
            each([&](Index a, Index b, double& depth) {
                depth = between(field, i, j, place(a), place(b));
                sum += depth;
            });
            const double own = field.at(i, j);
            const double keep = own * double(parts * parts) / sum;  // the pixel's volume stays the same
            double lowest = own, highest = own;
            each([&](Index, Index, double& depth) {
                depth *= keep;
                lowest = std::min(lowest, depth), highest = std::max(highest, depth);
            });
            const double share = share_within(range_around(field, i, j), own, lowest, highest);
            if (share < 1.0) each([&](Index, Index, double& depth) { depth = own + share * (depth - own); });
        }
    return result;
}

}  // namespace frana
