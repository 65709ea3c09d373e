// Where a release lies on the grid: marks for checks, and the cut out of the bed.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "particles/generate.h"
#include "scene/scene_parts.h"
#include "terrain/outline_area.h"

namespace frana {
namespace {

Index nearest(double coordinate, double first, double cell) {
    return static_cast<Index>(std::floor((coordinate - first) / cell + 0.5));
}

void mark(NodeMarks& marks, const GridGeometry& grid, Index i, Index j) {
    if (i >= 0 && i < grid.nx && j >= 0 && j < grid.ny) marks[static_cast<std::size_t>(j * grid.nx + i)] = 1;
}

/// Marks the nodes whose pixels an edge passes, closely enough for a check.
void mark_edge(NodeMarks& marks, const GridGeometry& grid, const Vec2& a, const Vec2& b) {
    const Index steps = 1 + static_cast<Index>((b - a).norm() / (0.25 * grid.cell));
    for (Index k = 0; k <= steps; ++k) {
        const Vec2 point = a + (b - a) * (static_cast<double>(k) / static_cast<double>(steps));
        mark(marks, grid, nearest(point.x(), grid.x0, grid.cell), nearest(point.y(), grid.y0, grid.cell));
    }
}

/// Even-odd filling, row by row of nodes.
void mark_inside(NodeMarks& marks, const GridGeometry& grid, const Polygon& polygon) {
    std::vector<std::vector<double>> crossings(static_cast<std::size_t>(grid.ny));
    for (const auto& ring : polygon.rings) {
        for (std::size_t k = 0; k < ring.size(); ++k) {
            Vec2 low = ring[k];
            Vec2 high = ring[(k + 1) % ring.size()];
            mark_edge(marks, grid, low, high);
            if (low.y() > high.y()) std::swap(low, high);
            const double begin = std::clamp(std::ceil((low.y() - grid.y0) / grid.cell), 0.0, double(grid.ny));
            for (Index j = static_cast<Index>(begin); j < grid.ny && grid.y(j) < high.y(); ++j) {
                const double share = (grid.y(j) - low.y()) / (high.y() - low.y());
                crossings[static_cast<std::size_t>(j)].push_back(low.x() + share * (high.x() - low.x()));
            }
        }
    }
    for (Index j = 0; j < grid.ny; ++j) {
        auto& row = crossings[static_cast<std::size_t>(j)];
        std::sort(row.begin(), row.end());
        for (std::size_t k = 0; k + 1 < row.size(); k += 2) {
            const double begin = std::clamp(std::ceil((row[k] - grid.x0) / grid.cell), 0.0, double(grid.nx));
            for (Index i = static_cast<Index>(begin); i < grid.nx && grid.x(i) <= row[k + 1]; ++i)
                mark(marks, grid, i, j);
        }
    }
}

/// Marks the nodes of every pixel with material: those in the pixel, and the nearest one where it is small.
NodeMarks marks_of_field(const Raster& field, const GridGeometry& grid) {
    NodeMarks marks(static_cast<std::size_t>(grid.size()), 0);
    if (field.geometry == grid) {
        for (std::size_t k = 0; k < marks.size(); ++k) marks[k] = field.values[k] > 0.0;
        return marks;
    }
    const double half = 0.5 * field.geometry.cell;
    for (Index r = 0; r < field.geometry.ny; ++r) {
        for (Index c = 0; c < field.geometry.nx; ++c) {
            if (!(field.at(c, r) > 0.0)) continue;
            const double x = field.geometry.x(c);
            const double y = field.geometry.y(r);
            mark(marks, grid, nearest(x, grid.x0, grid.cell), nearest(y, grid.y0, grid.cell));
            if (field.geometry.cell <= grid.cell) continue;
            const Index i0 = std::max<Index>(0, nearest(x - half, grid.x0, grid.cell));
            const Index i1 = std::min<Index>(grid.nx - 1, nearest(x + half, grid.x0, grid.cell));
            const Index j0 = std::max<Index>(0, nearest(y - half, grid.y0, grid.cell));
            const Index j1 = std::min<Index>(grid.ny - 1, nearest(y + half, grid.y0, grid.cell));
            for (Index j = j0; j <= j1; ++j)
                for (Index i = i0; i <= i1; ++i) mark(marks, grid, i, j);
        }
    }
    return marks;
}

/// Marked nodes and all within `reach` of them, in x and y separately (a square).
NodeMarks widened(const NodeMarks& marks, const GridGeometry& grid, Index reach) {
    NodeMarks rows(marks.size(), 0);
    for (Index j = 0; j < grid.ny; ++j)
        for (Index i = 0; i < grid.nx; ++i)
            if (marks[static_cast<std::size_t>(j * grid.nx + i)])
                for (Index k = -reach; k <= reach; ++k) mark(rows, grid, i + k, j);
    NodeMarks result(marks.size(), 0);
    for (Index j = 0; j < grid.ny; ++j)
        for (Index i = 0; i < grid.nx; ++i)
            if (rows[static_cast<std::size_t>(j * grid.nx + i)])
                for (Index k = -reach; k <= reach; ++k) mark(result, grid, i, j + k);
    return result;
}

}  // namespace

NodeMarks nodes_under(const Release& release, const GridGeometry& grid) {
    NodeMarks marks(static_cast<std::size_t>(grid.size()), release.outline ? 0 : 1);
    if (release.outline)
        for (const Polygon& polygon : release.outline->parts) mark_inside(marks, grid, polygon);
    if (!release.depth_field) return marks;
    const NodeMarks material = marks_of_field(*release.depth_field, grid);
    for (std::size_t k = 0; k < marks.size(); ++k) marks[k] = marks[k] && material[k];
    return marks;
}

NodeMarks pixels_under(const Polygons& outline, const GridGeometry& pixels) {
    constexpr double kSliver = 1e-6;  // of a pixel: round-off of coordinates, as of a file that was reprojected
    const auto extent = pixels.pixel_extent();
    const auto lines = [&](Index count) {
        std::vector<double> all;
        for (Index k = 0; k <= count; ++k) all.push_back(static_cast<double>(k) * pixels.cell);
        return all;
    };
    OutlineArea areas(rings_of(outline, {extent[0], extent[1]}), lines(pixels.nx), lines(pixels.ny));
    NodeMarks marks(static_cast<std::size_t>(pixels.size()), 0);
    std::vector<double> area(static_cast<std::size_t>(pixels.nx));
    for (Index j = 0; j < pixels.ny; ++j) {
        const auto [first, second] = areas.row(j, area);
        for (Index i = first; i < second; ++i)
            marks[static_cast<std::size_t>(j * pixels.nx + i)] =
                area[static_cast<std::size_t>(i)] > kSliver * pixels.cell * pixels.cell;
    }
    return marks;
}

bool holds_shore(const Release& release, const Raster& bed, double level) {
    Release bare;
    bare.outline = release.outline;
    const GridGeometry& grid = bed.geometry;
    const NodeMarks inside = nodes_under(bare, grid), around = widened(inside, grid, 1);
    NodeMarks outside(inside.size(), 0);
    for (std::size_t k = 0; k < inside.size(); ++k) outside[k] = !inside[k];
    const NodeMarks within = widened(outside, grid, 1);
    for (std::size_t k = 0; k < inside.size(); ++k)  // the edge: nodes of either side that have a neighbour on the
                                                     // other
        if (around[k] && within[k] && !(bed.values[k] >= level)) return false;
    return true;
}

void refuse_nodata(const NodeMarks& marks, const Raster& bed, Index reach) {
    const GridGeometry& grid = bed.geometry;
    const NodeMarks near = widened(marks, grid, reach);
    Index count = 0;
    Index first = -1;
    for (Index row = 0; row < grid.ny; ++row) {  // from the north, as people read maps
        for (Index i = 0; i < grid.nx; ++i) {
            const Index k = (grid.ny - 1 - row) * grid.nx + i;
            if (!near[static_cast<std::size_t>(k)] || !std::isnan(bed.values[static_cast<std::size_t>(k)])) continue;
            if (count++ == 0) first = k;
        }
    }
    if (count == 0) return;
    const Index i = first % grid.nx;
    const Index j = first / grid.nx;
    throw UserError(
        fmt::format("found nodata under or within {} cells of the material at {} pixel{}, the first at row "
                    "{}, column {} (from "
                    "the north-west, counted from 0; map {:.10g}, {:.10g}); expected elevations there; fill "
                    "the gaps (gdal_fillnodata.py {} "
                    "filled.tif), or move the release away from them",
                    reach, count, count == 1 ? "" : "s", grid.ny - 1 - j, i, grid.x(i), grid.y(j),
                    bed.source.empty() ? "dem.tif" : bed.source));
}

double cut_release(const Release& release, Raster& bed) {
    // With 16 patches a cell the lattice fits into the pixels of the nodes. So the sums below are exact means.
    ParticleOptions options;
    options.per_cell = 16;
    std::vector<ReleaseReport> reports;
    std::vector<std::string> unused;
    const Seeds seeds = make_seeds({release}, bed, options, reports, unused);
    const GridGeometry& grid = bed.geometry;
    double total = 0.0;
    for (std::size_t p = 0; p < seeds.x.size(); ++p) {
        const Index i = nearest(seeds.x[p], grid.x0, grid.cell);
        const Index j = nearest(seeds.y[p], grid.y0, grid.cell);
        bed.at(i, j) -= seeds.volume[p] / (grid.cell * grid.cell);
        total += seeds.volume[p];
    }
    return total;
}

Vec2 node_gradient(const Raster& raster, Index i, Index j) {
    const GridGeometry& grid = raster.geometry;
    if (i > 0 && j > 0 && i + 1 < grid.nx &&
        j + 1 < grid.ny) {  // most nodes, at once: all of them may need the terrain
        const double west = raster.at(i - 1, j), east = raster.at(i + 1, j), south = raster.at(i, j - 1),
                     north = raster.at(i, j + 1), across = 2.0 * grid.cell;
        if (std::isfinite(west) && std::isfinite(east) && std::isfinite(south) && std::isfinite(north))
            return {(east - west) / across, (north - south) / across};
    }
    const auto along = [&](Index di, Index dj) {
        const auto there = [&](Index s) {
            const Index ii = i + s * di;
            const Index jj = j + s * dj;
            return ii >= 0 && ii < grid.nx && jj >= 0 && jj < grid.ny && std::isfinite(raster.at(ii, jj));
        };
        const Index back = there(-1) ? -1 : 0;
        const Index ahead = there(1) ? 1 : 0;
        if (ahead == back) return 0.0;
        const double rise = raster.at(i + ahead * di, j + ahead * dj) - raster.at(i + back * di, j + back * dj);
        return rise / (double(ahead - back) * grid.cell);
    };
    return {along(1, 0), along(0, 1)};
}

}  // namespace frana
