#pragma once
// Free water on the grid of the particles: the shallow-water equations over bed and confined mass. The finite volume
// scheme is of second order, with lakes at rest and positive depths. One cell around each node.
#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "base/clock.h"
#include "base/constants.h"
#include "law/bed/law_map.h"
#include "law/free_water.h"
#include "law/water_friction.h"
#include "mpm/ledger.h"
#include "mpm/on_storage.h"
#include "mpm/step_clock.h"
#include "mpm/tile_grid.h"
#include "observe/frame.h"

namespace frana {

/// What a side of the grid does. It stops the water. Or it lets it go, and none comes in (free), or of a lake alone
/// (open: WaterScene::level). Or it holds it at a level (WaterScene::side_levels), where it goes both ways.
enum class WaterSide { wall, open, free, level };

/// Water that comes in at cells: a discharge and a speed that are linear between the times of a table. Before and after it
/// nothing comes.
struct WaterSource {
    struct Place {
        Index i, j;    ///< the cell's node
        double share;  ///< of the discharge, 1 over all places [1]
        Vec2 towards;  ///< unit vector on the map that the water flows along
    };
    std::vector<double> time;       ///< [s]
    std::vector<double> discharge;  ///< [m^3/s]
    std::vector<double> speed;      ///< on the map [m/s]
    std::vector<Place> places;
};

/// Depth [m] and velocity on the map [m/s] at the start, means over a cell.
struct WaterState {
    double depth = 0.0, u = 0.0, v = 0.0;
};

/// Curvature of the ground: second derivatives of its elevation [1/m].
struct BedCurvature {
    double xx = 0.0, xy = 0.0, yy = 0.0;
    /// v.H.v: vertical acceleration of what follows the ground with a velocity on the map [m/s^2].
    double rise(const Vec2& v) const { return v.x() * v.x() * xx + 2.0 * v.x() * v.y() * xy + v.y() * v.y() * yy; }
};

struct WaterScene {
    using Function = std::function<double(double x, double y)>;
    GridGeometry grid;                                         ///< at least 3 nodes each way
    Function bed = [](double, double) { return 0.0; };         ///< elevation [m]
    Function confined = {};                                    ///< depth of confined mass, none without [m]
    std::function<WaterState(double x, double y)> start = {};  ///< dry without
    Function rain = {};                                        ///< [m/s]; none without
    Function infiltration = {};                                ///< what the ground takes at most [m/s]
    std::array<WaterSide, 4> sides{};                          ///< at low x, high x, low y, high y
    std::optional<double> level;  ///< of a lake that goes on beyond open sides, where the ground there is lower [m]
    std::array<double, 4> side_levels{};  ///< of the water beyond sides that hold one [m]
    std::vector<WaterSource> sources;
    WaterFriction friction;
    Function friction_at = {};  ///< its coefficient, where that varies spatially
    WaterViscosity viscosity;
    /// Brakes in place of both where there is one: what flows may be mud, or an avalanche.
    std::optional<BedLaw> bed_law;
    std::shared_ptr<const bed::LawMap> bed_laws;  ///< those of the nodes, where they vary spatially
    double density = 1000.0;                      ///< that the bed law is given [kg/m^3]
    double gravity = constants::kGravity;         ///< [m/s^2]
    /// Gravity across the ground is g / (1 + |grad b|^2), as for solids (structured/ground.h). So thin water slides
    /// down a steep plane as a block does. Else it is g, and these are the shallow-water equations as they are printed.
    /// With both, lakes stay at rest: each cell's slope of the surface is multiplied by its own value.
    bool steep = true;
    /// Of steep ground, smoothed: it turns water that flows over it. None: water's velocity on the map stays the same
    /// over a bend.
    std::function<BedCurvature(double x, double y)> curvature = {};
    double theta = 2.0;  ///< of the limiter, 1 (minmod) to 2 (MC: of the smaller errors, face_flux.h)
    double cfl = 0.45;   ///< part of a cell that waves may pass in a step, below 1/2 [1]
    double film = 1e-6;  ///< water as shallow as this stays where it is [m]
};

/// Sums over density since the start, or of one step (mpm/ledger.h): volumes [m^3], momentum [m^4/s].
struct WaterLedger {
    double rained = 0.0, infiltrated = 0.0, left = 0.0;
    double entered = 0.0;                                   ///< from a lake beyond sides
    double fed = 0.0;                                       ///< by sources
    Flat2 momentum_left{0, 0}, momentum_infiltrated{0, 0};  ///< carried out, less what entered brought
    double released = 0.0;                                  ///< given by particles
    Flat2 particles{0, 0};                                  ///< of what particles released, and their drag
    Flat2 ground{0, 0};                                     ///< force of bed and confined mass
    Flat2 walls{0, 0};                                      ///< force of walls, and of the water beyond open sides
    Flat2 friction{0, 0};                                   ///< at the bed, and what films lose that stop
    /// Energy over density [m^5/s^2]. braked: lost at the bed, by films that stop and in speeding up rain. sheared:
    /// lost to viscosity inside. energy_out: gone with the water through open sides and into the ground, less what
    /// rain, sources and entering water brought. Heights are above the datum.
    double braked = 0.0, sheared = 0.0, energy_out = 0.0;
    void add(const WaterLedger& o, double share = 1.0);
};

/// After a step; all over the density.
struct WaterStatus : Clock {
    double volume = 0.0, volume_given = 0.0;    ///< present, at the start [m^3]
    Vec2 momentum{0, 0}, momentum_given{0, 0};  ///< present, at the start [m^4/s]
    WaterLedger ledger;
    double kinetic = 0.0;    ///< sum of h v^2 / 2 [m^5/s^2]
    double max_speed = 0.0;  ///< [m/s]
};

/// Sums of a step's loops, tile by tile.
struct WaterSums {
    WaterLedger ledger;
    double volume = 0.0, kinetic = 0.0, max_speed2 = 0.0, signal = 0.0;
    Vec2 momentum{0, 0};
    std::uint16_t near = 0;  ///< bit 3 (dj + 1) + di + 1: water is near that neighbour; bit 4: there is some here
    Index bad = -1;          ///< a node whose numbers are not finite
};

/// Depth and discharge, one number a node.
struct WaterFields {
    explicit WaterFields(Index count) : h(count), qx(count), qy(count) {}
    LazyArray<double> h;       ///< [m]
    LazyArray<double> qx, qy;  ///< [m^2/s]
};

/// All that the kernels share.
struct WaterBody {
    /// Gravity by which water with a velocity on the map [m/s] presses on the ground [m/s^2]: less on a crest, and more in a
    /// hollow.
    double pressing(Index k, const Vec2& v) const {
        return curvature ? normal_gravity[k] * std::max(0.0, 1.0 + curvature[k].rise(v) / gravity) : normal_gravity[k];
    }
    explicit WaterBody(const WaterScene& scene);
    /// The highest of the lakes beyond the sides that the cell is at [m]. Far below all ground where there is none
    double highest_lake(Index i, Index j) const {
        double highest = kNoLake;
        const auto at = [&](std::size_t side, bool here) {
            if (here && sides[side] != WaterSide::wall) highest = std::max(highest, lakes[side]);
        };
        at(0, i == 0), at(1, i == grid.nx() - 1), at(2, j == 0), at(3, j == grid.ny() - 1);
        return highest;
    }
    /// Whether a lake goes on beyond the cell: its ground is lower than that.
    bool meets_lake(Index i, Index j) const { return bed[grid.at(i, j)] < highest_lake(i, j); }
    TileGrid grid;
    WaterFields now, half;                 ///< the state; after the first stage of a step
    LazyArray<double> driven_x, driven_y;  ///< discharge after the first stage, before friction [m^2/s]
    LazyArray<double> bed;                 ///< elevation above `datum` [m], two nodes beyond the grid as well
    LazyArray<double> confined;            ///< depth of confined mass [m]: may be changed between steps
    LazyArray<double> normal_gravity;      ///< gravity across the ground [m/s^2]
    LazyArray<BedCurvature> curvature;     ///< empty where none turns the water
    /// With WaterViscosity::solid_gradient, as confined: confined mass's share of the volume [1], its velocity [m/s].
    LazyArray<double> share, bound_x, bound_y;
    LazyArray<double> rain, infiltration;  ///< [m/s]; empty without
    /// What sources bring to the cells in the step: depth [m] and discharge [m^2/s]; empty without sources.
    LazyArray<double> fed, fed_x, fed_y;
    std::vector<Index> work;      ///< tiles that hold water, be it a film, or are within its reach
    std::vector<WaterSums> sums;  ///< of the step, per tile of the list
    std::array<WaterSide, 4> sides;
    WaterFriction::Law friction;
    OnNodes<double> coefficient;  ///< of that law
    WaterViscosity viscosity;
    std::optional<bed::LawTable> bed_laws;
    OnNodes<std::uint32_t> bed_law;  ///< its place in that table
    double density;
    double gravity, theta, film;
    double datum;  ///< so that water high above the sea loses no digits [m]
    static constexpr double kNoLake = -std::numeric_limits<double>::max();
    std::array<double, 4> lakes;  ///< above it, of those beyond the sides; kNoLake without one [m]
    bool steep;
};

// The loops of a step (water_kernel.cpp).
void first_stage(WaterBody& body, double dt);
/// The second stage, its mean with the start, rain, infiltration, friction, and sums.
void second_stage(WaterBody& body, double dt);
/// Sums of the state as it is.
WaterSums tile_sums(const WaterBody& body, Index tile);

/// Water and its time loop.
class WaterFlow {
public:
    explicit WaterFlow(const WaterScene& scene);

