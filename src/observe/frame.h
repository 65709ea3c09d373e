#pragma once
// A state for the outside: named arrays with units. Writers and figures use frames, never the solver.
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "base/clock.h"
#include "base/types.h"
#include "terrain/raster.h"

namespace frana {

/// One named quantity; `data` is borrowed and holds count * components numbers, components interleaved.
struct Field {
    std::string name;  ///< "depth", "velocity", ...
    std::string unit;  ///< "m", "m/s", "Pa", "kg", "m3", "1"
    int components = 1;
    const double* data = nullptr;
    Index count = 0;
};

/// Scalars of one step: budgets and extremes. Sums run over all material still in the domain. Between frames
/// velocities (momentum, kinetic energy, speeds) are half a step behind the time. In a frame they are at it.
struct Status : Clock {
    Index particles = 0;
    double mass = 0.0;       ///< [kg]
    double mass_left = 0.0;  ///< left through open sides or exits since the start [kg]
    double mass_in = 0.0;    ///< came in by inflows, or was released later, since the start [kg]. Its momentum and
                             ///< energy count as what did not leave
    std::array<double, 2> momentum{};        ///< [kg m/s]
    std::array<double, 2> impulse{};         ///< of all forces since the start [kg m/s]; the force of walls is recorded
                                             ///< as what closes the balance
    std::array<double, 2> momentum_left{};   ///< carried out by what left [kg m/s]
    double water = 0.0, water_volume = 0.0;  ///< free water's part of `mass` [kg], and its volume [m3]
    double kinetic = 0.0;                    ///< [J]
    double potential = 0.0;                  ///< sum of rho g A h (Z + h/2) [J]
    double dissipated = 0.0;                 ///< by bed friction, rheology and bores since the start [J]
    double energy_left = 0.0;                ///< carried out by what left [J]
    double stored = 0.0;                     ///< of 3D points: of deformation, that unloading gives back [J]
    /// Of 3D points since the start, parts of `dissipated` [J].
    struct In3d {
        double friction = 0.0;   ///< along the bed and barriers
        double walls = 0.0;      ///< lost to their forces
        double material = 0.0;   ///< yielding and viscosity
        double numerical = 0.0;  ///< what is left: of the scheme
        double volume = 0.0;     ///< of the points now, compressed as they are [m3]; not a part, but a diagnostic
    } in_3d;
    /// Of an erodible bed; all zero without one.
    struct Bed {
        double initial = 0.0;    ///< that could be taken at the start [kg]
        double mass = 0.0;       ///< that is left of it, counted anew [kg]
        double eroded = 0.0;     ///< what the flow gained, since the start [kg]
        double deposited = 0.0;  ///< what it gave to the bed, since the start [kg]
        double energy = 0.0;     ///< potential energy that came with what was taken, since the start [J]
        double deepest = 0.0;    ///< largest depth taken, along gravity [m]
    } bed;
    double p2g_mass_error = 0.0;      ///< |sum_i M_i - sum_p m_p| / sum_p m_p of this step [1]
    double p2g_momentum_error = 0.0;  ///< |sum_i P_i - sum_p m_p v_p| / sum_p m_p |v_p| [1]
    double max_depth = 0.0;           ///< [m]
    double max_speed = 0.0;  ///< largest speed along the bed of nodes deeper than a tenth of the footprint depth [m/s].
                             ///< Of 3D points that of the fastest
    double max_speed_on_map = 0.0;  ///< largest particle speed along the map [m/s]
    double mean_speed = 0.0;        ///< mean over the mass, along the bed; 3D points have their whole speed [m/s]
    double covered_area = 0.0;      ///< deeper than the footprint depth now [m2]
    double front = 0.0;             ///< largest map distance of such a node from the release's centre [m]
};

/// Time spent in one named phase of the step.
struct PhaseTime {
    std::string name;
    double seconds = 0.0;      ///< wall time
    double cpu_seconds = 0.0;  ///< of the thread that steps; zero unless the solver counts it
    Index calls = 0;
};

/// What solids that hold together have come apart into.
struct Breakage {
    double damage = 0.0;             ///< mean over the mass, 0 whole, 1 grains [1]
    std::vector<double> pieces;      ///< shares of the mass in unbroken pieces, the largest first [1]
    Index pairs = 0;                 ///< of particles that were neighbours at the start
    Index torn = 0;                  ///< of these, now apart
    Index numerical = 0;             ///< of these, without damage to either: torn by the scheme
    double sub_cycling = 1.0;        ///< steps for each that the depth-averaged flow would need
    std::array<double, 2> pushed{};  ///< impulse on barriers and walls, all together, since the start [kg m/s]
};

/// What 3D points have come apart into (solid3d/pieces.h), at the last output and where it was most.
struct PointsApart {
    Index pieces = 0;                                ///< points of different ones are more than a cell apart
    double apart = 0.0;                              ///< share of their mass outside the largest [1]
    double alone = 0.0;                              ///< share that feels nothing of the largest any more [1]
    double most_apart = 0.0, most_apart_time = 0.0;  ///< largest `apart` of all outputs [1], [s]
};

/// What came in by inflows.
struct InflowBudget {
    double volume = 0.0;    ///< by the particles' masses [m3]
    double expected = 0.0;  ///< by the tables, up to the last row of each that came in [m3]
    double tables = 0.0;    ///< by the whole tables [m3]
};

/// What became of a release that was to enter later.
struct LateEntry {
    std::string name;
    double volume = 0.0;            ///< [m3]
    std::optional<double> at;       ///< when it was to [s]; nothing: when the flow reaches it
    std::optional<double> entered;  ///< [s]; nothing: it did not yet
    bool of_bed = false;            ///< it is cut out of the bed when it enters
};

/// Free water, and that which particles confine.
struct WaterBudget {
    double given = 0.0, free = 0.0, confined = 0.0;      ///< at the start, all; now [m3]
    double released = 0.0;                               ///< by what broke, since the start [m3]
    double rained = 0.0, infiltrated = 0.0, left = 0.0;  ///< the last also within particles [m3]
    double entered = 0.0;                                ///< from a lake beyond open sides [m3]
    double fed = 0.0;                                    ///< by inflows [m3]
    double infiltrated_mass = 0.0;                       ///< [kg]
    double solids_left = 0.0;                            ///< grains that left within particles, without pores [m3]
    double residual = 0.0;                               ///< of all these: round-off [m3]
    double bed = 0.0, viscosity = 0.0, drag = 0.0;       ///< energy lost there [J]
    double steps = 0.0;                                  ///< of the particles for each of the water
};

/// What only some models can tell of a run; nothing of the others.
struct Extras {
    std::optional<Breakage> breakage;         ///< what structured material has come apart into
    std::optional<PointsApart> points_apart;  ///< what 3D points have come apart into
    std::optional<WaterBudget> water;         ///< where the water is and has gone
    std::optional<InflowBudget> inflow;       ///< what came in by inflows
    std::vector<LateEntry> late;              ///< releases that enter later, in the order of the case
};

/// A face of a barrier in patches, and what material gave to each since the start.
struct PatchedFace {
    Index barrier = 0, face = 0;
    std::array<double, 3> corner{}, right{}, up{};  ///< a corner [m]; unit vectors along its edges
    double size = 1.0;                              ///< edge of a patch [m]
    std::array<Index, 2> count{};                   ///< patches along right and up
    std::vector<double> area;                       ///< of each patch that material can reach [m^2]
    std::vector<char> off_face;                     ///< per patch: 1 if nothing of the face is there; or empty
    std::vector<std::array<double, 3>> impulse;     ///< on the barrier, row after row from the corner [kg m/s]
};

/// A state at an output time; valid only during the call that hands it out.
struct Frame {
    Index number = 0;  ///< 0, 1, 2, ... of the output frames
    Status status;
    std::vector<Field> particles;  ///< "position" (3: x, y, z on the free surface), "depth", "velocity" (3), ...
    GridGeometry grid;
    std::vector<PatchedFace> faces;  ///< of barriers, where their loads are measured
    std::vector<Field> nodes;        ///< "elevation", "depth", "surface", "velocity" (3), "peak_depth", ...

    /// The field of that name, or nullptr.
    const Field* particle(const std::string& name) const { return find(particles, name); }
    const Field* node(const std::string& name) const { return find(nodes, name); }

private:
    static const Field* find(const std::vector<Field>& fields, const std::string& name) {
        for (const Field& field : fields)
            if (field.name == name) return &field;
        return nullptr;
    }
};

}  // namespace frana
