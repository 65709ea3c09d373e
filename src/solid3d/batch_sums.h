#pragma once
// Sums over the points of a tile, four lanes side by side.
#include "base/simd.h"
#include "base/types.h"

namespace frana {

/// Points of a batch after a step: places [cells], velocities [m/s].
struct BatchPoints {
    Double4 x[3], v[3];
    Double4 mass, volume;      ///< [kg], [m^3]
    Double4 stored, material;  ///< energy of deformation; lost to the law in the step [J]
};

struct BatchSums {
    Double4 mass{}, kinetic{}, speeds{}, volume{}, momentum[3]{}, moment[3]{}, stored{}, material{};
    Double4 max_speed2{}, max_shift{};  ///< per step [m^2/s^2], [cells]

    /// Adds the points in the lanes of `counted`, which came from `from` [cells].
    [[gnu::always_inline]] void add(const BatchPoints& q, const Double4* from, Mask4 counted) {
        const Double4 m = select(counted, q.mass, Double4{});
        const Double4 speed2 = q.v[0] * q.v[0] + q.v[1] * q.v[1] + q.v[2] * q.v[2];
        mass += m;
        kinetic += 0.5 * m * speed2;
        speeds += m * sqrt(speed2);
        volume += select(counted, q.volume, Double4{});
        stored += select(counted, q.stored, Double4{});
        // Of those that leave too. Lanes beyond the last point strain by whatever nodes at random weights move.
        material += select(q.mass > 0.0, q.material, Double4{});
        max_speed2 = max(max_speed2, select(counted, speed2, Double4{}));
        for (int k = 0; k < 3; ++k) {
            momentum[k] += m * q.v[k];
            moment[k] += m * q.x[k];
            max_shift = max(max_shift, select(counted, abs(q.x[k] - from[k]), Double4{}));
        }
    }
    template <class Sums>
    void add_to(Sums& sums) const {
        sums.mass += sum(mass), sums.kinetic += sum(kinetic), sums.speeds += sum(speeds), sums.volume += sum(volume);
        sums.stored += sum(stored), sums.material += sum(material);
        for (int k = 0; k < 3; ++k) sums.momentum[k] += sum(momentum[k]), sums.moment[k] += sum(moment[k]);
        sums.max_speed2 = std::fmax(sums.max_speed2, largest(max_speed2));
        sums.max_shift = std::fmax(sums.max_shift, largest(max_shift));
    }
};

}  // namespace frana
