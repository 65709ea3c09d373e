#pragma once
// The 3D material point method: explicit, quadratic B-splines, TPIC or APIC, against rigid surfaces.
#include <memory>
#include <utility>
#include <vector>

#include "base/clock.h"
#include "base/constants.h"
#include "law/solid/laws.h"
#include "mpm/ledger.h"
#include "mpm/step_clock.h"
#include "observe/frame.h"
#include "solid3d/face_ledger.h"
#include "solid3d/material_points.h"
#include "solid3d/node_block.h"
#include "solid3d/spline.h"
#include "solid3d/surfaces.h"

namespace frana {

/// Material points at the start, equal lengths.
struct SolidSeeds {
    std::vector<Vec3> position;    ///< [m]
    std::vector<Vec3> velocity;    ///< [m/s]
    std::vector<double> mass;      ///< [kg]
    std::vector<double> pressure;  ///< that they start with, the same from all sides [Pa], or empty: none

    void add(const Vec3& x, const Vec3& v, double m, double p = 0.0) {
        position.push_back(x), velocity.push_back(v), mass.push_back(m), pressure.push_back(p);
    }
};

/// Material adjacent to the points that another model carries. It moves on at its velocity.
struct GhostParticles {
    SolidSeeds seeds;
    std::vector<Mat3> gradient;  ///< of the velocity at each, dv_k/dx_l at (k, l) [1/s]
    double time = 0.0;           ///< when it is at its places [s]
    double span = 0.0;           ///< how long it moves from there, forth or back, at most [s]

    bool empty() const { return seeds.mass.empty(); }
};

/// A point that left, as it was then.
struct DepartedPoint {
    double time;      ///< [s]
    Vec3 position;    ///< [m]
    Vec3 velocity;    ///< [m/s]
    Mat3 gradient;    ///< of the velocity, dv_k/dx_l at (k, l) [1/s]
    double mass;      ///< [kg]
    double energy;    ///< kinetic, potential and stored, as it was recorded but for round-off [J]
    double pressure;  ///< [Pa]
};

struct SolidScene {
    GridGeometry3d grid;
    Vec3 gravity{0, 0, -constants::kGravity};  ///< [m/s^2]
    double density = 1000.0;                   ///< without stress [kg/m^3]
    SolidLaw law = solid::Fluid{};
    Affine affine = Affine::tpic;
    /// Points retain their velocities and get the changes of the nodes' ones (affine FLIP). They take a share of 1 -
    /// exp(-dt / blending) from the nodes (PIC), so that damping is by time, not by step.
    bool flip = false;
    double blending = 0.0;          ///< [s]
    double averaging = 0.005;       ///< share of J's mean taken over in a step, of laws that average [1]
    bool split = false;             ///< points that are drawn apart become two (split_points.h)
    double cfl = 0.4;               ///< fraction of a cell that sound and flow may pass in a step [1]
    std::vector<Surface> surfaces;  ///< at most kMostSurfaces
    SolidSeeds points;
};

/// What points were given and lost since the start, or in a step (mpm/ledger.h).
struct SolidLedger {
    double mass_left = 0.0;        ///< gone through the grid's sides [kg]
    double energy_left = 0.0;      ///< kinetic, potential and stored, carried out [J]
    double energy_given = 0.0;     ///< the same at the start and with what was added since [J]
    double friction = 0.0;         ///< lost along surfaces [J]
    double contact_work = 0.0;     ///< by the forces of surfaces and of adjacent material; impacts lose [J]
    double material = 0.0;         ///< lost to the law: yielding, viscosity [J]
    Vec3 momentum_left{0, 0, 0};   ///< carried out [kg m/s]
    Vec3 momentum_given{0, 0, 0};  ///< at the start and with what was added since [kg m/s]
    Vec3 weight_impulse{0, 0, 0};  ///< of gravity [kg m/s]
    Vec3 ghost_impulse{0, 0, 0};   ///< of adjacent material [kg m/s]
};

/// Sums over the points after a step.
struct SolidStatus : Clock, SolidLedger {
    Index points = 0;
    double mass = 0.0;       ///< in the grid [kg]
    Vec3 momentum{0, 0, 0};  ///< [kg m/s]
    Vec3 centre{0, 0, 0};    ///< of mass [m]
    double kinetic = 0.0;    ///< sum of m v^2 / 2 [J]
    double potential = 0.0;  ///< sum of -m gravity . x [J]
    double stored = 0.0;     ///< of deformation, that unloading gives back [J]
    double speeds = 0.0;     ///< sum of m |v| [kg m/s]
    double volume = 0.0;     ///< sum of J V_0 [m^3]
    double max_speed = 0.0;  ///< [m/s]

