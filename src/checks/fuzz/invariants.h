#pragma once
// What no scene may break, checked after each step.
#include <map>
#include <optional>
#include <string>

#include "checks/fuzz/facts.h"
#include "checks/fuzz/snapshot.h"

namespace frana::fuzz {

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
/// - finite: every number of a frame, of points and nodes that have ground, and of the status.
/// - mass: the sum of points and what left is the start's, to eps (points + steps) / 2. Each sum and merger rounds
///   once.
///   Where there is water as well, or two models exchange material, it is the status' sum, to `kMassShare` at least.
///   Each cell of water rounds once a step. Rain and infiltration count as what came and left.
/// - positive: depth > 0 on wet nodes and >= 0 on all, mass > 0 of each point.
/// - momentum: points' momentum changes by the impulse recorded, to round-off. That is of mass times the largest speed
///   so far a step, and of the two sums over points. Each of these rounds once a point.
///   Between walls it holds by definition for the depth-averaged flow (Status::impulse). Other models accumulate
///   weight and pressure separately. Where material rests these cancel. So what rounds is mass times g t and the
///   speed of waves, and once a node besides.
/// - energy: K + E_p + E_stored + E_left <= start + `kEnergyShare` of the energy at hand and turned over, where the
///   model has an energy law. At hand are the start's kinetic energy and that of its depth.
///   Truncation errs by a share of what is there, most at steps of the depth that no grid resolves. What is unstable
///   grows by a factor a step and passes any share.
///   The start is that of the release. On nodes, which average its depth, a column of one pixel has a fraction of its
///   energy. The nodes have more or less of it as its points move and split.
///   Linear shapes have this bound only in scenes claimed to be resolved. Their gradients jump at nodes, so work and
///   potential differ by a share that no time step mends. (Seed 77003, scene 1805: 1.04, 1.02 and 1.03e6 J gained at
///   a scheme.cfl of 0.28, 0.1 and 0.03. With quadratic and cubic shapes a fifth of that.)
///   Nor does it hold where the bed turns velocities too much across a cell. The square of that turn, by which a scheme
///   of second order errs, is then more than `kEnergyShare`. (Seed 161803, scenes 3519 and 8685 turn by 0.47
///   and 0.40, with a curvature that is not smoothed. They gain 1.42e6 and 778 J, and 1.29e6 and 612 J with steps six
///   and nine times shorter. With the default smoothing they gain no more than is allowed.)
///   Over a bed bent within a cell a point's potential and its slope differ by second differences of the bed. The
///   potential is of the nodes around it, and the slope reaches a node further.
///   At open sides sub-points are held inside by up to 3/4 of a cell, and a point's potential with them. (Seed
///   577215, scene 8982: a point on a plane of 35 degrees that slides up to the side.)
///   Where the surface slopes against the bed the drive is the plain gradient (grid_update_bed.h). An example is the
///   flank of a heap that runs uphill. It conserves the energy of the horizontal velocity. What the vertical one adds,
///   B^2 / (1 + B^2) of K, is the model's own. That is so for what is there and for what left with it. That takes a
///   depth that changes by more than the bed. So B there is at most the largest depth over a cell.
///   It does not hold for the paper preset, whose explicit forces act on nodes of vanishing mass. Structured particles
///   and water bend with no Hessian: their energy is checked on ground that does not bend.
///   Particles that go under a lake lift the water over them. A shore within a cell, or cells of water that reach half
///   a cell behind a wall, do not take that back. They miss up to the displaced weight over the drop of a cell. Where
///   only a share of the pores' pressure bears particles (water.pore_pressure), they miss its rest over the whole fall.
///   What comes from the bed or becomes bed has the energy recorded for it. A point takes it from nodes around itself:
///   up to the drop of a cell, and the depth, of that mass is allowed. Where later releases are cut out it is not checked.
///   3D points have an energy law anywhere, and none of the exceptions above. A run with particles as well has those of
///   particles.
///   Structured particles yield under the weight of the depth that they carry. So what nodes do not have of that depth's
///   energy at the start may come out. (Seed 20261302, scene 3245: blocks of a pixel and 3.4 m, which nodes have as 0.8
///   m.) With grains their velocities are half a step behind, at frames too. What climbs has not lost that half step's
///   work. (Seed 20261201, scene 2504: 2.3 m/s up 63 degrees.)
/// - speed (particles and water): V^2 <= (1 + kConvergence)^2 stretch^4 ((v0 + 2 s sqrt(g h))^2 + 2 g drop). v0 and the
///   highest surface are those of the start. h is the largest depth that exerts pressure: of nodes, or what points
///   carry. drop goes to the lowest bed so far, and of particles to that of the nodes beside it: it drives the material
///   before a point gets there (surface_gradient.h). (Seed 20261130, scene 5559: pits of 3500 m a cell beyond a film.)
///   stretch is 1 where the model has an energy law. Elsewhere a bend may turn a speed along the map into `stretch`
///   times that along the bed. That carries it up by stretch^2 of the height, to fall again.
///   The energy line's v0^2 + 2 g drop alone is no bound of a fluid. The tip of a dam break runs at 2 sqrt(g h)
///   (Ritter 1892), driven by what stays behind. A tip that runs uphill is driven by the plain gradient. So it is the
///   horizontal velocity that has this bound. s = sqrt(1 + B^2) with the B of `energy` (1 where stretch has it).
///   kConvergence: that in turn is a bound along one direction. Streams that converge from two may pass it a little (1
///   % has been seen). What is unstable passes it by factors.
///   Nor does it bind the affine transfers where velocity changes from cell to cell. No linear transfer of second
///   order preserves extremes (Godunov 1959). These bring nodes a cell away from a point its velocity, and the change
///   across a cell besides. If the largest such change so far is more than kConvergence of the bound, it takes its
///   place. It does so up to the bound itself. So it does in the paper preset, which no energy line binds (see
///   `energy`). (Seed 888, scene 8148: a column of 138 m. Its outer points run 1.48 times as fast as the bound in four
///   steps.)
///   Points of flip carry the nodes' velocity and what they had beyond it, by (51) of src/shallow/THEORY.md. They move with
///   the nodes' alone. Where streams meet they keep their own, and take each push that the nodes get. The largest such
///   part so far stands for that change. (Seed 20261140, scene 334: streams of 3.9 m/s that cross where the nodes have
///   0.3 m/s.)
///   Neither energy nor speed is checked with water's virtual mass. A step takes that from an estimate of what drives
///   the water. Particles part from it by what the estimate gets wrong. (Speeds of up to three times the bound have
///   been seen.) The energy of the virtual mass, half of it times the slip's square, would not close the budget. That
///   estimate does work on the slip which no term takes back. And the mass changes with the mixture where no force
///   acts on either phase.
/// - head (3D points): z + V^2 / 2g of each point is no higher than the highest surface of the start and what follows.
///   First comes the head of a front, (1 + kConvergence)^2 (v0 + 2 sqrt(g h))^2 / 2g with v0 and h of `speed`. Then
///   comes `kEnergyShare` of what the point has fallen. A cell of the 3D grid is added, within which the ground's
///   height is not told apart.
///   Where it is more, the front's head is (kBlow v0 + 2 sqrt(g h))^2 / 2g. Heavy material may come from opposite
///   sides. What is squeezed between leaves at up to three times its speed, by the law of elastic blows. Material that
///   strikes ground or itself spouts. Seed 2's scene 992 and seed 25112's 149, 370 and 667 do. Points leave at 1.6 to
///   2.4 v0, in one of them at 3.1 v0 in shorter steps. All of it loses energy meanwhile.
///   In runs that have particles as well, points may begin up a slope from their particle, by a terrain cell. They
///   have the speed that its path gave it. So the drop of a cell, and the `stretch` of `speed`, come on top.
/// - rest (claimed scenes): a pile's positions and velocities are those of the start, bit for bit. A lake is level as
///   far as points at these places can make it so (MassFit::level_error). Where the fit met the level, it moves no
///   faster than a dam break's front, 2 sqrt(g e) (Ritter 1892). The dam break is as high as round-off. Otherwise it is
///   as high as the lake's surface is off the level, on that bed. It then has the factors (1 + kConvergence) stretch^2
///   of `speed`.
/// - symmetry: depth and momentum of mirrored nodes agree within `kMirrorError` of the largest (claimed scenes).
///   Momentum agrees besides to the round-off of what cancels. A step's pressure changes it each way by up to sqrt(g
///   h), which rounds some sixteen times. Where nothing else moves, all that moves is that. Round-off that the flow
///   makes grow is no defect of the mirror images: see has_grown() in trial.h, and part().
/// - threads, resume (claimed scenes; trial.cpp): all that a simulation serializes has the same bits after one thread
///   and two, but for its clock. So it has after a run that was saved half way and resumed.
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
    /// Mirror images have parted for a good reason: symmetry is not checked any more.
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
    double foot_ = 0.0;                    ///< lowest bed so far that drives material [m]
    double deepest_ = 0.0;                 ///< so far [m]
    double fastest_ = 0.0;                 ///< point or node so far [m/s]
    /// Of the velocity across a cell at a point, largest so far, with affine transfers. With flip, of what a point has
    /// beyond its nodes [m/s].
    double change_ = 0.0;
    double at_hand_ = 0.0;      ///< kinetic energy of the start, and what its depth alone could set free [J]
    double turned_over_ = 0.0;  ///< largest kinetic and dissipated energy and change of potential so far [J]
    Index points_ = 0;          ///< most so far
    Index most_nodes_ = 0;      ///< with material, where it is not all in points
    std::map<std::string, double> worst_;
};

}  // namespace frana::fuzz
