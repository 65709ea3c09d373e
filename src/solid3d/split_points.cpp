#include "solid3d/split_points.h"

#include <algorithm>
#include <limits>

#include "solid3d/point_cells.h"

namespace frana {
namespace {

constexpr double kGap = 0.8;           // [cells]; points start half a cell apart, one piece to a cell (pieces.h)
constexpr double kFar = 1.75;          // [cells]: what lies beyond is another body
constexpr double kLeast = 1.0 / 64.0;  // of a cell: four points along each axis, when they started as two
constexpr double kShare = 0.25;        // of the distance: of a row, halves lie evenly

Vec3 between(const MaterialPoints& q, Index from, Index to) {
    return {q.x[0][to] - q.x[0][from], q.x[1][to] - q.x[1][from], q.x[2][to] - q.x[2][from]};
}

/// That of six directions, towards the faces of a cube around a point, in which another point lies.
int side_of(const Vec3& way) {
    int axis = 0;
    way.cwiseAbs().maxCoeff(&axis);
    return 2 * axis + (way[axis] > 0.0 ? 1 : 0);
}

/// Whether points lie within kGap in all six directions.
bool is_inside(const MaterialPoints& q, const PointCells& cells, Index p, Index cell) {
    constexpr int kAll = 0b111111;
    int closed = 0;
    return cells.any_near(cell, 1, [&](Index near) {
        for (Index n = cells.begin(near); n < cells.end(near); ++n) {
            if (cells.point(n) == p) continue;
            const Vec3 way = between(q, p, cells.point(n));
            if (way.squaredNorm() <= kGap * kGap) closed |= 1 << side_of(way);
        }
        return closed == kAll;
    });
}

/// The nearest point in each of six directions.
struct Around {
    double distance[6];  ///< [cells]
    Index point[6];

    Around(const MaterialPoints& q, const PointCells& cells, Index p, Index cell) {
        std::fill_n(distance, 6, std::numeric_limits<double>::infinity());
        std::fill_n(point, 6, Index{-1});
        cells.each_near(cell, PointCells::kReach, [&](Index near) {
            for (Index n = cells.begin(near); n < cells.end(near); ++n)
                if (cells.point(n) != p) meet(cells.point(n), between(q, p, cells.point(n)));
        });
    }
    void meet(Index other, const Vec3& way) {
        const int side = side_of(way);
        if (const double d = way.norm(); d < distance[side]) distance[side] = d, point[side] = other;
    }
};

/// Half the way between the halves; none where the point stays.
Vec3 way_of_halves(const MaterialPoints& q, const PointCells& cells, Index p, Index cell) {
    Vec3 way = Vec3::Zero();
    if (is_inside(q, cells, p, cell)) return way;
    const Around all(q, cells, p, cell);
    double nearest = kFar;
    for (int side = 0; side < 6; ++side) {
        if (!(all.distance[side] > kGap && all.distance[side] < nearest)) continue;
        const Index other = all.point[side];
        const Vec3 gap = between(q, p, other);
        const Vec3 parting(q.v[0][other] - q.v[0][p], q.v[1][other] - q.v[1][p], q.v[2][other] - q.v[2][p]);
        if (parting.dot(gap) < 0.0) continue;
        nearest = all.distance[side];
        way = kShare * gap;
    }
    return way;
}

}  // namespace

std::vector<SplitPoint> points_to_split(const MaterialPoints& points, const Grid3d& grid,
                                        const std::vector<std::uint8_t>& gone) {
    const PointCells cells(points, grid, gone);
    const double least = 2.0 * kLeast * grid.cell() * grid.cell() * grid.cell();
    std::vector<Vec3> way(static_cast<std::size_t>(points.count()), Vec3::Zero());
#pragma omp parallel for schedule(dynamic, 64)
    for (Index cell = 0; cell < cells.count(); ++cell)
        for (Index n = cells.begin(cell); n < cells.end(cell); ++n)
            if (const Index p = cells.point(n); points.rest_volume[p] >= least)
                way[static_cast<std::size_t>(p)] = way_of_halves(points, cells, p, cell);
    std::vector<SplitPoint> list;
    for (Index p = 0; p < points.count(); ++p)
        if (way[static_cast<std::size_t>(p)] != Vec3::Zero()) list.push_back({p, way[static_cast<std::size_t>(p)]});
    return list;
}

}  // namespace frana
