#pragma once
// What no scene may break, checked after each step.
#include <map>
#include <optional>
#include <string>

#include "checks/fuzz/facts.h"
#include "checks/fuzz/snapshot.h"

namespace frana::stress {

/// A broken invariant.
struct Violation {
    std::string invariant;  ///< one of invariant_names()
    double value = 0.0;     ///< what was found, in units of what is allowed; infinite when no number tells
    Index step = 0;
    double time = 0.0;  ///< [s]
    std::string text;   ///< what was found
};

const std::vector<std::string>& invariant_names();

/// What differences between mirrored nodes are measured by.
struct Scale {
    double depth = 0.0, speed = 0.0;
};  ///< [m], [m/s]
/// Largest difference of mirrored nodes, of depth over the scale's, of momentum over the product of both [1].
double asymmetry(const Facts& facts, const std::vector<NodeState>& nodes, const Scale& scale);

/// Watches one run, of any model. Bounds (all from the start of the run):
/// finite: every number of a frame, of points and nodes that have ground, and of the status.
/// mass: sum of points and what left is the start's, to eps (points + steps) / 2, each sum and merger rounding once.
/// Where
///   there is water as well, or two models pass material on, it is the status' sum, to `kMassShare` at least: each cell
///   of water rounds once a step. Rain and infiltration count as what came and left.
/// positive: depth > 0 on wet nodes and >= 0 on all, mass > 0 of each point.
/// momentum: points' momentum changes by the impulse recorded, to round-off of mass times the largest speed so far a
///   step, and of the two sums over points, each of which rounds once a point. Between walls it holds by definition
///   for the depth-averaged flow (Status::impulse). Other models book weight and pressure each; where material rests
///   they cancel, so that what rounds is mass times g t and the speed of waves, and once a node besides.
/// energy: K + E_p + E_stored + E_left <= start + `kEnergyShare` of the energy at hand (start's kinetic, that of its
/// depth) and
///   turned over, where the model has an energy law. Truncation errs by a share of what is there, most at steps of the
///   depth that no grid resolves; what is unstable grows by a factor a step and passes any share. The start is that of
///   the release: a column of one pixel has on nodes, which average its depth, a fraction of its energy, and the nodes
///   see more or less of it as its points move and split. Not for linear shapes, but in scenes claimed to be resolved:
///   their gradients jump at nodes, so that work and potential differ by a share that no time step mends (seed 77003,
///   scene 1805: 1.04, 1.02 and 1.03e6 J gained at a scheme.cfl of 0.28, 0.1 and 0.03, a fifth of that with quadratic
///   and cubic ones). Nor where the bed turns velocities by so much across a cell that the square of it, which a scheme
///   of second order errs by, is more than `kEnergyShare` (seed 161803, scenes 3519 and 8685 turn by 0.47 and 0.40,
///   with a curvature that is not smoothed: 1.42e6 and 778 J gained, 1.29e6 and 612 J with steps six and nine times
///   shorter; no more than is allowed with the default smoothing). Over a bed bent
///   within a cell a point's potential (of the nodes around it) and its slope (which reaches a node further) differ by
///   second differences of the bed. Beside open sides sub-points are held inside by up to 3/4 of a cell, and a point's
///   potential with them (seed 577215, scene 8982: a point on a plane of 35 degrees that slides up to the side). Where
///   the surface slopes against the bed (the flank of a heap that runs uphill) the drive is the plain gradient
///   (grid_update_bed.h), and keeps the energy of the horizontal velocity: what the vertical one adds, B^2 / (1 + B^2)
///   of K, is the model's own, of what is there and of what left with it. That takes a depth that changes by more than
///   the bed, so B there is at most the largest depth over a cell. Not for the paper preset, whose explicit forces act
///   on nodes of vanishing mass. Structured columns and water bend with no Hessian: their energy is looked at on ground
///   that does not bend. Columns that go under a lake lift the water over them; a shore within a cell, and cells of
///   water that reach half a cell behind a wall, do not take that back by up to the displaced weight over the drop of a
///   cell, nor, where only a share of the pores' pressure bears columns (water.pore_pressure), the rest of it over the
///   whole fall. 3D points have an energy law anywhere, and none of the excuses above; a run with columns as well has
///   those of columns.
/// speed (columns and water): V^2 <= (1 + kConvergence)^2 stretch^4 ((v0 + 2 s sqrt(g h))^2 + 2 g drop) with v0 and
/// highest surface of the
///   start, h the largest depth (which pushes: of nodes, or what points carry) and drop to the lowest bed so far.
///   stretch is 1 where the model has an energy law; elsewhere a bend may turn a speed along the map into `stretch`
///   times that along the bed, which carries it up by stretch^2 of the height, to fall again. The energy line's v0^2 +
///   2 g drop alone is no bound of a fluid: the tip of a dam break runs at 2 sqrt(g h) (Ritter 1892), driven by what
///   stays behind. One that runs uphill is driven by the plain gradient, so it is the horizontal velocity that has this
///   bound, and s = sqrt(1 + B^2) with the B of `energy` (1 where stretch has it). kConvergence: that in turn is a
///   bound along one direction; streams that converge from two may pass it a little (1 % has been seen), while what is
///   unstable passes it by factors. Nor does it bind the affine transfers where velocity changes from cell to cell: no
///   linear transfer of second order keeps extremes (Godunov 1959), and these bring nodes a cell away from a point its
///   velocity and the change across a cell besides. Where the largest such change so far is more than kConvergence of
///   the bound it takes its place, up to the bound itself; so it does in the paper preset, which no energy line binds
///   (see `energy`; seed 888, scene 8148: a column of 138 m whose outer points run 1.48 times as fast as the bound in
///   four steps). Neither energy nor speed is looked at with water's virtual mass, which a step takes from an estimate
///   of what drives the water, so that columns part from it by what that gets wrong (speeds of up to three times the
///   bound have been seen). The energy of the virtual mass, half of it times the slip's square, would not close the
///   book: that estimate does work on the slip which no term takes back, and the mass changes with the mixture where
///   neither phase is pushed.
/// head (3D points): z + V^2 / 2g of each point is no higher than the highest surface of the start, and above it the
///   head of a front, (1 + kConvergence)^2 (v0 + 2 sqrt(g h))^2 / 2g with v0 and h of `speed`, `kEnergyShare` of what
///   the point has fallen, and a cell of the 3D grid, within which the ground's height is not told apart. Or, where
///   that is more, (kBlow v0 + 2 sqrt(g h))^2 / 2g: what is squeezed between heavy material that comes from opposite
///   sides leaves at up to three times its speed, by the law of elastic blows, and material that strikes ground or
///   itself spouts. Seed 2's scene 992 and seed 25112's 149, 370 and 667 do: points leave at 1.6 to 2.4 v0, in one of
///   them at 3.1 v0 in shorter steps, while all of it loses energy. In runs that have columns as well, points begin up
///   to a cell of the terrain up a slope from their column, and with the speed that its path gave it: the drop of a
///   cell, and the `stretch` of `speed`, come on top.
/// rest (claimed scenes): a pile's positions and velocities are those of the start, bit for bit. A lake is level as far
///   as points at these places can make it so (MassFit::level_error); it moves no faster than the front of a dam break
///   as high as round-off, 2 sqrt(g e) (Ritter 1892), where the fit met the level; otherwise than one as high as its
///   surface is off the level, on that bed: with the factors (1 + kConvergence) stretch^2 of `speed`.
/// symmetry: depth and momentum of mirrored nodes agree within `kMirrorError` of the largest (claimed scenes). Momentum
///   besides to the round-off of what cancels: a step's pressure pulls each way by up to sqrt(g h), which rounds some
///   sixteen times; where nothing else moves, all that moves is that. Round-off that the flow makes grow is no defect
///   of the images: see has_grown() in trial.h, and part().
/// threads, resume (claimed scenes; trial.cpp): all that a simulation keeps, but for its clock, has the same bits after
/// one
///   thread and two, and after a run that was kept half way and taken up again.
class Watch {
public:
    static constexpr double kEnergyShare = 0.1;
    static constexpr double kConvergence = 0.25;
    static constexpr double kMirrorError = 1e-8;
    static constexpr double kMassShare = 1e-13;

