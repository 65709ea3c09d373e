#pragma once
// The checked, plain description of one run: SI units, no files, no text to parse. `build_scene` makes it from a
// case file (scene/build_scene.h); `make_simulation` turns it into a solver (run/simulation.h).
#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/constants.h"
#include "convert/profile.h"
#include "law/bed/law_map.h"
#include "law/detrainment.h"
#include "law/erosion/laws.h"
#include "law/free_water.h"
#include "law/rheology/law_map.h"
#include "law/solid/laws.h"
#include "law/structured_law.h"
#include "law/water_friction.h"
#include "particles/seeds.h"
#include "scene/insitu.h"
#include "terrain/holes.h"
#include "terrain/raster.h"

namespace frana {

/// shallow: gentle slopes (Fois et al. 2024). steep: exact on any slope, lakes rest. linearised: steep to first order in
/// the depth gradient, so lakes do not rest. This is Savage and Hutter's slope-normal theory in map coordinates.
enum class TerrainModel { shallow, steep, linearised };
enum class Curvature { none, inertia, full };
enum class Sides { open, wall, mirror };  ///< mirror: a plane of symmetry, which 3D points do not part from
inline bool are_closed(Sides sides) { return sides != Sides::open; }
enum class Transfer { tpic, apic, flip, pic };
enum class Shape { linear, quadratic, cubic };
enum class Precision { full, single };  ///< of what points carry: float64, float32

/// How the equations are solved (shallow/THEORY.md), by default on steep terrain; preset "paper" is Fois et al. (2024).
struct Scheme {
    std::string preset = "default";
    Shape shape = Shape::quadratic;
    Transfer transfer = Transfer::tpic;
    Precision precision = Precision::full;
    double flip_ratio = 0.99;       ///< share of FLIP in transfer "flip" [1]
    double cfl = 1.0;               ///< fraction of a cell per step [1]
    double filter = 1.0;            ///< strength of the surface filter, 0 = off [1]
    double wave_shift = 1.0;        ///< by how much points leave two-cell waves, 0 = not at all [1]
    bool margin = true;             ///< extrapolate the surface at margins from the inside
    double sub_point_reach = 0.25;  ///< of the four points that carry a particle's mass, in domain edges; 0: one point
    double margin_limit = 1.0;      ///< clamp of the quadratic part of the margin extrapolation [1]
    double shock_gate = 0.2;        ///< velocity jump, in wave speeds, from which the limiter fades; 0: never [1]
    double shock_sensor = 0.1;      ///< unlimited jump, in wave speeds, from which the filter is held back; 0: never
    double viscosity_linear = 0.5;  ///< c1 of the artificial viscosity [1]
    double viscosity_quadratic = 1.0;  ///< c2 [1]
    double lateral_drag = 0.0;         ///< C of the drag between neighbours of different velocity, 0: none [1]
    double split_length = 0.8;         ///< domain edge that triggers a split, in cells [1]
    double split_min_mass = 0.02;      ///< no split below this fraction of the largest initial mass [1]
    bool split = true;
    bool merge = true;                  ///< merge points where convergence crowds them
    bool reset_domains = true;          ///< replace strongly sheared domains by rectangles
    bool sleep = true;                  ///< material at rest is not computed again (same bits)
    bool mass_fit = true;               ///< fit the masses of a lake so that it starts at exact rest
    double curvature_length = 10.0;     ///< smoothing length of the bed's Hessian, 0 = none [m]
    double strain_rate_floor = 1e-3;    ///< regularisation of the yield stress [1/s]
    double stress_cap = 0.25;           ///< nu: largest 2 mu_eff dt / (rho cell^2) [1]
    std::optional<double> still_level;  ///< paper preset: known still level of its eq. (33) [m]
    bool paper_pressure = false;        ///< pressure on particles and depth by the ODE (paper preset)
};

/// A named line along which the flow is recorded.
struct Profile {
    std::string name;
    Polyline line;
};
/// A named point at which the flow is recorded every step.
struct Gauge {
    std::string name;
    Vec2 point{0, 0};
};

/// A named line through which the discharge is recorded.
struct Section {
    std::string name;
    Polyline line;
    bool to_right = true;  ///< what goes from its left to its right counts as positive; otherwise the other way
};

/// Material that comes in through a line, or at rest over an area; water where there is free water. Between the times
/// of its table all is linear, before and after it nothing comes.
struct Inflow {
    /// A patch of the area.
    struct Patch {
        Vec2 at;       ///< on the map
        double share;  ///< of the area [1]
    };
    std::string name;
    Polyline line;
    std::vector<Patch> patches;     ///< instead of a line
    double area = 0.0;              ///< of all patches; 0: through a line [m2]
    double layer = 0.0;             ///< depth of an area's row over all of it [m]
    bool to_right = true;           ///< it flows to the right of the line; otherwise to its left
    double slope = 0.0;             ///< of the bed under the line, down the flow's direction; below 0: it climbs [1]
    double spacing = 1.0;           ///< of rows, and of particles in them [m]
    std::vector<double> time;       ///< [s]
    std::vector<double> discharge;  ///< [m3/s]
    std::vector<double> speed;      ///< along the map, across the line [m/s]

