#pragma once
// Node arrays of the depth-averaged step, on the storage of a TileGrid.
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "mpm/tile_grid.h"

namespace frana {

/// What points deposit on a node; four numbers side by side, so that one vector add serves a node.
struct alignas(32) Deposit {
    double px, py;  ///< momentum, sum of m_p N_i (v_p + C_p d) [kg m/s]
    double fx, fy;  ///< stress (and paper pressure) force [N]; zero without rheology
};

/// What points gather from a node.
struct alignas(32) Motion {
    double vx, vy;  ///< velocity after the grid update [m/s]
    double depth;   ///< [m]
    double wave;    ///< two-cell wave of depth and surface, over the depth [1]
};

enum NodeFlag : std::uint8_t {
    kWet = 1,      ///< depth above round-off
    kMargin = 2,   ///< wet with a dry node within two layers
    kWideX = 4,    ///< this node and two neighbours each way in x are wet
    kWideY = 8,    ///< the same in y
    kMoving = 32,  ///< has momentum of its own: more than round-off of mass, not only sub-points
    kSweep = 64,   ///< a margin node's two bits from here on: the sweep that found its surface, 0 as long as none did
};

/// Whether each of `Word`'s flags from f on has all bits of `set` and none of `unset`.
template <class Word>
inline bool all_have(const std::uint8_t* f, std::uint8_t set, std::uint8_t unset) {
    constexpr Word kEach = static_cast<Word>(0x0101010101010101u);
    Word word;
    std::memcpy(&word, f, sizeof word);
    return (word & (kEach * static_cast<Word>(set | unset))) == kEach * set;
}
inline bool four_have(const std::uint8_t* f, std::uint8_t set, std::uint8_t unset) {
    return all_have<std::uint32_t>(f, set, unset);
}
inline bool eight_have(const std::uint8_t* f, std::uint8_t set, std::uint8_t unset) {
    return all_have<std::uint64_t>(f, set, unset);
}

struct Nodes {
    explicit Nodes(const TileGrid& grid, bool with_force)
        : deposit(grid.size()),
          mass(grid.size()),
          column_mass(grid.size()),
          forced(with_force),
          depth(grid.size()),
          law_depth(grid.size()),
          level(grid.size()),
          surface(grid.size()),
          wave_x(grid.size()),
          row_known(grid.size(), around(grid)),
          before(grid.size()),
          motion(grid.size()),
          velocity_share(grid.size()),
          viscous_flux(grid.size()),
          lateral(grid.size()),
          shock(grid.size()),
          sensed(grid.size(), around(grid)),
          flags(grid.size(), around(grid)) {}

    Deposit* deposits() { return deposit.data(); }
    const Deposit* deposits() const { return deposit.data(); }
    Motion* motions() { return motion.data(); }
    const Motion* motions() const { return motion.data(); }

    LazyArray<Deposit> deposit;
    LazyArray<double> mass;  ///< sum of m_p N_i; apart, since it goes row by row [kg]
    /// Mass deposited from the points' sub-points: what the depth is made of [kg]. Apart from Deposit, since a vector
    /// read of a node waits for a narrower write to it.
    LazyArray<double> column_mass;
    bool forced;                        ///< points deposit forces
    LazyArray<double> depth;            ///< column_mass / (rho A) [m]
    LazyArray<double> law_depth;        ///< that the bed law is given: the depth without its 2-cell wave [m]
    LazyArray<double> level;            ///< bed + depth [m]
    LazyArray<double> surface;          ///< free surface: the level, filtered and mended at margins; bed where dry [m]
    LazyArray<double> wave_x;           ///< part of the 2-cell wave in x, scratch of the filter [m]
    LazyArray<std::uint8_t> row_known;  ///< 1: the wave in x is known there
    LazyArray<Pair> before;             ///< momentum / mass, before the grid update [m/s]
    LazyArray<Motion> motion;
    LazyArray<double> velocity_share;  ///< share of the velocity that friction left; only where points retain some [1]
    LazyArray<Pair> viscous_flux;      ///< artificial viscosity through the faces towards +x and +y [m^3/s^2]
    LazyArray<Pair> lateral;           ///< acceleration by the lateral drag; used only when the scheme has one [m/s^2]
    LazyArray<Pair> shock;             ///< sensor of those two faces, 0 (smooth) to 1 (bore) [1]
    LazyArray<std::uint8_t> sensed;    ///< 1 where either of `shock` is above zero
    LazyArray<std::uint8_t> flags;     ///< NodeFlag bits

private:
    /// Stencils of the outermost spare nodes read so far beyond the array: two rows and a few.
    static Index around(const TileGrid& grid) { return 2 * grid.stride() + 8; }
};

}  // namespace frana
