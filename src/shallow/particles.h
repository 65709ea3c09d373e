#pragma once
// The material points of the depth-averaged model: one array per quantity, sorted by tile.
#include <array>
#include <type_traits>
#include <vector>

#include "base/staggered.h"
#include "mpm/domain.h"
#include "mpm/point_order.h"
#include "mpm/point_set.h"
#include "mpm/tile_grid.h"

namespace frana {

/// What a point carries from node to node, in double or single precision.
template <class Real>
struct Carried {
    ArrayOf<Real> vx, vy;              ///< velocity [m/s], half a step behind the position
    ArrayOf<Real> cxx, cxy, cyx, cyy;  ///< velocity gradient, c_kl = dv_k / dx_l [1/s]
    ArrayOf<Real> r1x, r1y, r2x, r2y;  ///< edges of the point's domain [cells]
    ArrayOf<Real> depth;               ///< sampled from the nodes (paper preset: carried) [m]

    template <class Self, class Visit>
    static void visit_arrays(Self& s, Visit&& visit) {
        for (auto* array : {&s.vx, &s.vy, &s.cxx, &s.cxy, &s.cyx, &s.cyy, &s.r1x, &s.r1y, &s.r2x, &s.r2y, &s.depth})
            visit(*array);
    }
};

/// Arrays of particles, each a column of material. Positions and domain edges are in cells (from node (0, 0)); all else
/// is SI. Positions and masses are always in double precision: a step moves a point by little, and mass is exact.
struct ParticleArrays : Carried<double> {
    Array x, y;             ///< position [cells]
    Array mass;             ///< [kg]
    Carried<float> narrow;  ///< with scheme.precision = "float" instead of the base's arrays, which are empty then
    bool single = false;    ///< what points carry is in `narrow`

    template <class Real>
    Carried<Real>& carried() {
        if constexpr (std::is_same_v<Real, float>)
            return narrow;
        else
            return *this;
    }
    template <class Real>
    const Carried<Real>& carried() const {
        if constexpr (std::is_same_v<Real, float>)
            return narrow;
        else
            return *this;
    }
    /// Calls work(Real{}), Real being what points carry: a choice made once for a loop over points.
    template <class Work>
    auto with_real(Work&& work) const {
        return single ? work(float{}) : work(double{});
    }
    /// Point p loses half of all that is counted and not shared.
    void halve(Index p) { mass[p] *= 0.5; }

    template <class Self, class Visit>
    static void visit_arrays(Self& s, Visit&& visit) {
        visit(s.x), visit(s.y), visit(s.mass);
        if (s.single)
            Carried<float>::visit_arrays(s.narrow, visit);
        else
            Carried<double>::visit_arrays(s, visit);
    }
};

using Particles = PointSet<ParticleArrays>;

/// A particle that left at an exit where that is noted, as it was when it left.
struct Departed {
    std::int64_t id;
    double x, y;                     ///< position [cells]
    double vx, vy;                   ///< [m/s]
    double depth;                    ///< [m]
    double mass;                     ///< [kg]
    double energy;                   ///< kinetic and potential, as it was recorded [J]
    std::array<double, 4> gradient;  ///< of the velocity: cxx, cyx, cxy, cyy [1/s]
    Edges edges;                     ///< of its domain [cells]
};

/// Sorts particles by tile; points marked in `gone` are dropped. Needs no memory once warmed up.
class TileSorter {
public:
    /// Sorts `particles` and rebuilds `active`. Same bits for any number of threads.
    /// `gone` (one byte per particle, may be empty) marks particles to drop.
    void sort(Particles& particles, const TileGrid& grid, const std::vector<std::uint8_t>& gone, ActiveTiles& active) {
        plan(particles, grid, gone, active);
        carry_out(particles);
    }
    /// The same in two, so that points can be dropped between: `active` and order() first, then the particles.
    void plan(const Particles& particles, const TileGrid& grid, const std::vector<std::uint8_t>& gone,
              ActiveTiles& active);
    void carry_out(Particles& particles);
    /// Of a plan: the point that will lie at each place.
    const std::vector<std::int32_t>& order() const { return order_.order(); }
    /// Leaves points marked in `gone` out of a plan.
    void leave_out(const std::vector<std::uint8_t>& gone, ActiveTiles& active) { order_.leave_out(gone, active); }
    /// Drops the points marked in `gone`; the order and tiles of the others stay.
    void drop(Particles& particles, const std::vector<std::uint8_t>& gone, ActiveTiles& active);
    /// Makes `active` whole from its tiles and their ranges.
    void list_tiles(const TileGrid& grid, ActiveTiles& active);
    /// Memory that grows with the points [bytes].
    Index bytes() const { return order_.bytes(); }

private:
    void wake(Index count, ActiveTiles& active);
    static void list_runs(Index width, ActiveTiles& active);

    PointOrder order_;
};

}  // namespace frana
