#pragma once
// Structured solids on the ground: depth-averaged particles that are elastic, yield and break into grains. The material
// point method is explicit, with quadratic B-splines (TPIC). One material, dry or with free water.
#include <memory>
#include <optional>
#include <vector>

#include "base/clock.h"
#include "base/constants.h"
#include "law/bed/law_map.h"
#include "law/free_water.h"
#include "law/structured_law.h"
#include "mpm/halving.h"
#include "mpm/ledger.h"
#include "mpm/point_order.h"
#include "mpm/step_clock.h"
#include "observe/frame.h"
#include "shallow/creep_filter.h"
#include "shallow/flow.h"
#include "structured/earth_pressure.h"
#include "structured/ground.h"
#include "structured/obstacle.h"
#include "structured/structured_points.h"

namespace frana {

/// Particles at the start, equal lengths. They begin without stress but for their weight: a whole block on
/// level ground then rests exactly.
struct StructuredSeeds {
    std::vector<double> x, y;      ///< [m]
    std::vector<double> vx, vy;    ///< [m/s]
    std::vector<double> mass;      ///< [kg]
    std::vector<double> depth;     ///< [m]
    std::vector<double> cohesion;  ///< undamaged [Pa]
    std::vector<double> damage;    ///< [1]

    struct Seed {
        double x, y, vx, vy, mass, depth, cohesion, damage = 0.0;
    };
    void add(const Seed& s) {
        x.push_back(s.x), y.push_back(s.y), vx.push_back(s.vx), vy.push_back(s.vy), mass.push_back(s.mass);
        depth.push_back(s.depth), cohesion.push_back(s.cohesion), damage.push_back(s.damage);
    }
};

struct StructuredScene {
    GridGeometry grid;
    Ground ground = terrain_ground([](double, double) { return Vec2(0.0, 0.0); });
    double density = 1700.0;  ///< [kg/m^3]
    StructuredMaterial material;
    double share = 1.0;                    ///< of the solids that have structure, undamaged [1]
    double gravity = constants::kGravity;  ///< [m/s^2]
    bool hydrostatic = false;  ///< horizontal pressure of grains equals the vertical one, K = 1; otherwise by Rankine's
                               ///< Ka to Kp
    /// The bed under the grains' surface, on the map, needed when there are grains. None: a plane that the particles'
    /// coordinates lie in, and gravity along it by the ground.
    std::function<BedGeometry(const TileGrid&)> bed;
    bool curved = false;  ///< that bed bends, and grains feel it
    Scheme scheme;        ///< of the grains' surface and of splitting them
    BedLaw bed_law;
    std::shared_ptr<const bed::LawMap> laws;  ///< of the nodes; nothing: bed_law everywhere
    double confined = 0.0;                    ///< share of the volume that is water within the structure [1]
    double cfl = 0.4;                         ///< fraction of a cell that sound and flow may pass in a step [1]
    std::vector<Obstacle> obstacles;
    StructuredSeeds points;
};

/// Impulses on the material since the start [kg m/s].
struct StructuredImpulses {
    Flat2 weight{0, 0};    ///< gravity along the plane, with the ground's force and that of free water's pressure
    Flat2 pressure{0, 0};  ///< of grains, against the ground and by the form that is not quite in balance
    Flat2 friction{0, 0};  ///< at the bed
    Flat2 obstacles{0, 0};
    Flat2 water{0, 0};  ///< drag of free water, less what was released into it
    void add(const StructuredImpulses& o) {
        weight += o.weight, pressure += o.pressure, friction += o.friction, obstacles += o.obstacles, water += o.water;
    }
    Vec2 sum() const { return weight + pressure + friction + obstacles + water; }
};

/// What the nodes of a tile have in a step: impulses, and energies along the bed [J].
struct StructuredTally {
    StructuredImpulses impulse;
    double friction = 0.0, obstacles = 0.0;  ///< lost to them
    double squeezed = 0.0;                   ///< lost inside grains
    double drag = 0.0;                       ///< lost by both to the drag of free water
    Index outrun = 0;                        ///< nodes where drag is too weak for xi (WaterViscosity)
    double kinetic = 0.0, potential = 0.0;   ///< after the step; of the places before it
};

/// What particles gained and lost since the start, or in a step (mpm/ledger.h).
struct StructuredLedger {
    double mass_left = 0.0;      ///< gone through the grid's sides [kg]
    double lost_in_holes = 0.0;  ///< of that, in holes of the terrain [kg]
    double energy_left = 0.0;    ///< carried out: motion along the bed, and height above z = 0 [J]
    double released = 0.0;       ///< water given to the nodes [m^3]
    double confined_left = 0.0;  ///< water in particles that have left [m^3]
    double friction = 0.0;       ///< lost at the bed [J]
    double obstacle_work = 0.0;  ///< lost to obstacles [J]
    double squeezed = 0.0;       ///< lost by grains as they spread or are squeezed [J]
    double dragged = 0.0;        ///< lost by particles and water to the drag between them [J]
    double worked = 0.0;         ///< by the strains of the structure: stored, or lost by yielding [J]
    Flat2 momentum_left{0, 0};   ///< carried out [kg m/s]
    StructuredImpulses impulse;
};

/// Sums over the points after a step.
struct StructuredStatus : Clock, StructuredLedger {
    Index points = 0;
    double mass = 0.0;                          ///< in the grid [kg]
    Vec2 momentum{0, 0}, momentum_given{0, 0};  ///< present, at the start [kg m/s]
    double kinetic = 0.0;                       ///< sum of m v^2 / 2, in the plane of the particles [J]
    double damage = 0.0;                        ///< mean over the mass [1]
    double max_speed = 0.0;                     ///< [m/s]
    double bed_kinetic = 0.0, potential = 0.0;  ///< of the nodes, along the bed and above z = 0 [J]
    double stored = 0.0;                        ///< elastic, of the structure in the plane [J]
    Index outrun = 0;         ///< nodes and steps in which drag was too weak for xi, which was left out there
    double flow_steps = 0.0;  ///< sum of each step's bound over the depth-averaged flow's
};

/// Sums of the loops over points, tile by tile.
struct StructuredSums {
    double mass = 0.0, kinetic = 0.0, damaged = 0.0, max_speed2 = 0.0, max_wave = 0.0, max_signal = 0.0;
    double stored = 0.0, worked = 0.0;
    Vec2 momentum{0, 0};
    double left_mass = 0.0, left_energy = 0.0, left_confined = 0.0, released = 0.0, lost_in_holes = 0.0;
    Vec2 left_momentum{0, 0};
    Index bad = -1;  ///< a point whose numbers are not finite
};

/// All that the kernels share.
struct StructuredBody {
    explicit StructuredBody(const StructuredScene& scene);
    StructuredBody(const StructuredBody&) = delete;
    Flow flow;  ///< nodes, and the grains' surface on them; its own particles are not used
    TileGrid& grid = flow.grid;
    ActiveTiles& active = flow.active;
    StructuredLaw law;
    StructuredPoints points;
    Deposit* nodes = flow.nodes.deposits();      ///< momentum, and the force of the structure's stress
    double* node_mass = flow.nodes.mass.data();  ///< [kg]
    struct alignas(32) GrainPressure {
        double xx, yy, xy, share;  ///< sums of w m (1 - f) K and w m (1 - f), of grains
    };
    struct alignas(32) Moved {
        double vx, vy, normal_gravity, depth;  ///< after the step
    };
    struct NodeGround {
        double x, y, across, slope_x, slope_y, elevation;  ///< of the ground
        double open;                                       ///< share of the node that is open, 0 where it was not
                                                           ///< needed yet
        double exit;                                       ///< 1 where there is no ground, 2 in a hole of the terrain
    };
    LazyArray<GrainPressure> grain_pressure;
    LazyArray<Moved> moved;
    LazyArray<NodeGround> ground;
    LazyArray<double> block_depth;  ///< sum of w m f h_c, of structure; only where friction depends on depth [kg m]
    /// What particles are made of, only together with free water [m^3].
    struct alignas(32) Bound {
        double volume, released, solids, structured;
    };
    LazyArray<Bound> bound;
    std::optional<FreeWater> water;
    std::vector<std::uint8_t> gone;        ///< per point: left the grid in this step
    std::vector<StructuredSums> sums;      ///< of the step, per particle tile
    std::vector<StructuredTally> tallies;  ///< of the step, per tile of the work list
    std::vector<Obstacle> obstacles;
    Rankine rankine;
    BedLaw bed_law;            ///< where flow.laws has none
    CreepFilter creep_filter;  ///< of the grains' surface
    double density, share, gravity;
    bool by_depth = false;   ///< friction depends on the depth
    bool grains = false;     ///< some particle is broken or has grains besides its structure
    bool has_exits = false;  ///< some node that was checked has no ground
    bool mapped = false;     ///< coordinates are on the map, and flow has the bed; otherwise they lie in its plane
    bool curved = false;     ///< there, grains feel how the bed bends
};

/// How long forces act in a step, and how long particles then drift [s]. With grains velocities are half a step behind
/// the places (leapfrog), as those of the depth-averaged flow. What is intact begins with a whole step.
struct StepTimes {
    double velocity_dt, drift;
    double ahead = 0.0;  ///< how far free water is ahead at the step's start
};

/// Calls work(grains, water), types that say what there is in a run. They are chosen once a loop, and not for every
/// particle.
template <class Work>
void with_kinds(const StructuredBody& body, Work&& work) {
    const auto with_water = [&](auto grains) {
        if (body.water)
            work(grains, std::true_type{});
        else
            work(grains, std::false_type{});
    };
    if (body.grains)
        with_water(std::true_type{});
    else
        with_water(std::false_type{});
}

// The loops of a step (structured_scatter.cpp, structured_nodes.cpp, structured_gather.cpp).
void clear_nodes(StructuredBody& body);
void scatter(StructuredBody& body);
/// After scatter() where there are grains: depth from sub-points, and the free surface (grain_surface.cpp).
void raise_surface(StructuredBody& body, double velocity_dt);
void move_nodes(StructuredBody& body, const StepTimes& times);
void gather(StructuredBody& body, double dt);
/// The nodes as the particles are now, without a step: `moved`, and the energies of `tallies`.
void sample_nodes(StructuredBody& body);
/// Particles without stress but for the weight that the nodes of sample_nodes() leave them.
void press(StructuredBody& body);

/// A body of particles, and its time loop.
class StructuredFlow {
public:
    explicit StructuredFlow(const StructuredScene& scene);

