#pragma once
// Points to nodes and back: `deposit` (mass, momentum, sub-point depth, stress) and `gather` (velocity, gradient,
// positions, domains). The choices (shape, transfer, rheology, paper pressure) become types once, at the start.
#include <memory>
#include <vector>

#include "shallow/flow.h"

namespace frana {

/// Sums over points, made tile by tile in a fixed order.
struct PointSums {
    double mass = 0.0;          ///< [kg]
    double px = 0.0, py = 0.0;  ///< momentum [kg m/s]
    double p_abs = 0.0;         ///< sum of m |v| [kg m/s]
    double max_speed = 0.0;     ///< [m/s]
    double max_signal = 0.0;    ///< largest |v| + sqrt(g h) [m/s]
    double max_shift = 0.0;     ///< largest displacement of the step [cells]
    double max_motion = 0.0;    ///< largest part of v [m/s] or grad v [1/s]; 0: all at rest
    double stress_power = 0.0;  ///< sum of V sigma : eps [W]
    double left_mass = 0.0, left_px = 0.0, left_py = 0.0, left_energy = 0.0;  ///< removed in this step
    double lost_in_holes = 0.0;                                               ///< of left_mass [kg]
    double wall_impulse_x = 0.0, wall_impulse_y = 0.0;  ///< by walls in holes of the terrain [kg m/s]
    Index left_count = 0;
    Index bad = -1;  ///< a point whose state is not finite, or that jumped more than 4 cells

    void add(const PointSums& other);
};

/// Largest 2 mu_eff of the rheology in a step of `velocity_dt` [s] that is stable explicitly [Pa s]: nu =
/// scheme.stress_cap, or 1/4.
///
/// A point of gradient c alone changes its nodes' velocity by A c, A = nu sum (N')^2 / N. A is 4 to 6 nu for quadratic
/// shapes, 3 nu for cubic ones. Affine transfers bring the nodes c too and gather (1 - A) c: stable up to A = 2. Others
/// gather -A c, and are with A = 1. As nodes have at least half their depth's inertia (grid update.cpp), A there is
/// below 4 nu. So it is with linear shapes of any transfer.
double most_viscosity(const Flow& flow, double velocity_dt);

class TransferKernel {
public:
    virtual ~TransferKernel() = default;
    /// Clears the nodes near material and deposits all points. `velocity_dt` is the longest time step the result will
    /// be used for [s]: it caps the explicit stress (scheme.stress_cap).
    virtual PointSums deposit(Flow& flow, double velocity_dt) = 0;
    /// Moves all points by `dt` [s] with the nodes' velocities; points outside are marked in gone().
    virtual PointSums gather(Flow& flow, double dt) = 0;
    /// `gather`, then `deposit` with the points as they are: the same bits in one sweep. Points that left deposit
    /// nothing more. The sums are those of gather, with the deposit's stress power.
    virtual PointSums carry(Flow& flow, double dt, double velocity_dt) = 0;
    /// The points' velocities gathered from the nodes, without moving anything: v and grad v at the points.
    struct Probe {
        std::vector<double> vx, vy, cxx, cxy, cyx, cyy, depth;
    };
    virtual void probe(Flow& flow, Probe& out) = 0;
    /// One byte per point, 1: it left the domain in the last gather. Free for others' use until the next.
    std::vector<std::uint8_t>& gone() { return gone_; }
    const std::vector<std::uint8_t>& gone() const { return gone_; }

protected:
    PointSums carry_apart(Flow& flow, double dt, double velocity_dt) {
        PointSums sums = gather(flow, dt);
        if (sums.bad < 0) sums.stress_power = deposit(flow, velocity_dt).stress_power;
        return sums;
    }

    std::vector<std::uint8_t> gone_;
    /// Room for sums per tile of the domain, which outlive steps in which the tile sleeps.
    void make_room(const Flow& flow) {
        if (gathered_) return;
        gathered_ = LazyArray<PointSums>(flow.grid.tiles());
        deposited_ = LazyArray<PointSums>(flow.grid.tiles());
    }
    LazyArray<PointSums> gathered_, deposited_;
};

/// The kernel for the scene's choices: a vectorised one for the default scheme, otherwise the plain one.
std::unique_ptr<TransferKernel> make_transfer(const Scene& scene);
/// Any choices, one point at a time: the reference of the vectorised kernel.
std::unique_ptr<TransferKernel> make_plain_transfer(const Scene& scene);
/// Quadratic shapes and TPIC, four points at a time; nullptr for other schemes.
std::unique_ptr<TransferKernel> make_packed_transfer(const Scene& scene);

PointSums total(const ActiveTiles& active, const LazyArray<PointSums>& parts);

/// Sums of the nodes' deposits before folding, to be held against PointSums (partition of unity).
PointSums node_sums(Flow& flow);

/// Closes the domain at walls by adding to each node what its mirror particles would bring; nothing at open sides.
void fold_walls(Flow& flow);

/// Copies motion to the ghosts of walls, mirrored.
void mirror_motion(Flow& flow);

}  // namespace frana
