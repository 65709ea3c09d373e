#include "solver/sides.h"

#include <algorithm>
#include <cmath>

namespace frana {
namespace {

void leave(const Flow& flow, Index p, Index k, PointSums& sums) {
    const Columns& c = flow.columns;
    const double m = c.mass[p], vx = c.vx[p], vy = c.vy[p];
    sums.left_count += 1;
    sums.left_mass += m;
    sums.left_px += m * vx;
    sums.left_py += m * vy;
    const double vz = flow.steep ? vx * flow.bed.slope_x[k] + vy * flow.bed.slope_y[k] : 0.0;
    sums.left_energy += m * (0.5 * (vx * vx + vy * vy + vz * vz) +
                             flow.gravity * (flow.bed.z[k] + 0.5 * std::max(c.depth[p], 0.0)));
}

}  // namespace

void meet_side(Flow& flow, Index p, std::vector<std::uint8_t>& gone, PointSums& sums) {
    Columns& c = flow.columns;
    const double x_max = static_cast<double>(flow.grid.nx() - 1), y_max = static_cast<double>(flow.grid.ny() - 1);
    const bool outside_x = !(c.x[p] >= 0.0 && c.x[p] <= x_max), outside_y = !(c.y[p] >= 0.0 && c.y[p] <= y_max);
    if (flow.walls) {
        if (outside_x) {
            c.x[p] = c.x[p] < 0.0 ? -c.x[p] : 2.0 * x_max - c.x[p];
            for (auto* odd : {&c.vx[p], &c.cxy[p], &c.cyx[p], &c.r1x[p], &c.r2x[p]}) *odd = -*odd;
        }
        if (outside_y) {
            c.y[p] = c.y[p] < 0.0 ? -c.y[p] : 2.0 * y_max - c.y[p];
            for (auto* odd : {&c.vy[p], &c.cxy[p], &c.cyx[p], &c.r1y[p], &c.r2y[p]}) *odd = -*odd;
        }
    }
    const Index k = flow.grid.at(static_cast<Index>(std::floor(c.x[p] + 0.5)),
                                 static_cast<Index>(std::floor(c.y[p] + 0.5)));
    if ((!flow.walls && (outside_x || outside_y)) || flow.bed.exit[k]) {
        gone[p] = 1;
        leave(flow, p, k, sums);
        c.mass[p] = 0.0;
    }
}

}  // namespace frana
