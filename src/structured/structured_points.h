#pragma once
// The material points of structured solids: columns of one solid each, one array per quantity, sorted by
// tile.
#include <array>

#include "mpm/point_order.h"

namespace frana {

/// Columns on the plane. Positions are in cells from node (0, 0); all else is SI.
struct StructuredPoints {
    Column x, y;                   ///< position [cells]
    Column vx, vy;                 ///< velocity [m/s]
    Column cxx, cxy, cyx, cyy;     ///< velocity gradient, c_kl = dv_k / dx_l [1/s]
    Column mass;                   ///< [kg]
    Column volume;                 ///< of grains, confined and released water [m^3]
    Column depth;                  ///< of the column by itself, by the area that it was deformed to [m]
    Column xx, yy, zz, xy;         ///< stress of the solid, tension positive [Pa]
    Column damage;                 ///< 0 whole, 1 grains
    Column strain;                 ///< sum of |strain| so far [1]
    Column cohesion;               ///< undamaged [Pa]
    Column pull;                   ///< gravity across the ground where it stands [m/s^2]
    Column layer;                  ///< depth of all that lies at the nodes around [m]
    Column solids;                 ///< volume of grains, constant [m^3]
    Column confined;               ///< volume of water in what is whole of the structure [m^3]
    Column released;               ///< what the last step set free and the next gives to the nodes [m^3]
    Column r1x, r1y, r2x, r2y;     ///< edges of the domain, which go with it once there are grains [cells]
    std::vector<std::int64_t> id;  ///< constant through sorting

    Index count() const { return static_cast<Index>(x.size()); }

    /// The one list of floating-point columns: sorting and growing walk it.
    template <class Visit>
    void each(Visit&& visit) {
        each_of(*this, visit);
    }
    template <class Visit>
    void each(Visit&& visit) const {
        each_of(*this, visit);
    }
    /// Point p loses half of all that is counted and not shared.
    void halve(Index p) {
        for (Column* column : {&mass, &volume, &solids, &confined, &released}) (*column)[p] *= 0.5;
    }
    void resize(Index count) {
        each([&](Column& column) { resize_sparingly(column, static_cast<std::size_t>(count)); });
        resize_sparingly(id, static_cast<std::size_t>(count));
    }

private:
    template <class Self, class Visit>
    static void each_of(Self& s, Visit& visit) {
        for (auto* column : {&s.x,      &s.y,        &s.vx,       &s.vy,   &s.cxx,    &s.cxy,      &s.cyx,
                             &s.cyy,    &s.mass,     &s.volume,   &s.depth, &s.xx,    &s.yy,       &s.zz,
                             &s.xy,     &s.damage,   &s.strain,   &s.cohesion, &s.pull, &s.layer,  &s.solids,
                             &s.confined, &s.released, &s.r1x,    &s.r1y,  &s.r2x,    &s.r2y})
            visit(*column);
    }
};

}  // namespace frana