    /// What the scheme lost since the start: the transfers between points and nodes, finite steps [J].
    double numerical() const {
        return (energy_given - kinetic - potential - stored) - energy_left + contact_work - friction - material;
    }
};

/// Of surfaces on the nodes of a tile in a step [J].
struct SurfaceWork {
    double contact_work = 0.0, friction = 0.0;  ///< given by normal forces; lost to friction
};

/// Sums of the loops over points, tile by tile.
struct SolidSums {
    double mass = 0.0, kinetic = 0.0, speeds = 0.0, volume = 0.0, max_speed2 = 0.0, max_shift = 0.0;
    Vec3 momentum{0, 0, 0}, moment{0, 0, 0};  ///< moment: sum of m x
    double left_mass = 0.0, left_energy = 0.0;
    double stored = 0.0, material = 0.0, contact_work = 0.0, friction = 0.0;  ///< energies, as in the status
    Vec3 left_momentum{0, 0, 0};
    Index left = 0;  ///< points
    Index bad = -1;  ///< a point whose numbers are not finite, or that ran away
};

/// Of a mirror particle from its point along an axis [cells].
constexpr double kFarthestMirror = 9.0;

/// All that the kernels share.
struct SolidBody {
    explicit SolidBody(const SolidScene& scene);
    /// Mass and momentum; then mean J and velocity.
    struct Node {
        double m, x, y, z;
    };
    Grid3d grid;
    MaterialPoints points;
    ActiveTiles active;
    /// Positions of tiles near surfaces: those two, three and four apart, each by one of 64 colours.
    std::array<std::vector<Index>, 192> mirror_colour;
    std::vector<double>
        mirror_reach;  ///< per particle tile: how far to the side its mirror particles may stand [cells]
    std::vector<SurfaceSet> near_points;  ///< per particle tile
    std::vector<SurfaceSet> near_nodes;   ///< per tile of the work list
    std::vector<std::uint8_t> gone;       ///< per point: left the grid in this step

    std::vector<Box3d> boxes;  ///< of the step: nodes that the points of each particle tile touch

    LazyArray<Node> nodes, real;   ///< real: without mirror particles, near surfaces
    LazyArray<Node> mirror_force;  ///< of the step, near barriers: impulse of their mirror particles' stress [kg m/s]
    LazyArray<Node> on_barriers;   ///< of the step, near barriers: of `real`, what stands on one above the ground
    /// Material adjacent to the points, which contributes to the nodes like them. `real` has it too.
    struct Ghosts {
        GhostParticles material;
        std::vector<SurfaceSet> near;  ///< surfaces that may show mirror particles of each of its seeds
        /// Of the step, seeds and mirror particles: a place [cells], mass and momentum [kg, kg m/s], mass times the
        /// velocity's gradient [kg/s]. Also the impulse of the pressure [J s], and the seed's mirror particle where one
        /// is cut (surfaces.h).
        struct Shown {
            Vec3 place;
            double mass;
            Vec3 momentum;
            Mat3 affine, force;
            MirrorParticle mirror;
            bool on_barrier;  ///< a seed that stands on one above the ground
        };
        std::vector<Shown> seeds, mirrors;
        LazyArray<Node> own;                ///< of the points alone, in tiles that it reaches
        std::vector<std::uint8_t> reaches;  ///< of the step, per tile of the work list: 1 where it gives to a node
        std::vector<Vec3> tile_impulse;     ///< of the step, what it gave to the points, per tile of the work list
    };
    /// Of transfers that retain velocities. First m J and the momentum that points brought, without mirror particles.
    /// Then what v_p / flip_share grows by: the new velocity less flip_share times that brought.
    LazyArray<Node> flip_sums;
    double flip_share = 0.0;   ///< of the step: exp(-dt / blending)
    LazyArray<double> mass_j;  ///< sum of w m J, of laws that average
    std::vector<Surface> surfaces;
    std::vector<Vec3> impulse;           ///< of each surface on the material since the start [kg m/s]
    std::vector<Vec3> tile_impulse;      ///< of the step, per tile of the work list and surface
    std::vector<SurfaceWork> tile_work;  ///< of the step, per tile of the work list
    std::vector<Vec3> point_impulse;     ///< the same, per particle tile: of points put back
    SurfaceSet barriers = 0;             ///< which of the surfaces are
    FaceLedger ledger;                   ///< of barriers' faces since the start
    /// Of the step: what barriers gave to the nodes of each tile of the work list. Also to the points of each particle
    /// tile that they put back.
    std::vector<std::vector<FaceImpulse>> node_impulses, point_impulses;
    std::vector<SolidSums> sums;  ///< of the step, per particle tile
    Ghosts ghosts;
    Vec3 gravity;
    double averaging;
    double density;  ///< without stress [kg/m^3]
};

/// The loops of a step, made for one law and transfer.
class Mpm3dKernel {
public:
    virtual ~Mpm3dKernel() = default;
    virtual void clear(SolidBody& body) const = 0;
    virtual void scatter(SolidBody& body, double dt) const = 0;
    virtual void scatter_mirrors(SolidBody& body, double dt) const = 0;
    /// Material adjacent to the points at `time`: before the mirror particles, and after them its own.
    virtual void scatter_ghosts(SolidBody& body, double time, double dt) const = 0;
    virtual void scatter_ghost_mirrors(SolidBody& body) const = 0;
    virtual void move_nodes(SolidBody& body) const = 0;
    virtual void gather(SolidBody& body, double dt) const = 0;
    virtual double sound_speed(double density) const = 0;
    virtual double explicit_viscosity() const = 0;
    virtual int states() const = 0;
    /// J and state of a point at rest under the pressure p, the same from all sides. Also the energy that it then
    /// stores, per volume without stress [J/m^3].
    virtual double press(double p, double& j, double* state) const = 0;
};

std::unique_ptr<Mpm3dKernel> make_mpm3d_kernel(const SolidLaw& law, Affine affine, bool flip);

/// A body of 3D points, and its time loop.
class Mpm3d {
public:
    explicit Mpm3d(const SolidScene& scene);