    double width() const {
        double sum = 0.0;
        for (std::size_t k = 0; k + 1 < line.size(); ++k) sum += (line[k + 1] - line[k]).norm();
        return sum;
    }
    /// Of the line, half of its width from either end.
    Vec2 middle() const {
        double left = 0.5 * width();
        for (std::size_t k = 0; k + 1 < line.size(); ++k) {
            const double part = (line[k + 1] - line[k]).norm();
            if (part > 0.0 && left <= part) return line[k] + left / part * (line[k + 1] - line[k]);
            left -= part;
        }
        return line.back();
    }
};

/// A node of the bed with the mass of a release that still stands in it.
struct ScarNode {
    Vec2 at;       ///< on the map
    double depth;  ///< along gravity [m]
};

/// A release that enters the run later.
struct LateRelease {
    std::string name;
    std::optional<double> at;  ///< [s]; nothing: when the flow first covers one of its nodes
    Seeds seeds;
    Index first_id = 0;  ///< of its particles, which are numbered on from there
    std::vector<ScarNode> scar =
        {};  ///< what is cut out of the bed when it enters; empty: it does not stand in the bed

    double volume() const {
        double sum = 0.0;
        for (const double part : seeds.volume) sum += part;
        return sum;
    }
};

/// From a time on, the material in a window of the map is 3D points (solid3d/mpm3d.h). What flows into the window later
/// becomes 3D points as it crosses the edge. What flows out of it becomes particles.
struct SolidStage {
    double from = 0.0;                   ///< [s]
    std::optional<double> until;         ///< from then on all are particles again [s]; nothing: to the end
    std::array<Index, 4> window{};       ///< first and last nodes of the terrain's grid in it: i0, j0, i1, j1
    std::array<bool, 4> closed{};        ///< west, south, east, north: points do not cross these sides
    std::array<bool, 4> mirrors{};       ///< those of them that are planes of symmetry
    double cell = 1.0;                   ///< of the 3D grid [m]
    double spacing = 0.5;                ///< of the points at the start [m]
    SolidLaw law;                        ///< of fluids without the bulk modulus, which the speed of sound gives
    bool of_bed = false;                 ///< sand or grains by the bed's friction; stiffness follows from sound
    bool fluid_by_drag = false;          ///< the law is a fluid, since the bed law has no friction at rest
    std::optional<double> sound_speed;   ///< of fluids and such sand [m/s]; nothing: chosen when the stage begins
    std::optional<double> top;           ///< elevation where the space ends [m]; nothing: chosen when the stage begins
    bool split = false;                  ///< points that are drawn apart become two
    bool stuck = false;                  ///< the lowest material does not slide on the bed
    bool stuck_where_resolved = false;   ///< the same, if the cells resolve the layer that shears at the bed then
    double bed_friction = 0.0;           ///< Coulomb's coefficient [1]
    bool whole_bed_law = false;          ///< the case's bed law brakes points, not that coefficient
    double cfl = 0.4;                    ///< fraction of a cell that sound and flow may pass in a step [1]
    Transfer transfer = Transfer::tpic;  ///< tpic, apic or flip
    double blending = 0.0;               ///< of flip: time in which points take over the nodes' velocity [s]
    VelocityProfile profile = VelocityProfile::plug;
    bool along_bed = true;  ///< points start along the bed; otherwise without vertical velocity
};

struct DistanceField;

/// A rigid obstacle: with vertical walls on an outline, or along a line; or of any shape.
struct Barrier {
    std::string name;
    std::shared_ptr<const DistanceField> shape;  ///< when it was given as a mesh: nothing below but hold and friction
    Polygons outline;                            ///< no parts with a line
    Polyline line;                               ///< foot of the face that material comes to
    bool wet_left = true;                        ///< that face is on the left, seen along the line
    std::optional<double> thickness;  ///< of a wall along a line [m]; nothing: as little as the model can hold apart
    std::optional<double> top;        ///< elevation of a level top [m]
    double height = 0.0;              ///< above the bed, which the top then follows [m]
    bool stuck = false;               ///< material does not slide along it
    double friction = 0.0;            ///< Coulomb's coefficient [1]
    std::vector<double> windows;      ///< times over which its force is averaged [s]
};

/// Solids that hold together: particles are elastic, yield and break (structured/structured_flow.h).
struct Structure {
    StructuredMaterial material;
    double cohesion = 0.0;     ///< undamaged [Pa]
    double share = 1.0;        ///< of the solids that have structure, undamaged [1]
    double confined = 0.0;     ///< share of the volume that is water within the structure [1]
    double cfl = 0.4;          ///< fraction of a cell that sound and flow may pass in a step [1]
    bool unrolled = false;     ///< coordinates are measured along the ground, not on the map
    bool hydrostatic = false;  ///< horizontal pressure of grains equals the vertical one, K = 1; otherwise by Rankine's
                               ///< Ka to Kp
};

/// Free water on the grid, together with the particles of a structure (coupling/two_phase_flow.h) or alone. Releases
/// may be of it too.
struct WaterPhase {
    /// What is beyond a side of the terrain. It is what Scene::sides says, a wall, nothing that comes in, or water at a
    /// level.
    struct Side {
        enum class Is { as_sides, wall, free, level } is = Is::as_sides;
        double level = 0.0;  ///< [m]
    };
    WaterExchange exchange;
    WaterFriction friction;
    WaterViscosity viscosity;
    double share = 0.0;           ///< of the releases' volume [1]
    std::optional<double> level;  ///< of a lake at rest [m]
    std::vector<char> lake;       ///< 1 on nodes of the terrain where that lake may be; empty: on all
    std::array<Side, 4> sides{};  ///< west, east, south, north
    Raster rain, infiltration;    ///< on the nodes of the terrain, without values where there is none [m/s]
};

/// Loose material on the bed that the flow can take up (shallow/erosion.h).
struct ErodibleBed {
    Raster depth;             ///< on the nodes of the terrain, along gravity; 0: rock [m]
    double density = 1000.0;  ///< [kg/m^3]
    ErosionLaw law;
    double momentum = 0.0;    ///< kappa: share of the flow's velocity that what is taken brings along [1]
    double min_depth = 0.05;  ///< of a flow that takes anything [m]
    bool evolves = true;      ///< the ground sinks by what is taken; otherwise it is only counted
};

/// What the flow leaves behind as bed (shallow/erosion.h).
struct Deposition {
    std::optional<double> rest;  ///< after so long at rest it becomes bed [s]; nothing: never
};

/// Trees that take mass out of the flow (shallow/erosion.h).
struct Forest {
    Raster pressure;  ///< K of Detrainment on the nodes of the terrain, 0 without trees [Pa]
    Detrainment law;
};

/// Where one part of a spatially varying friction holds, and what it has there.
struct FrictionPart {
    struct Extent {
        std::string key, unit;
        double low, high;
    };
    std::string name;             ///< "material.zone.0 (fan.geojson)", "elsewhere"
    double area = 0.0;            ///< of its nodes on the map, without those that later zones have [m^2]
    std::vector<Extent> extents;  ///< of each parameter that differs somewhere
};

/// Spatially varying friction: bed laws, rheologies and what brakes free water, on the nodes of the bed
/// (shallow/THEORY.md, section 19). A map without nodes: one law everywhere, the scene's.
struct Friction {
    bed::LawMap laws;                 ///< of the bed
    std::vector<std::string> keys;    ///< of the parameters that differ, as zones name them: "mu", "rheology.viscosity"
    std::vector<FrictionPart> parts;  ///< zones in their order, then what is outside of them
    rheology::LawMap rheologies = {};
    WaterLawMap water = {};
};

/// What is written, and when.
struct Output {
    double every = 1.0;  ///< [s]; frames are hit exactly
    bool vtk = true, xdmf = false, geotiff = true, png = true;
    std::string film;                  ///< "mp4", "gif" or, for none, ""
    std::vector<std::string> fields;   ///< empty: all
    double footprint_depth = 0.1;      ///< [m]
    bool history_per_step = true;      ///< history.csv: a line a step, or a line an output
    bool whole_terrain = false;        ///< rasters and frames of all of it, wherever the flow comes
    double checkpoint_minutes = 10.0;  ///< of wall time between checkpoints; 0: one at the end of the run [min]
};

/// What varies spatially on the nodes of a terrain besides its elevations. Empty where a scene has none of it.
struct GroundFields {
    std::shared_ptr<const Friction> friction;
    Raster loose;  ///< ErodibleBed::depth [m]
    Raster trees;  ///< Forest::pressure [Pa]
};

/// A terrain of which a scene holds a part. It also says where more of it comes from as the flow goes on.
struct WiderTerrain {
    GridGeometry grid;                           ///< all of its nodes
    NodeBox held;                                ///< the scene's bed, of these nodes
    std::function<Raster(const NodeBox&)> read;  ///< elevations of a part of it; throws UserError
    std::vector<Vec2> shown;                     ///< places that rasters and frames are to reach as well [m]
    /// The same for a part with these elevations; throws UserError. Nothing: the case has none of it.
    std::function<GroundFields(const Raster& part)> fields = {};
};

struct Scene {
    // In a file of their own. Made anew in every file that has a scene, they take a quarter of its compile time.
    Scene();
    Scene(const Scene&);
    Scene(Scene&&) noexcept;
    Scene& operator=(const Scene&);
    Scene& operator=(Scene&&) noexcept;
    ~Scene();