    /// One step, never past `until` [s]. Throws NumericsError when a number stops being finite.
    void advance(double until);
    /// Length at most of the next step; 0 where there is no water, which has any [s].
    double longest_step() const;
    const WaterStatus& status() const { return status_; }
    const WaterBody& body() const { return body_; }
    /// Of water that is deeper than a film [m^3].
    double volume_faster_than(double speed) const;
    /// Depth of confined mass at a node, from the next step on [m]
    void confine(Index i, Index j, double depth) { body_.confined[body_.grid.at(i, j)] = depth; }
    /// The same of its share in the volume and its velocity, for WaterViscosity::solid_gradient.
    void mix(Index i, Index j, double share, const Vec2& velocity) {
        const Index k = body_.grid.at(i, j);
        body_.share[k] = share, body_.bound_x[k] = velocity.x(), body_.bound_y[k] = velocity.y();
    }
    /// Lets particles change depth and discharge between steps, and shows them the bed; take_changes() follows.
    void lend(FreeWater& to) {
        to.h = body_.now.h.data(), to.qx = body_.now.qx.data(), to.qy = body_.now.qy.data();
        to.bed = body_.bed.data(), to.film = body_.film, to.friction = body_.friction;
        to.coefficients = body_.coefficient.view(), to.viscosity = body_.viscosity;
    }
    /// Takes up what particles on these tiles (ascending) changed: status and ledger have it from now on.
    void take_changes(const std::vector<Index>& tiles);
    /// Saves the state between two steps, or restores it with all its bits, in a flow of the same scene. Confined mass
    /// is not part of it.
    void serialize(Archive& archive);
    /// State of the cell around a node; elevation of its surface [m]
    WaterState at(Index i, Index j) const;
    double surface(Index i, Index j) const;
    std::vector<PhaseTime> timings() const { return timed_.times(); }
    /// By the tables of the sources, up to now and on the whole [m^3].
    double due_so_far() const;
    double due_at_all() const;
    /// Whether sources have more to bring.
    bool sources_go_on() const;
    /// Whether water comes without end: as rain, or from a lake beyond a side.
    bool comes_on() const { return comes_on_; }
    /// Whether ground that takes water has some on it.
    bool soaks_in() const;
    /// Present + left + infiltrated - rained - entered - fed - given [m^3], and momentum the same way [m^4/s]: round-off
    double volume_residual() const;
    Vec2 momentum_residual() const;

private:
    void place(const WaterScene& scene);
    void place_sources();
    void expect_water(Index i, Index j, Index reach);
    void feed(double end);
    void list_tiles();
    void clear_tiles();
    double step_length(double until) const;
    void accumulate();
    WaterSums summed() const;
    void take(const WaterSums& all);

    WaterBody body_;
    StepClock timed_;
    WaterStatus status_;
    Ledger<WaterLedger> since_start_;
    std::vector<std::uint8_t> wanted_;  ///< per tile: on the next list
    std::vector<std::uint8_t> rained_;  ///< per tile: rain may fall on it, a source be there, or a lake come in
    std::vector<WaterSource> sources_;
    bool comes_on_ = false;
    std::vector<Index> next_;
    double cfl_;
    double signal_ = 0.0;  ///< largest speed of water and waves [m/s]
};

}  // namespace frana
