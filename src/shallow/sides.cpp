#include "shallow/sides.h"

#include <omp.h>

#include <algorithm>
#include <cmath>

#include "mpm/domain.h"

namespace frana {

template <class Real>
double leave(const Flow& flow, Index p, Index k, PointSums& sums) {
    const Carried<Real>& held = flow.particles.carried<Real>();
    const double m = flow.particles.mass[p], vx = held.vx[p], vy = held.vy[p], depth = held.depth[p];
    sums.left_count += 1;
    sums.left_mass += m;
    sums.left_px += m * vx;
    sums.left_py += m * vy;
    const double vz = flow.steep ? vx * flow.bed.slope_x[k] + vy * flow.bed.slope_y[k] : 0.0;
    const double energy =
        m * (0.5 * (vx * vx + vy * vy + vz * vz) + flow.gravity * (flow.bed.z[k] + 0.5 * std::max(depth, 0.0)));
    sums.left_energy += energy;
    return energy;
}

namespace {

/// A point on a wall is its own mirror particle. It has no speed across, and its domain does not lean. With FLIP it may
/// have come there with a speed of its own. That would change its sign each step, at one of two opposite walls only: 29
/// - 1e-19 is 29.
template <class Real>
void settle_on_walls(Flow& flow, Index p, double x_max, double y_max) {
    Particles& c = flow.particles;
    Carried<Real>& held = c.carried<Real>();
    const auto on = [](double& u, double end) {
        if (std::abs(u) > kOnWall && std::abs(u - end) > kOnWall) return false;
        u = u < 0.5 * end ? 0.0 : end;
        return true;
    };
    const bool on_x = on(c.x[p], x_max), on_y = on(c.y[p], y_max);
    if (!on_x && !on_y) return;
    if (on_x) held.vx[p] = Real{0};
    if (on_y) held.vy[p] = Real{0};
    held.cxy[p] = held.cyx[p] = Real{0};
    Moments moments = Moments::of(edges_of(held, p));
    if (moments.xy == 0.0) return;
    moments.xy = 0.0;
    set_edges(held, p, rectangle_of(moments));
}

/// A point at node (i, j) of a wall in a hole goes back over an edge of the node's pixel. It is the nearest
/// edge beyond which there is no wall. It goes back as far as it came, and has no speed against that edge. The wall's
/// height alone would not hold the foremost. Returns how far it was set back [cells].
template <class Real>
double stay_out(Flow& flow, Index p, Index i, Index j, PointSums& sums) {
    Particles& c = flow.particles;
    Carried<Real>& held = c.carried<Real>();
    const double dx = c.x[p] - static_cast<double>(i), dy = c.y[p] - static_cast<double>(j);
    double least = 4.0;
    Index to_x = 0, to_y = 0;
    for (const auto& [a, b] :
         {std::pair<Index, Index>{-1, 0}, {1, 0}, {0, -1}, {0, 1}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}}) {
        const double to_edge = 0.5 - static_cast<double>(a) * dx - static_cast<double>(b) * dy;
        const double way = a != 0 && b != 0 ? 1.5 + to_edge : to_edge;  // over corners only where no edge is free
        if (flow.bed.exit[flow.grid.at(i + a, j + b)] == kWall || way >= least) continue;
        least = way, to_x = a, to_y = b;
    }
    const double x = c.x[p], y = c.y[p];
    const auto turn = [&](Index to, double node, Array& place, ArrayOf<Real>& v,
                          std::array<ArrayOf<Real>*, 2> gradient) {
        if (to == 0) return 0.0;
        const double side = static_cast<double>(to), behind = 0.5 - side * (place[p] - node);
        place[p] = node + side * (0.5 + std::clamp(behind, 1e-9, 0.49));
        const double speed = v[p];
        for (ArrayOf<Real>* g : gradient) (*g)[p] = Real{0};
        if (side * speed >= 0.0) return 0.0;
        v[p] = Real{0};
        return -c.mass[p] * speed;
    };
    sums.wall_impulse_x += turn(to_x, static_cast<double>(i), c.x, held.vx, {&held.cxx, &held.cxy});
    sums.wall_impulse_y += turn(to_y, static_cast<double>(j), c.y, held.vy, {&held.cyx, &held.cyy});
    return std::max(std::abs(c.x[p] - x), std::abs(c.y[p] - y));
}

/// A long step could lead over a wall of one pixel. A point whose way does stops on that pixel, for the caller to set back.
void stop_on_way(Flow& flow, Index p, double dx, double dy) {
    constexpr double kStride = 0.5;  // [cells]: no pixel is missed, but for the corners of some
    Particles& c = flow.particles;
    const double parts = std::ceil(std::max(std::abs(dx), std::abs(dy)) / kStride);
    for (double part = 1.0; part < parts; ++part) {
        const double left = 1.0 - part / parts, x = c.x[p] - left * dx, y = c.y[p] - left * dy;
        if (flow.bed.exit[flow.grid.nearest(x, y)] != kWall) continue;
        c.x[p] = x, c.y[p] = y;
        return;
    }
}

}  // namespace