    /// One step, never past `until` [s]. Throws NumericsError when a number stops being finite.
    void advance(double until);
    double longest_step() const;  ///< of the next one, if nothing shortens it [s]
    /// More material, between two steps. Its points get the next numbers.
    void add(const SolidSeeds& seeds);
    /// Material that points feel from now on as they feel each other. Nodes that it reaches have its mass, motion and
    /// pressure too. It goes on at its velocity whatever the points do; what it gives them is recorded.
    void set_adjacent(GhostParticles material);
    /// A point that left goes on like that, besides.
    void set_adjacent(const DepartedPoint& point);
    /// From now on points that leave are noted, and those that a split makes.
    void note_departed() { notes_ = true; }
    /// A number that a split gave, and that of the point whose half has it.
    struct Birth {
        Index child, parent;
    };
    /// Since the last call.
    std::vector<Birth> take_births() { return std::exchange(births_, {}); }
    /// Those that left since the last call, step by step in the order of the tiles. They are the same for any number of
    /// threads.
    std::vector<DepartedPoint> take_departed() { return std::exchange(departed_, {}); }
    /// Between two steps, all points leave.
    void leave();
    /// Sets the clock of a flow that has not begun to move [s].
    void start_at(double time);
    /// Saves the state between two steps, or restores it with all its bits, in a flow of the same scene.
    void serialize(Archive& archive);
    const SolidStatus& status() const { return status_; }
    const SolidBody& body() const { return body_; }
    std::vector<PhaseTime> timings() const { return timed_.times(); }
    /// timings() tell CPU time too from now on.
    void count_cpu_time() { timed_.count_cpu_time(); }
    /// Memory that grows with the points, sort buffers included [bytes].
    Index particle_bytes() const { return body_.points.bytes() + sorter_.bytes() + allocated(body_.gone); }
    /// Position of a point [m].
    Vec3 position(Index p) const;
    Vec3 velocity(Index p) const { return {body_.points.v[0][p], body_.points.v[1][p], body_.points.v[2][p]}; }
    /// Cauchy stress at a point [Pa].
    Sym3 stress(Index p) const;
    /// Momentum + carried out - given with points - impulses of gravity, surfaces and adjacent material: round-off [kg
    /// m/s]
    Vec3 momentum_residual() const;
    /// Angular momentum about the origin; with apic that of the affine motion too [kg m^2/s].
    Vec3 angular_momentum() const;

private:
    void place(const SolidSeeds& seeds);
    void sort();
    void split();
    void mark_near();
    void list_mirrors(Index n, SurfaceSet near, const Vec3& low, const Vec3& high);
    void mark_visible_mirrors();
    void make_room_for_ghosts();
    void note_near(std::size_t seed);
    void make_room_for_impulses();
    double step_length(double until) const;
    void accumulate();
    void account(const SolidLedger& more);
    void accumulate_barrier_impulses();
    void require_finite(const SolidSums& sums) const;
    DepartedPoint departed(Index p) const;
    Mat3 gradient(Index p) const;

    SolidBody body_;
    std::unique_ptr<Mpm3dKernel> kernel_;
    SolidLaw law_;
    Sorter3d sorter_;
    StepClock timed_;
    SolidStatus status_;
    Ledger<SolidLedger> since_start_;
    double density_, cfl_, sound_speed_, blending_, drift_ = 0.0;
    Index next_id_ = 0;
    std::vector<DepartedPoint> departed_;  ///< when they are noted
    std::vector<Birth> births_;            ///< likewise
    bool notes_ = false;
    bool apic_, splits_;
};

}  // namespace frana
