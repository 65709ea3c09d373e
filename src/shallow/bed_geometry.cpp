#include "shallow/bed_geometry.h"

#include <algorithm>
#include <deque>

#include "base/error.h"
#include "scene/bed_smoothing.h"
#include "terrain/places.h"

namespace frana {
namespace {

/// A rectangle of storage rows and columns on which static fields are computed; all loops run over it.
struct Window {
    const TileGrid& grid;
    Index i0() const { return -kTile; }
    Index j0() const { return -kTile; }
    Index i1() const { return grid.tiles_x() * kTile - kTile; }
    Index j1() const { return grid.tiles() / grid.tiles_x() * kTile - kTile; }
};

template <class Body>
void for_each_node(const TileGrid& grid, Index margin, Body&& body) {
    const Window window{grid};
#pragma omp parallel for schedule(static)
    for (Index j = window.j0() + margin; j < window.j1() - margin; ++j)
        for (Index i = window.i0() + margin; i < window.i1() - margin; ++i) body(i, j, grid.at(i, j));
}

/// Elevation of the nearest node that has one, breadth first from the known nodes. So shape functions near the edge of
/// the data have something to average.
std::vector<double> filled(const Raster& bed) {
    const Index nx = bed.geometry.nx, ny = bed.geometry.ny;
    std::vector<double> z = bed.values;
    if (std::none_of(z.begin(), z.end(), [](double here) { return std::isnan(here); })) return z;
    std::deque<Index> front;
    for (Index k = 0; k < nx * ny; ++k)
        if (!std::isnan(z[k])) front.push_back(k);
    if (front.empty())
        throw UserError(bed.source + ": the elevation model holds no data in the window; choose another window");
    while (!front.empty()) {
        const Index k = front.front(), i = k % nx, j = k / nx;
        front.pop_front();
        const auto spread = [&](Index neighbour) {
            if (!std::isnan(z[neighbour])) return;
            z[neighbour] = z[k];
            front.push_back(neighbour);
        };
        if (i > 0) spread(k - 1);
        if (i + 1 < nx) spread(k + 1);
        if (j > 0) spread(k - nx);
        if (j + 1 < ny) spread(k + nx);
    }
    return z;
}

/// Index into 0..n-1 and the sign and offset of the extension beyond of the values z(i, j). It is mirrored at walls, odd
/// about the end value (linear for a plane) at open sides.
template <class Values>
double extended_by(const Values& z, Index nx, Index ny, Index i, Index j, bool wall) {
    if (i >= 0 && i < nx && j >= 0 && j < ny) return z(i, j);
    const auto inside = [](Index k, Index n) { return std::clamp<Index>(k, 0, n - 1); };
    const auto mirror = [](Index k, Index n) {
        if (n == 1) return Index{0};
        const Index period = 2 * (n - 1);
        k = ((k % period) + period) % period;
        return k < n ? k : period - k;
    };
    const Index im = mirror(i, nx), jm = mirror(j, ny);
    if (wall) return z(im, jm);
    const Index ic = inside(i, nx), jc = inside(j, ny);
    return 2.0 * z(ic, jc) - z(inside(2 * ic - i, nx), inside(2 * jc - j, ny));
}

double extended(const std::vector<double>& z, Index nx, Index ny, Index i, Index j, bool wall) {
    return extended_by([&](Index a, Index b) { return z[b * nx + a]; }, nx, ny, i, j, wall);
}

/// The same up to kTile nodes beyond the domain on every side, whatever the tiles. Filters that run often carry in what
/// lies at the edge, and mirrored nodes must stay so. The outer `margin_x` columns and `margin_y` rows are left out.
template <class Body>
void for_each_node_around(const TileGrid& grid, Index margin_x, Index margin_y, Body&& body) {
#pragma omp parallel for schedule(static)
    for (Index j = margin_y - kTile; j < grid.ny() + kTile - margin_y; ++j)
        for (Index i = margin_x - kTile; i < grid.nx() + kTile - margin_x; ++i) body(grid.at(i, j));
}

enum class Axis { x, y };

/// Applies the symmetric weights w[0] (centre), w[1], w[2] along one direction, in all of its lines. Only so do the two
/// directions commute, and what is symmetric about a diagonal stays so.
void smooth(const TileGrid& grid, LazyArray<double>& field, LazyArray<double>& scratch, Axis axis,
            const std::array<double, 3>& w) {
    const Index step = axis == Axis::x ? 1 : grid.stride();
    const Index margin_x = axis == Axis::x ? 2 : 0, margin_y = 2 - margin_x;
    for_each_node_around(grid, margin_x, margin_y, [&](Index k) {
        scratch[k] = w[0] * field[k] + w[1] * (field[k - step] + field[k + step]) +
                     w[2] * (field[k - 2 * step] + field[k + 2 * step]);
    });
    for_each_node_around(grid, margin_x, margin_y, [&](Index k) { field[k] = scratch[k]; });
}

/// Average of a bilinear bed with the scheme's own shape function: B-splines of two degrees more at whole numbers.
std::array<double, 3> averaging(const Scene& scene) {
    switch (scene.scheme.shape) {
        case Shape::linear:
            return {1.0, 0.0, 0.0};
        case Shape::quadratic:
            return {230.0 / 384.0, 76.0 / 384.0, 1.0 / 384.0};
        case Shape::cubic:
            return {66.0 / 120.0, 26.0 / 120.0, 1.0 / 120.0};
    }
    throw InternalError("unknown shape");
}

void average(const Scene& scene, const TileGrid& grid, LazyArray<double>& field, LazyArray<double>& scratch) {
    if (scene.scheme.shape == Shape::linear) return;
    smooth(grid, field, scratch, Axis::x, averaging(scene));
    smooth(grid, field, scratch, Axis::y, averaging(scene));
}

/// Change of slope over a cell that a step can follow. A step moves a point by up to scheme.cfl of a cell. A sharper
/// bend (a cliff's foot in one cell) would turn more than the speed at hand. What is sharper counts as this.
constexpr double kSharpest = 0.5;

/// Slope by the 4th-order stencil that also differentiates the free surface.
double slope_at(const double* z, Index step, double cell) {
    return (8.0 * (z[step] - z[-step]) - (z[2 * step] - z[-2 * step])) * (1.0 / (12.0 * cell));
}

/// The bed averaged over the shape function and smoothed to `curvature_length`, extended linearly whatever the sides. A
/// slope that meets a wall is mirrored for the pressure, but it has no curvature there.
LazyArray<double> smoothed_bed(const Scene& scene, const TileGrid& grid, const std::vector<double>& z) {
    LazyArray<double> smoothed(grid.size()), scratch(grid.size());
    for_each_node(grid, 0,
                  [&](Index i, Index j, Index k) { smoothed[k] = extended(z, grid.nx(), grid.ny(), i, j, false); });
    average(scene, grid, smoothed, scratch);
    const Index passes = smoothing_passes(scene.scheme, grid.cell());
    const std::array<double, 3> binomial{0.5, 0.25, 0.0};
    for (Index pass = 0; pass < passes; ++pass) {
        smooth(grid, smoothed, scratch, Axis::x, binomial);
        smooth(grid, smoothed, scratch, Axis::y, binomial);
    }
    return smoothed;
}

struct Curved {
    double xx, xy, yy;
};
Curved curvature_at(const double* c, Index up, double cell) {
    const auto held = [&](double h) { return std::clamp(h, -kSharpest / cell, kSharpest / cell); };
    return {held((c[1] - 2.0 * c[0] + c[-1]) / (cell * cell)),
            held((c[up + 1] - c[up - 1] - c[-up + 1] + c[-up - 1]) / (4.0 * cell * cell)),
            held((c[up] - 2.0 * c[0] + c[-up]) / (cell * cell))};
}

double least_of_five(const double* c, Index step) {
    return std::min(std::min(std::min(c[0], c[step]), std::min(c[-step], c[2 * step])), c[-2 * step]);
}

/// The least of the 5 x 5 values around each of `count` ones in a row.
void least_around(const double* c, Index up, Index count, double* least) {
    static_assert(kSlopeReach == 2);
    double of_columns[kTile + 2 * kSlopeReach];
    for (Index i = 0; i < count + 2 * kSlopeReach; ++i) of_columns[i] = least_of_five(c + i - kSlopeReach, up);
    for (Index i = 0; i < count; ++i) least[i] = least_of_five(of_columns + i + kSlopeReach, 1);
}

/// Calls body(storage index of the first, count) for the rows of a tile's nodes, of those so many nodes away from the
/// storage's ends.
template <class Body>
void for_each_row(const TileGrid& grid, Index tile, const TileBox& nodes, Index margin, Body&& body) {
    const Window window{grid};
    const Index i = grid.tile_i(tile), j = grid.tile_j(tile);
    const Index i0 = std::max(i + nodes.i0, window.i0() + margin), i1 = std::min(i + nodes.i1, window.i1() - margin);
    const Index j0 = std::max(j + nodes.j0, window.j0() + margin), j1 = std::min(j + nodes.j1, window.j1() - margin);
    for (Index row = j0; row < j1; ++row)
        if (i0 < i1) body(grid.at(i0, row), i1 - i0);
}

LazyArray<Pair> slopes_of(const TileGrid& grid, const LazyArray<double>& smoothed) {
    LazyArray<Pair> slopes(grid.size());
    for_each_node(grid, 3, [&](Index, Index, Index k) {
        const double* c = smoothed.data() + k;
        slopes[k] = {slope_at(c, 1, grid.cell()), slope_at(c, grid.stride(), grid.cell())};
    });
    return slopes;
}

void fill_curvature(const TileGrid& grid, const LazyArray<double>& smoothed, BedGeometry& bed) {
    const double cell = grid.cell();
    bed.hxx = LazyArray<double>(grid.size());
    bed.hxy = LazyArray<double>(grid.size());
    bed.hyy = LazyArray<double>(grid.size());
    const Index up = grid.stride();
    for_each_node(grid, 3, [&](Index, Index, Index k) {
        const double* c = smoothed.data() + k;
        const Curved h = curvature_at(c, up, cell);
        bed.hxx[k] = h.xx, bed.hxy[k] = h.xy, bed.hyy[k] = h.yy;
    });
}

/// The bed with walls in its holes; as it is where there are none.
std::vector<double> walled(const Scene& scene, std::vector<double> z) {
    if (scene.hole_top)
        for (const Index node : scene.holes.nodes) z[static_cast<std::size_t>(node)] += *scene.hole_top;
    return z;
}

/// Says of every node what kind it is.
void mark_exits(const Scene& scene, const TileGrid& grid, BedGeometry& bed) {
    const Index nx = grid.nx(), ny = grid.ny();
    bed.exit = LazyArray<std::uint8_t>(grid.size());
    const std::vector<double>& z = scene.bed.values;
    for (Index n = 0; n < nx * ny; ++n)
        if (std::isnan(z[static_cast<std::size_t>(n)]))
            bed.exit[grid.at(n % nx, n / nx)] = kNoData, bed.has_exits = true;
    for (const Index n : scene.holes.nodes) bed.exit[grid.at(n % nx, n / nx)] = scene.hole_top ? kWall : kHole;
}

}  // namespace

LazyArray<Pair> smooth_slopes(const Scene& scene, const TileGrid& grid) {
    return slopes_of(grid, smoothed_bed(scene, grid, filled(scene.bed)));
}

BedGeometry make_bed_geometry(const Scene& scene, const TileGrid& grid) {
    BedGeometry bed;
    const Index nx = grid.nx(), ny = grid.ny(), up = grid.stride();
    const bool wall = are_closed(scene.sides);
    const std::vector<double> z = filled(scene.bed), raised = walled(scene, z);
    bed.averaging = averaging(scene);
    bed.z = LazyArray<double>(grid.size());
    bed.ground = LazyArray<double>(grid.size());
    for_each_node(grid, 0, [&](Index i, Index j, Index k) {
        const bool inside = i >= 0 && i < nx && j >= 0 && j < ny;  // an open side goes on as if no wall were near
        bed.z[k] = bed.ground[k] = extended(inside || wall ? raised : z, nx, ny, i, j, wall);
    });
    mark_exits(scene, grid, bed);
    LazyArray<double> scratch(grid.size());
    average(scene, grid, bed.z, scratch);
    bed.z_min = LazyArray<double>(grid.size());
    bed.slope_x = LazyArray<double>(grid.size());
    bed.slope_y = LazyArray<double>(grid.size());
    for_each_node(grid, 4, [&](Index, Index, Index k) {
        const double* c = bed.z.data() + k;
        bed.slope_x[k] = slope_at(c, 1, grid.cell());
        bed.slope_y[k] = slope_at(c, up, grid.cell());
        least_around(c, up, 1, &bed.z_min[k]);
    });
    if (scene.terrain == TerrainModel::shallow) return bed;
    LazyArray<double> smoothed = smoothed_bed(scene, grid, z);
    bed.smooth = slopes_of(grid, smoothed);
    if (scene.curvature != Curvature::none) fill_curvature(grid, smoothed, bed);
    if (scene.bed_evolves()) bed.smoothed = std::move(smoothed);
    return bed;
}

void refresh_slopes(const TileGrid& grid, BedGeometry& bed, Index tile, const TileBox& nodes) {
    const Index up = grid.stride();
    const double cell = grid.cell();
    for_each_row(grid, tile, nodes, 4, [&](Index first, Index count) {
        const double* const c = bed.z.data() + first;
        double *const x = &bed.slope_x[first], *const y = &bed.slope_y[first];
        for (Index i = 0; i < count; ++i) x[i] = slope_at(c + i, 1, cell);
        for (Index i = 0; i < count; ++i) y[i] = slope_at(c + i, up, cell);
        least_around(c, up, count, &bed.z_min[first]);
    });
}

void refresh_path(const TileGrid& grid, BedGeometry& bed, Index tile) {
    const Index up = grid.stride();
    for_each_row(grid, tile, TileBox::whole(), 3, [&](Index first, Index count) {
        for (Index k = first; k < first + count; ++k) {
            const double* c = bed.smoothed.data() + k;
            bed.smooth[k] = {slope_at(c, 1, grid.cell()), slope_at(c, up, grid.cell())};
            if (!bed.hxx) continue;
            const Curved h = curvature_at(c, up, grid.cell());
            bed.hxx[k] = h.xx, bed.hxy[k] = h.xy, bed.hyy[k] = h.yy;
        }
    });
}

namespace {

/// Depths on the nodes of a box, none elsewhere.
struct Depths {
    NodeBox box;
    std::vector<double> values;