    Watch(const Facts& facts, const Snapshot& start);
    /// The first invariant that the state breaks.
    std::optional<Violation> observe(const Snapshot& state);
    /// Largest depth and speed so far, the latter with the round-off of what cancels.
    Scale scale(Index step) const;
    /// Mirror images have parted for a good reason: symmetry is not looked at any more.
    void part();
    /// Largest value so far of each invariant that has a number, in units of what is allowed.
    const std::map<std::string, double>& worst() const { return worst_; }

private:
    std::optional<Violation> finite(const Snapshot& state);
    std::optional<Violation> positive(const Snapshot& state);
    std::optional<Violation> mass(const Snapshot& state);
    std::optional<Violation> momentum(const Snapshot& state);
    std::optional<Violation> energy(const Snapshot& state);
    std::optional<Violation> speed(const Snapshot& state);
    std::optional<Violation> head(const Snapshot& state);
    std::optional<Violation> rest(const Snapshot& state);
    std::optional<Violation> symmetry(const Snapshot& state);
    void note_extremes(const Snapshot& state);
    /// Largest slope of the bed that a surface may climb [1]; see `energy`.
    double slope_uphill() const;
    /// By what share of itself the bound on speed may be passed [1].
    double beyond(double bound) const;
    std::optional<Violation> judged(const char* invariant, double value, double allowed, const Snapshot& state,
                                    const std::string& what);

    Facts facts_;
    Snapshot start_;
    double mass_ = 0.0;                    ///< of the start, compensated [kg]
    double most_mass_ = 0.0;               ///< at a time so far; rain adds to it [kg]
    double highest_ = 0.0, lowest_ = 0.0;  ///< surface of the start, bed so far [m]
    double deepest_ = 0.0;                 ///< so far [m]
    double fastest_ = 0.0;                 ///< point or node so far [m/s]
    double change_ = 0.0;   ///< of the velocity across a cell at a point, largest so far, with affine transfers [m/s]
    double at_hand_ = 0.0;  ///< kinetic energy of the start, and what its depth alone could set free [J]
    double turned_over_ = 0.0;  ///< largest kinetic and dissipated energy and change of potential so far [J]
    Index points_ = 0;          ///< most so far
    Index most_nodes_ = 0;      ///< with material, where it is not all in points
    std::map<std::string, double> worst_;
};

}  // namespace frana::stress
