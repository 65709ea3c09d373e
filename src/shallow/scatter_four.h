#pragma once
// Four points at once: their masses, momenta and stresses on the nodes, point after point.
#include "law/rheology/laws.h"
#include "mpm/stencils.h"
#include "shallow/nodes.h"

namespace frana {

/// Mass [kg], momentum, and mass times cell times velocity gradient, kl: dv_k / dx_l [kg m/s], of four points.
struct FourMotions {
    Double4 mass, px, py, xx, xy, yx, yy;
};

/// What a point brings to its three by three nodes. A node's momentum is wx wy (b + i qx + j qy), its force
/// sx wy fx + wx sy fy. Both are one product of wx with a vector of the row, and one of {i wx, sx} with another.
struct Brought {
    Double4 base, along_x, along_y;  ///< {b, fy}, {qx, fx}, {qy, 0}
    Double4 mass;                    ///< of a row, times wx
    Double4 of_row, of_column;       ///< {wy0, wy1, sy0, sy1}, {0, wx1, sx0, sx1}
    Double4 of_third;                ///< {2 wx2, wy2, sx2, sy2}
    Double4 unused;                  ///< 256 bytes: a lane's address is a shift
};

/// Mass, momentum and the force -V sigma grad N of four points. The force is the weak form of div(h sigma) (Fois et al.
/// 2024, eq. 21). `internal_force`: V sigma / cell [N].
[[gnu::always_inline]] inline void scatter_four(Nodes& nodes, Index stride, int lanes, const Stencils& sx,
                                                const Stencils& sy, const FourMotions& q,
                                                const PlaneOf<Double4>& internal_force) {
    const Double4 zero = {}, m = q.mass;
    Brought brought[4];
    const auto fill = [&](Double4 Brought::*what, Double4 a, Double4 b, Double4 c, Double4 d) {
        Double4 of[4];
        transpose(a, b, c, d, of);
        for (int lane = 0; lane < 4; ++lane) brought[lane].*what = of[lane];
    };
    fill(&Brought::base, q.px - (sx.offset * q.xx + sy.offset * q.xy), q.py - (sx.offset * q.yx + sy.offset * q.yy),
         -internal_force.xy, -internal_force.yy);
    fill(&Brought::along_x, q.xx, q.yx, -internal_force.xx, -internal_force.xy);
    fill(&Brought::along_y, q.xy, q.yy, zero, zero);
    fill(&Brought::mass, m * sx.w[0], m * sx.w[1], m * sx.w[2], zero);
    fill(&Brought::of_row, sy.w[0], sy.w[1], sy.s[0], sy.s[1]);
    fill(&Brought::of_column, zero, sx.w[1], sx.s[0], sx.s[1]);
    fill(&Brought::of_third, sx.w[2] + sx.w[2], sy.w[2], sx.s[2], sy.s[2]);
    Deposit* const deposits = nodes.deposits();
    double* const masses = nodes.mass.data();
    Index node[4];
    for (int lane = 0; lane < 4; ++lane) node[lane] = sy.first[lane] * stride + sx.first[lane];
    for (int lane = 0; lane < lanes; ++lane) {
        const Brought& b = brought[lane];
        const Double4 of_row[3] = {first_of_pairs(b.of_row), second_of_pairs(b.of_row), second_of_pairs(b.of_third)};
        const Double4 of_column[3] = {first_of_pairs(b.of_column), second_of_pairs(b.of_column),
                                      first_of_pairs(b.of_third)};
        const double wx[3] = {sx.w[0][lane], sx.w[1][lane], sx.w[2][lane]};
        const double wy[3] = {sy.w[0][lane], sy.w[1][lane], sy.w[2][lane]};
        Deposit* row = deposits + node[lane];
        double* mass = masses + node[lane];
        Double4 value = b.base;
        for (int j = 0; j < 3; ++j, row += stride, mass += stride, value += b.along_y) {
            const Double4 middle = of_row[j] * value, side = wy[j] * b.along_x;
            for (int i = 0; i < 3; ++i) store(row + i, load(row + i) + (wx[i] * middle + of_column[i] * side));
            store(mass, load(mass) + wy[j] * b.mass);
        }
    }
}

}  // namespace frana
