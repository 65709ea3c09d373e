#pragma once
// The material points of structured solids: particles of one solid each, one array per quantity, sorted by
// tile.
#include <array>

#include "mpm/point_set.h"

namespace frana {

/// Arrays of particles on the plane. Positions are in cells from node (0, 0); all else is SI.
struct StructuredArrays {
    Array x, y;                ///< position [cells]
    Array vx, vy;              ///< velocity [m/s]
    Array cxx, cxy, cyx, cyy;  ///< velocity gradient, c_kl = dv_k / dx_l [1/s]
    Array mass;                ///< [kg]
    Array volume;              ///< of grains, confined and released water [m^3]
    Array depth;               ///< of the particle by itself, by the area that it was deformed to [m]
    Array xx, yy, zz, xy;      ///< stress of the solid, tension positive [Pa]
    Array damage;              ///< 0 intact, 1 fragmented
    Array strain;              ///< sum of |strain| so far [1]
    Array cohesion;            ///< undamaged [Pa]
    Array normal_gravity;      ///< gravity across the ground where it stands [m/s^2]
    Array layer;               ///< depth of all that lies at the nodes around [m]
    Array solids;              ///< volume of grains, constant [m^3]
    Array confined;            ///< volume of water in what is whole of the structure [m^3]
    Array released;            ///< what the last step set free and the next gives to the nodes [m^3]
    Array r1x, r1y, r2x, r2y;  ///< edges of the domain, which go with it once there are grains [cells]

    /// Point p loses half of all that is counted and not shared.
    void halve(Index p) {
        for (Array* array : {&mass, &volume, &solids, &confined, &released}) (*array)[p] *= 0.5;
    }

    template <class Self, class Visit>
    static void visit_arrays(Self& s, Visit&& visit) {
        for (auto* array : {&s.x,
                            &s.y,
                            &s.vx,
                            &s.vy,
                            &s.cxx,
                            &s.cxy,
                            &s.cyx,
                            &s.cyy,
                            &s.mass,
                            &s.volume,
                            &s.depth,
                            &s.xx,
                            &s.yy,
                            &s.zz,
                            &s.xy,
                            &s.damage,
                            &s.strain,
                            &s.cohesion,
                            &s.normal_gravity,
                            &s.layer,
                            &s.solids,
                            &s.confined,
                            &s.released,
                            &s.r1x,
                            &s.r1y,
                            &s.r2x,
                            &s.r2y})
            visit(*array);
    }
};

using StructuredPoints = PointSet<StructuredArrays>;

}  // namespace frana