    std::string name;  ///< case file's folder or stem
    std::string title;
    std::filesystem::path case_file;
    std::filesystem::path footprint;       ///< survey outline, empty when none
    double gravity = constants::kGravity;  ///< [m/s^2]
    double density = 1000.0;               ///< [kg/m^3]

    Raster bed;                                 ///< bed elevation on the solver's nodes [m]; NaN: outside (an exit)
    std::shared_ptr<const WiderTerrain> wider;  ///< nothing: the bed is all of the terrain
    TerrainModel terrain = TerrainModel::steep;
    Curvature curvature = Curvature::full;
    Sides sides = Sides::open;
    Holes holes;                     ///< of the bed, surrounded by terrain
    std::optional<double> hole_top;  ///< of walls there, above the adjacent ground [m]; nothing: material leaves there

    Seeds particles;                           ///< material at the start
    std::vector<Inflow> inflows;               ///< material that comes in later
    std::vector<LateRelease> late;             ///< likewise, all of a release at once
    std::optional<double> still_surface;       ///< level of a release given as one horizontal surface at rest [m]. The
                                               ///< points' masses are then fitted so that it starts at exact rest
    BedLaw bed_law;                            ///< its mean where friction varies spatially
    std::shared_ptr<const Friction> friction;  ///< nothing: the same everywhere
    Rheology rheology;                         ///< likewise its mean
    Scheme scheme;