template <class Real>
double meet_side(Flow& flow, Index p, double dx, double dy, std::vector<std::uint8_t>& gone, PointSums& sums) {
    Particles& c = flow.particles;
    Carried<Real>& held = c.carried<Real>();
    if (flow.bed.has_exits) stop_on_way(flow, p, dx, dy);
    const double x_max = static_cast<double>(flow.grid.nx() - 1), y_max = static_cast<double>(flow.grid.ny() - 1);
    const bool outside_x = !(c.x[p] >= 0.0 && c.x[p] <= x_max), outside_y = !(c.y[p] >= 0.0 && c.y[p] <= y_max);
    if (flow.walls) {
        if (outside_x) {
            c.x[p] = c.x[p] < 0.0 ? -c.x[p] : 2.0 * x_max - c.x[p];
            for (auto* odd : {&held.vx[p], &held.cxy[p], &held.cyx[p], &held.r1x[p], &held.r2x[p]}) *odd = -*odd;
        }
        if (outside_y) {
            c.y[p] = c.y[p] < 0.0 ? -c.y[p] : 2.0 * y_max - c.y[p];
            for (auto* odd : {&held.vy[p], &held.cxy[p], &held.cyx[p], &held.r1y[p], &held.r2y[p]}) *odd = -*odd;
        }
        settle_on_walls<Real>(flow, p, x_max, y_max);
    }
    const Index k = flow.grid.nearest(c.x[p], c.y[p]);
    if ((!flow.walls && (outside_x || outside_y)) || leads_out(flow.bed.exit[k])) {
        gone[p] = 1;
        if (flow.bed.exit[k] == kHole) sums.lost_in_holes += c.mass[p];
        const double energy = leave<Real>(flow, p, k, sums);
        if (flow.bed.exit[k] == kNoted)
            flow.departed[static_cast<std::size_t>(omp_get_thread_num())].push_back(
                {c.id[p],
                 c.x[p],
                 c.y[p],
                 held.vx[p],
                 held.vy[p],
                 held.depth[p],
                 c.mass[p],
                 energy,
                 {held.cxx[p], held.cyx[p], held.cxy[p], held.cyy[p]},
                 edges_of(held, p)});
        c.mass[p] = 0.0;
    } else if (flow.bed.exit[k] == kWall) {
        const auto node = [](double place) { return static_cast<Index>(std::floor(place + 0.5)); };
        return stay_out<Real>(flow, p, node(c.x[p]), node(c.y[p]), sums);
    }
    return 0.0;
}

template double leave<double>(const Flow&, Index, Index, PointSums&);
template double leave<float>(const Flow&, Index, Index, PointSums&);
template double meet_side<double>(Flow&, Index, double, double, std::vector<std::uint8_t>&, PointSums&);
template double meet_side<float>(Flow&, Index, double, double, std::vector<std::uint8_t>&, PointSums&);

}  // namespace frana