    /// One step, never past `until` [s], where free water is already. Throws NumericsError when a number stops being finite.
    void advance(double until);
    /// Length at most of the next step [s].
    double longest_step() const;
    /// From now on the particles exchange momentum with free water at their nodes, and what breaks releases its own.
    /// Before the first step.
    void meet(const FreeWater& water);
    /// Brings nodes, and energies of the status, to the particles' present places; changes no particle.
    void sample();
    const StructuredStatus& status() const { return status_; }
    const StructuredBody& body() const { return body_; }
    std::vector<PhaseTime> timings() const { return timed_.times(); }
    /// timings() tell CPU time too from now on.
    void count_cpu_time() { timed_.count_cpu_time(); }
    /// Memory that grows with the points, sort buffers included [bytes].
    Index particle_bytes() const;
    /// Largest speed of particles and the waves on them [m/s].
    double wave() const { return wave_; }
    /// Steps taken so far for each that the depth-averaged flow would need: what elastic waves cost.
    double sub_cycling() const;
    /// Position of a point [m].
    Vec2 position(Index p) const;
    /// Momentum + carried out - given - impulses: round-off [kg m/s]
    Vec2 momentum_residual() const;
    /// Saves the state between two steps, or restores it with all its bits, in a flow of the same scene.
    void serialize(Archive& archive);

private:
    void place(const StructuredScene& scene);
    void sort();
    void take_tiles();
    void learn_ground();
    void begin_grains();
    void split();
    double step_length(double until) const;
    double flow_step(double signal) const;
    void accumulate();
    void update_totals();

    StructuredBody body_;
    Ground ground_;
    PointOrder order_;
    TileSorter lists_;  ///< of tiles, and their turns
    std::function<BedGeometry(const TileGrid&)> bed_;
    HalvingRules rules_;
    Halves halves_;
    std::vector<Index> left_;  ///< tiles of the list before
    StepClock timed_;
    StructuredStatus status_;
    Ledger<StructuredLedger> since_start_;
    double cfl_, sound_speed_;
    bool hydrostatic_;
    double wave_ = 0.0;    ///< largest speed with which surfaces and particles run, both ways of the grid at once [m/s]
    double signal_ = 0.0;  ///< the same along one way: what the depth-averaged flow's steps go by [m/s]
    double drift_ = 0.0;   ///< since the last sort [cells]
};

}  // namespace frana