    double end = 10.0;  ///< [s]
    bool stop_at_rest = false;
    double rest_fraction = 0.05;  ///< mean speed, as a fraction of its peak, above which nothing is at rest [1]
    Output output;
    std::vector<Profile> profiles;
    std::vector<Gauge> gauges;
    std::vector<Section> sections;
    std::vector<Insitu> insitu;      ///< observed while the case runs
    std::optional<Polygons> survey;  ///< surveyed footprint, to compare with
    std::vector<Barrier> barriers;
    std::optional<Structure> structure;    ///< when the material holds together
    std::optional<WaterPhase> water;       ///< together with a structure, or alone
    std::optional<ErodibleBed> erodible;   ///< nothing: the bed is rock
    std::optional<Deposition> deposition;  ///< nothing: none
    std::optional<Forest> forest;          ///< nothing: no trees take mass out
    std::optional<SolidStage> solid;       ///< where and when the run goes into space

    std::vector<std::string> log;  ///< remarks made while building (resampling, nodata, ...)

    /// The laws of the nodes; nullptr: one everywhere, bed_law or rheology or that of `water`.
    const bed::LawMap* bed_laws() const { return friction ? nodes_of(friction->laws) : nullptr; }
    const rheology::LawMap* rheologies() const { return friction ? nodes_of(friction->rheologies) : nullptr; }
    const WaterLawMap* water_laws() const { return friction ? nodes_of(friction->water) : nullptr; }

    /// Flow takes up bed, or becomes bed, or a release is cut out of it during the run.
    bool bed_changes() const { return erodible || deposition || forest || cuts_later(); }
    /// The ground follows what is taken or left behind.
    bool bed_evolves() const { return deposition || forest || cuts_later() || (erodible && erodible->evolves); }
    /// A later release still stands in the bed.
    bool cuts_later() const {
        for (const LateRelease& release : late)
            if (!release.scar.empty()) return true;
        return false;
    }
    /// Material at the start, and that of each late release.
    std::vector<const Seeds*> all_particles() const {
        std::vector<const Seeds*> all = {&particles};
        for (const LateRelease& release : late) all.push_back(&release.seeds);
        return all;
    }

private:
    template <class Laws>
    static const Laws* nodes_of(const Laws& laws) {
        return laws.place.empty() ? nullptr : &laws;
    }
};

/// The bed law of the node nearest to a place.
BedLaw bed_law_at(const Scene& scene, const Vec2& place);
/// What brakes free water there, where that varies spatially; else `everywhere`.
WaterFriction water_friction_at(const Scene& scene, const Vec2& place, const WaterFriction& everywhere);

}  // namespace frana