    Depths(const std::vector<ScarNode>& nodes, const GridGeometry& g) {
        const auto place = [&](const ScarNode& node) {
            const NodeAt nearest = nearest_node(g, node.at);
            return std::array<Index, 2>{nearest.i, nearest.j};
        };
        auto low = place(nodes.front()), high = low;
        for (const ScarNode& node : nodes)
            for (std::size_t n = 0; n < 2; ++n)
                low[n] = std::min(low[n], place(node)[n]), high[n] = std::max(high[n], place(node)[n]);
        box = {low[0], low[1], high[0] - low[0] + 1, high[1] - low[1] + 1};
        values.assign(static_cast<std::size_t>(box.nx * box.ny), 0.0);
        for (const ScarNode& node : nodes) {
            const auto [i, j] = place(node);
            values[static_cast<std::size_t>((j - box.j0) * box.nx + i - box.i0)] += node.depth;
        }
    }
    bool has(Index i, Index j) const {
        return i >= box.i0 && j >= box.j0 && i < box.i0 + box.nx && j < box.j0 + box.ny;
    }
    double operator()(Index i, Index j) const {
        return has(i, j) ? values[static_cast<std::size_t>((j - box.j0) * box.nx + i - box.i0)] : 0.0;
    }
};

/// Nodes of one direction, first and past the last, that feel what nodes `first` to `past` have. All beyond a side do
/// where the extension beyond it may.
std::array<Index, 2> felt(Index first, Index past, Index n, Index storage_end) {
    constexpr Index kReach = 2;  // of averaging
    const bool low = first - kReach <= kTile, high = past + kReach >= n - kTile;
    return {low ? -kTile : first - kReach, high ? storage_end : past + kReach};
}

/// As smooth() has it, along x and then y, around a node.
template <class Values>
double averaged(const Values& values, const std::array<double, 3>& w, Index i, Index j) {
    const auto row = [&](Index b) {
        return w[0] * values(i, b) + w[1] * (values(i - 1, b) + values(i + 1, b)) +
               w[2] * (values(i - 2, b) + values(i + 2, b));
    };
    return w[0] * row(j) + w[1] * (row(j - 1) + row(j + 1)) + w[2] * (row(j - 2) + row(j + 2));
}

}  // namespace

std::vector<NodeFall> falls_of(const std::vector<ScarNode>& cut, const TileGrid& grid, const BedGeometry& bed,
                               bool walls) {
    std::vector<NodeFall> falls;
    if (cut.empty()) return falls;
    const Depths depths(cut, grid.geometry());
    const Index nx = grid.nx(), ny = grid.ny();
    const Window window{grid};
    const auto by_sides = [&](Index i, Index j) { return extended_by(depths, nx, ny, i, j, walls); };
    const auto linear = [&](Index i, Index j) { return extended_by(depths, nx, ny, i, j, false); };
    const auto [i0, i1] = felt(depths.box.i0, depths.box.i0 + depths.box.nx, nx, window.i1());
    const auto [j0, j1] = felt(depths.box.j0, depths.box.j0 + depths.box.ny, ny, window.j1());
    for (Index j = j0; j < j1; ++j)
        for (Index i = i0; i < i1; ++i) {
            const NodeFall fall{grid.at(i, j),
                                i,
                                j,
                                by_sides(i, j),
                                averaged(by_sides, bed.averaging, i, j),
                                averaged(linear, bed.averaging, i, j)};
            if (fall.ground != 0.0 || fall.z != 0.0 || fall.path != 0.0) falls.push_back(fall);
        }
    return falls;
}

BedGeometry level_bed(const TileGrid& grid) {
    BedGeometry bed;
    for (auto* field : {&bed.z, &bed.ground, &bed.z_min, &bed.slope_x, &bed.slope_y})
        *field = LazyArray<double>(grid.size());
    bed.exit = LazyArray<std::uint8_t>(grid.size());
    return bed;
}

}  // namespace frana
