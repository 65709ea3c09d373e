// The table itself: every key a case file can have. The order is that of the documentation.
#include <cmath>

#include "base/constants.h"
#include "law/bed/laws.h"
#include "law/catalogue.h"
#include "law/rheology/laws.h"
#include "law/water_friction.h"
#include "scene/inflow_table.h"
#include "scene/law_places.h"
#include "scene/parameter_makers.h"
#include "scene/parameter_ranges.h"

namespace frana {
namespace {

using namespace rows;

void add_terrain(Table& table) {
    table.push_back(absent(make("case.title", Kind::text, "", "title of reports and figures"), "the case's name"));
    Parameter kind = make("case.kind", Kind::choice, "",
                          "what moves: values of friction and density outside of its common ranges are remarked upon "
                          "(cases/PARAMETERS.md)");
    for (const MassKind& mass : mass_kinds()) kind.choices.push_back(mass.name);
    table.push_back(absent(kind, "no ranges are known"));
    table.push_back(
        required(make("terrain.dem", Kind::path, "", "elevation model: any GDAL raster, CRS projected in metres")));
    Parameter window = make("terrain.window", Kind::numbers, "m",
                            "part of the elevation model to use: [xmin, ymin, xmax, ymax] in map coordinates");
    window.length = 4;
    table.push_back(absent(window, "the whole elevation model"));
    table.push_back(paper(choice("terrain.model", {"steep", "shallow", "linearised"}, "steep",
                                 "steep: exact on any slope; shallow: gentle slopes (Fois et al. 2024); linearised: "
                                 "Savage and Hutter's theory, for comparison with its solutions"),
                          text("shallow")));
    Parameter curvature =
        choice("terrain.curvature", {"full", "inertia", "none"}, "full",
               "bed curvature: full; inertia: in the acceleration, not in the friction; none. With material.structure "
               "only fragmented material (grains) feels a bend");
    curvature.otherwise.push_back({"terrain.model", text("shallow"), text("none")});
    curvature.otherwise.push_back({"terrain.unrolled", true, text("none")});
    table.push_back(curvature);
    table.push_back(
        flag("terrain.unrolled", false,
             "coordinates are measured along the ground, as along the floor of a flume, not on the map; with "
             "material.structure only"));
    table.push_back(
        number("terrain.gravity", "m/s^2", above_to(0.0, 300.0), constants::kGravity, "acceleration of gravity"));
    table.push_back(
        absent(number("grid.cell", "m", positive, "node distance of the grid"), "the pixel of the elevation model"));
}

void add_release(Table& table) {
    table.push_back(absent(instead(make("release.outline", Kind::path, "",
                                        "polygons of the release, with or without holes: any OGR vector file"),
                                   "release.mask"),
                           "the mask, or the whole terrain"));
    table.push_back(absent(make("release.layer", Kind::text, "",
                                "layer of the outline's file that is meant, where it has several; any vector file may "
                                "also be given as FILE|layername=LAYER"),
                           "the only layer"));
    table.push_back(
        absent(instead(make("release.mask", Kind::path, "", "raster of the release: material where it is above 0"),
                       "release.outline"),
               "the outline, or the whole terrain"));
    Parameter depth =
        make("release.depth", Kind::number_or_path, "m",
             "depth of the release, or a raster of it (interpolated on finer cells), or \"field:NAME\": an attribute "
             "of the outline's features");
    depth.range = positive;
    table.push_back(absent(instead(depth, "release.surface"), "surface is needed"));
    table.push_back(
        absent(instead(make("release.surface", Kind::number_or_path, "m",
                            "elevation of the release's upper surface, or a raster of it; depth = surface - bed"),
                       "release.depth"),
               "depth is needed"));
    table.push_back(choice("release.thickness", {"vertical", "normal"}, "vertical",
                           "whether depth is measured along gravity or normal to the slope"));
    Parameter velocity = make("release.velocity", Kind::numbers_or_paths, "m/s",
                              "horizontal velocity at the start, to the east and north; or two rasters");
    velocity.length = 2;
    velocity.fallback = std::vector<double>{0.0, 0.0};
    table.push_back(velocity);
    table.push_back(
        flag("release.included_in_dem", false,
             "the mass still stands in the elevation model, and is cut out of the bed when the release enters"));
    table.push_back(number("release.at", "s", not_negative, 0.0, "when the release enters the run"));
    table.push_back(flag("release.when_hit", false,
                         "the release enters in the step in which a node that it covers is first deeper than "
                         "output.footprint_depth in the flow (secondary release)"));
    Parameter per_cell = make("particles.per_cell", Kind::integer, "1", "particles in a full cell of the grid");
    per_cell.range = between(1.0, 400.0);
    per_cell.fallback = 4.0;
    table.push_back(instead(per_cell, "particles.count"));
    Parameter count = make("particles.count", Kind::integer, "1", "particles in all releases together, about");
    count.range = between(1.0, 2.0e9);
    table.push_back(absent(instead(count, "particles.per_cell"), "particles.per_cell decides"));
    table.push_back(choice("particles.placement", {"lattice", "r2", "slope"}, "lattice",
                           "lattice; r2: quasi-random sequence; slope: denser where the bed is steeper"));
}

void add_inflow(Table& table) {
    table.push_back(required(make("inflow.name", Kind::name, "", "name of the inflow in reports")));
    Parameter line =
        make("inflow.line", Kind::points_or_path, "m",
             "line through which material comes in, across the flow and as wide as that: [[x, y], [x, y], ...], or a "
             "vector file of one line");
    line.length = 2;
    table.push_back(absent(instead(line, "inflow.area"), "area is needed"));
    Parameter area =
        make("inflow.area", Kind::points_or_path, "m",
             "area over which material comes in at rest, such as a spring: the corners of a polygon, [[x, y], "
             "[x, y], [x, y], ...], or a vector file of polygons");
    area.length = 3;
    table.push_back(absent(instead(area, "inflow.line"), "line is needed"));
    Parameter towards =
        make("inflow.towards", Kind::numbers, "m", "a point on the side of the line that the flow goes to: [x, y]");
    towards.length = 2;
    table.push_back(absent(goes_with(towards, "inflow.line"), "down the slope"));
    table.push_back(
        absent(instead(make("inflow.table", Kind::path, "",
                            "CSV of the discharge over time, linear between its rows: a header with units, such "
                            "as t [s], discharge [m3/s] and, if wanted, velocity [m/s]; or t_min, t_h; or rows of "
                            "r.avaflow, t Q v for each phase, without units"),
                       "inflow.volume"),
               "volume is needed"));
    table.push_back(absent(
        instead(number("inflow.volume", "m3", positive, "volume of a triangle of discharge over time"), "inflow.table"),
        "table is needed"));
    Parameter peak = make(
        "inflow.peak", Kind::number_or_choice, "m3/s",
        "highest discharge of that triangle, or what it follows by from its volume V, m3/s and m3: mizuyama-granular: "
        "0.135 V^0.78, mizuyama-muddy: 0.0188 V^0.79 (Mizuyama et al. 1992), rickenmann: 0.1 V^0.833 (1999)");
    peak.range = positive;
    peak.choices = peak_formulas();
    table.push_back(absent(goes_with(peak, "inflow.volume"), "mizuyama-granular"));
    table.push_back(
        goes_with(number("inflow.at", "s", not_negative, 0.0, "when that triangle begins"), "inflow.volume"));
    table.push_back(
        absent(goes_with(number("inflow.rise", "s", positive, "from there until it is highest"), "inflow.volume"),
               "a tenth of its time"));
    Parameter velocity =
        make("inflow.velocity", Kind::number_or_choice, "m/s",
             "speed along the bed at the line; normal: that of uniform flow by the bed law, on the slope "
             "under the line; column: the table's");
    velocity.range = positive;
    velocity.choices = {"normal", "column"};
    velocity.fallback = text("normal");
    table.push_back(goes_with(velocity, "inflow.line"));
}

template <class Law>
void add_law(Table& table, const LawPlace& place, const std::string& is) {
    using Laws = laws::Catalogue<Law>;
    const std::string meaning = is + Laws::other_names();
    table.push_back(choice(place.choice, Laws::words(), "none", meaning.c_str()));
    add_numbers<Law>(table, place);
}

/// Friction of snow by classes of ground, instead of mu and xi.
void add_friction_table(Table& table) {
    table.push_back(
        choice("material.bed.table", {"none", "voellmy-salm"}, "none",
               "mu and xi of snow by ground, altitude, size and return period, instead of these keys; with "
               "law = \"voellmy\" only (Voellmy-Salm classes of the raster tool of the Norwegian Geotechnical "
               "Institute)"));
    const auto add = [&](const Parameter& row) { table.push_back(with(row, "material.bed.table", {"voellmy-salm"})); };
    const auto list = [](const char* key, const char* unit, std::vector<double> fallback, const char* meaning) {
        Parameter row = make(key, Kind::numbers, unit, meaning);
        row.length = fallback.size();
        row.fallback = std::move(fallback);
        return row;
    };
    add(number("material.bed.return_period", "a", positive, 300.0, "of the avalanche: 10, 30, 100 or 300 years"));
    Parameter size = make("material.bed.volume_class", Kind::choice, "",
                          "of the avalanche: tiny below 5000 m3, small below 25000, medium below 60000, large");
    size.choices = {"tiny", "small", "medium", "large"};
    add(absent(size, "that of the volume of all releases, later ones too; needed with [[inflow]]"));
    add(list("material.bed.altitude_limits", "m", {1000.0, 1500.0},
             "elevations from which on snow has the friction of the middle and of the high zone"));
    add(number("material.bed.curvature_length", "m", not_negative, 50.0,
               "side of the squares that the terrain is averaged over before its slope and plan curvature tell classes "
               "of ground; a choice of frana's"));
    add(number("material.bed.flat_below_deg", "degree", between(0.0, 90.0), 10.0,
               "ground gentler than this is flat; a choice of frana's"));
    add(list("material.bed.curvature_limits", "1/m", {-0.002, 0.002, 0.01},
             "plan curvatures (hollow contours positive) from which on ground is an open slope, channelled, a gully; "
             "below the first it is convex; choices of frana's"));
}

/// Those of a law that are others in a zone.
template <class Law>
void add_zone_numbers(Table& table, const LawPlace& place) {
    const std::string zone = "material.zone." + std::string(place.in_zone);
    for (const laws::SharedKey& key : laws::Catalogue<Law>::keys()) {
        const std::string name = zone + key.name;
        Parameter row = number(name.c_str(), key.unit.c_str(), key.range, key.meaning.c_str());
        if (!key.instead_of.empty()) row.instead_of = zone + key.instead_of;
        table.push_back(absent(row, "as without the zone"));
    }
}

/// Where friction is another: any key of the bed law, the rheology and the friction of water.
void add_zones(Table& table) {
    const char* const everywhere = "not bounded so";
    table.push_back(absent(make("material.zone.outline", Kind::path, "",
                                "polygons of the zone: any OGR vector file; later zones win, and nodes have the "
                                "friction of the zone that they lie in"),
                           everywhere));
    table.push_back(
        absent(number("material.zone.above", "m", any_number, "elevation from which on it is the zone"), everywhere));
    table.push_back(
        absent(number("material.zone.below", "m", any_number, "elevation below which it is the zone"), everywhere));
    add_zone_numbers<BedLaw>(table, kBedPlace);
    add_zone_numbers<Rheology>(table, kRheologyPlace);
    add_zone_numbers<WaterLaw>(table, kWaterPlace);
}

void add_material(Table& table) {
    Parameter density = number("material.density", "kg/m^3", positive, 1000.0, "density of the mass");
    for (const MassKind& mass : mass_kinds()) density.otherwise.push_back({"case.kind", text(mass.name), mass.density});
    table.push_back(density);
    add_law<BedLaw>(table, kBedPlace, "friction between the mass and its bed");
    add_friction_table(table);
    add_zones(table);
    add_law<Rheology>(table, kRheologyPlace, "stress inside the mass");
    add_structure(table);
    add_erodible(table);
    add_deposition(table);
    add_forest(table);
    add_water(table);
}

void add_scheme(Table& table) {
    const Range small = above_to(0.0, 1.0);
    table.push_back(choice("scheme.preset", {"default", "fast", "paper"}, "default",
                           "default; fast: fewer particles; paper: the choices of Fois et al. (2024); single keys "
                           "override them"));
    table.push_back(paper(choice("scheme.shape", {"linear", "quadratic", "cubic"}, "quadratic", "shape functions"),
                          text("linear")));
    table.push_back(paper(choice("scheme.transfer", {"tpic", "apic", "flip", "pic"}, "tpic",
                                 "how velocity passes between particles and grid"),
                          text("pic")));
    table.push_back(choice("scheme.precision", {"double", "float"}, "double",
                           "how memory holds what particles carry (velocity, gradient, domain, depth); float needs "
                           "quadratic shapes, tpic and the default preset"));
    table.push_back(with(number("scheme.flip_ratio", "1", fraction, 0.99, "share of FLIP, the rest is PIC"),
                         "scheme.transfer", {"flip"}));
    Parameter cfl = paper(number("scheme.cfl", "1", small, 1.0,
                                 "largest way in one time step, in cells; 0.5 at most is used "
                                 "with [erodible] and with stages"),
                          0.25);
    cfl.otherwise.push_back({"scheme.shape", text("linear"), 0.5});
    table.push_back(std::move(cfl));
    table.push_back(paper(number("scheme.filter", "1", fraction, 1.0, "strength of the surface filter"), 0.0));
    table.push_back(paper(
        number(
            "scheme.wave_shift", "1", between(0.0, 2.0), 1.0,
            "how much particles on their way leave depths that repeat every two cells; 0: they stay; nothing without "
            "scheme.filter"),
        0.0));
    table.push_back(flag("scheme.margin", true, "extrapolate the surface at margins from the inside"));
    table.push_back(number("scheme.sub_point_reach", "1", between(0.0, 0.5), 0.25,
                           "place of a particle's four sub-points, in edges of its domain; 0: all at its centre"));
    table.push_back(number("scheme.margin_limit", "1", between(0.0, 4.0), 1.0,
                           "limit of the quadratic part of the extrapolation at margins, in depths"));
    table.push_back(paper(number("scheme.viscosity_linear", "1", not_negative, 0.5,
                                 "artificial viscosity, coefficient of the wave speed"),
                          0.0));
    table.push_back(paper(number("scheme.viscosity_quadratic", "1", not_negative, 1.0,
                                 "artificial viscosity, coefficient of the velocity jump"),
                          0.0));
    table.push_back(
        number("scheme.lateral_drag", "1", not_negative, 0.0,
               "drag between neighbouring material of different velocity, SamosAT's artificial viscosity; 0: none"));
    table.push_back(
        number("scheme.shock_gate", "1", not_negative, 0.2,
               "velocity jump between nodes, in wave speeds, that counts as a bore for the viscosity; 0: none"));
    table.push_back(number("scheme.shock_sensor", "1", not_negative, 0.1,
                           "jump, in wave speeds, from which the surface filter is held back; 0: never"));
    table.push_back(paper(flag("scheme.split", true, "split particles whose domain grows too long"), false));
    table.push_back(paper(flag("scheme.merge", true, "merge particles where convergence crowds them"), false));
    table.push_back(paper(
        flag("scheme.reset_domains", true, "give a strongly sheared particle a rectangular domain again"), false));
    table.push_back(
        flag("scheme.sleep", true, "skip material at rest until something stirs it; the results are the same"));
    table.push_back(fast(number("scheme.split_length", "cells", above_to(0.0, 2.0), 0.8,
                                "edge of a particle's domain that makes it split"),
                         1.0));
    table.push_back(fast(number("scheme.split_min_mass", "1", fraction, 0.02,
                                "no split below this share of the largest mass at the start"),
                         0.1));
    table.push_back(paper(flag("scheme.mass_fit", true,
                               "fit the masses so that a lake, released below one still level, starts at exact rest"),
                          false));
    table.push_back(
        number("scheme.curvature_length", "m", not_negative, 10.0,
               "smoothing of the bed for its curvature and for speeds along it, 14 cells at most; 0: none"));
    table.push_back(number("scheme.strain_rate_floor", "1/s", positive, 1e-3,
                           "strain rate below which the yield stress is regularised"));
    table.push_back(number("scheme.stress_cap", "1", above_to(0.0, 0.5), 0.25,
                           "largest 2 viscosity dt / (density cell^2) in one step; with pic or flip 0.25 at most, with "
                           "linear shapes 0.2"));
    table.push_back(absent(with(number("scheme.still_level", "m", any_number, "known level of a lake at rest (eq. 33)"),
                                "scheme.preset", {"paper"}),
                           "no still level is used"));
}

void add_run(Table& table) {
    table.push_back(
        choice("boundary.sides", {"open", "wall", "mirror"}, "open",
               "open: mass leaves and is counted; wall: it is held back; mirror: a plane of symmetry, such as the "
               "middle of a half model. 3D points can part from a wall, not from a mirror"));
    table.push_back(choice("boundary.holes", {"wall", "open"}, "wall",
                           "nodata inside the terrain: wall: mass is held back; open: it leaves and is counted"));
    table.push_back(required(number("time.end", "s", positive, "simulated time")));
    table.push_back(
        flag("time.stop_at_rest", false,
             "stop when what still moves can change the deposit no more: a hundredth of the mass at most is "
             "faster than two cells in the time so far, and no front runs on"));
    table.push_back(number("time.rest_fraction", "1", {0.0, 1.0, true, true}, 0.05,
                           "mean speed, as a share of its peak, above which nothing is taken for rest"));
    table.push_back(number("output.every", "s", at_least(1e-9), 1.0,
                           "time between frames, which are hit exactly; peaks and "
                           "arrival in a frame are those of the run's own steps until then"));
    Parameter formats = make("output.formats", Kind::words, "", "what is written");
    formats.choices = {"vtk", "xdmf", "geotiff", "png", "web", "netcdf"};
    formats.may_be_empty = true;
    formats.fallback = std::vector<std::string>{"vtk", "geotiff", "png"};
    table.push_back(formats);
    Parameter fields = make("output.fields", Kind::words_or_all, "", "quantities in the frames");
    fields.choices = {"depth",          "thickness",        "velocity",      "speed",
                      "stress",         "effective_stress", "surface",       "elevation",
                      "mass",           "volume",           "pressure",      "id",
                      "peak_depth",     "peak_speed",       "peak_pressure", "peak_dynamic_pressure",
                      "arrival_time",   "damage",           "cohesion",      "water_depth",
                      "water_velocity", "water_speed",      "bed_change",    "eroded_depth",
                      "deposited_depth"};
    fields.fallback = std::vector<std::string>{};
    table.push_back(fields);
    table.push_back(choice("output.film", {"none", "mp4", "gif"}, "none",
                           "film of the depth, and of 3D points, at the output times, from the frames of "
                           "format vtk; needs the program ffmpeg"));
    table.push_back(number("output.footprint_depth", "m", positive, 0.1, "deeper than this counts as covered"));
    table.push_back(choice("output.history", {"step", "output"}, "step", "history.csv has a line per step or frame"));
    table.push_back(
        choice("output.extent", {"flow", "terrain"}, "flow",
               "of rasters and frames. flow: where the terrain goes on far beyond the releases (by more than "
               "512 cells), the part that particles alone reach; terrain: all of it, which is then held as well"));
    table.push_back(number("output.checkpoint_minutes", "min", not_negative, 10.0,
                           "wall time between two checkpoint.h5; 0: one when the run ends or is interrupted"));
    table.push_back(required(make("profile.name", Kind::name, "", "name of the profile's file and figure")));
    Parameter line = make("profile.line", Kind::points, "m", "the profile's line: [[x, y], [x, y], ...]");
    line.length = 2;
    table.push_back(required(line));
    table.push_back(required(make("gauge.name", Kind::name, "", "name of the gauge's file")));
    Parameter point = make("gauge.point", Kind::numbers, "m", "where the gauge stands: [x, y]");
    point.length = 2;
    table.push_back(required(point));
    table.push_back(required(make("section.name", Kind::name, "", "name of the section's file")));
    Parameter through =
        make("section.line", Kind::points_or_path, "m",
             "line through which the discharge is recorded, down the slope as positive: [[x, y], [x, y], ...], or a "
             "vector file of one line");
    through.length = 2;
    table.push_back(required(through));
    add_barriers(table);
    add_stages(table);
    add_insitu(table);
    add_survey(table);
}

Table make_table() {
    Table table;
    add_terrain(table);
    add_release(table);
    add_inflow(table);
    add_material(table);
    add_scheme(table);
    add_run(table);
    return table;
}

}  // namespace

const std::vector<Parameter>& parameters() {
    static const Table table = make_table();
    return table;
}

const std::vector<std::string>& repeated_tables() {
    static const std::vector<std::string> names = {"release", "inflow",  "material.zone", "profile", "gauge",
                                                   "section", "barrier", "stage",         "insitu",  "camera"};
    return names;
}

std::string repeated_table_of(const std::string& key) {
    for (const std::string& name : repeated_tables())
        if (key.compare(0, name.size() + 1, name + ".") == 0) return name;
    return {};
}

}  // namespace frana
