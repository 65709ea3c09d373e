// `frana check`: the whole scene, built but not run.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <optional>
#include <type_traits>

#include "base/free_memory.h"
#include "compare/deposit.h"
#include "compare/expected_width.h"
#include "compare/flow_width.h"
#include "compare/runout.h"
#include "frana_check.h"
#include "frana_check_stage.h"
#include "frana_commands.h"
#include "io/gdal_reader.h"
#include "run/folder/run_insitu.h"
#include "run/folder/run_page.h"
#include "run/simulation.h"
#include "scene/bed_over.h"
#include "scene/flow_start.h"
#include "scene/inflow_facts.h"
#include "scene/memory_need.h"
#include "shallow/feed.h"
#include "terrain/part_of.h"
#include "vtk_io/barrier_mesh.h"

namespace frana {
namespace {

/// Assumptions of the forecast, said in its text.
constexpr double seconds_per_particle_step = 150e-9;  ///< whole step on one core

constexpr double seconds_per_point_step = 300e-9;  ///< of 3D points
/// Of those with faces of barriers near: 650 in cases/barrier_hill, 940 in cases/wall, which has few points.
constexpr double seconds_per_point_step_at_barriers = 700e-9;
/// Of those thinner than a cell: 1280 in an avalanche of 0.1 cells at a dam, 1400 in one of 0.2.
constexpr double seconds_per_point_step_when_thin = 1300e-9;

constexpr double seconds_per_cell_step = 100e-9;  ///< of cells of free water
constexpr double kWaterCfl = 0.45;                ///< part of a cell that its waves pass in a step

/// Free water is all that there is. It is on cells, and what is released and comes in has no particles.
bool water_alone(const Scene& scene) { return scene.water && !scene.structure; }

std::string crs_name(const std::string& wkt) {
    const std::size_t begin = wkt.find('"');
    if (begin == std::string::npos) return "unknown";
    return wkt.substr(begin + 1, wkt.find('"', begin + 1) - begin - 1);
}

std::string grid_text(const Scene& scene) {
    const GridGeometry& part = scene.bed.geometry;
    const GridGeometry& grid = scene.wider ? scene.wider->grid : part;
    const auto e = grid.pixel_extent();
    double low = INFINITY;
    double high = -INFINITY;
    for (const double z : scene.bed.values) {
        if (std::isnan(z)) continue;
        low = std::min(low, z);
        high = std::max(high, z);
    }
    std::string text = fmt::format("grid        {} x {} nodes, {} m apart\n", grid.nx, grid.ny, grid.cell);
    text += fmt::format("            x {:.10g} to {:.10g}, y {:.10g} to {:.10g}", e[0], e[2], e[1], e[3]);
    if (scene.wider)
        text += fmt::format("\n            of them {} x {} around the releases to begin with", part.nx, part.ny);
    text += fmt::format(", elevation {:.6g} to {:.6g} m\n", low, high);
    return text + fmt::format("            CRS {}\n", crs_name(scene.bed.crs_wkt));
}

std::string release_text(const ReleaseSummary& release) {
    const ReleaseReport& r = release.report;
    std::string text = fmt::format("{}\n", release.name);
    text += fmt::format("            {} particles on {:.6g} m2, depth up to {:.4g} m\n", r.count, r.area,
                        release.max_depth);
    text +=
        fmt::format("            volume {:.9g} m3 from raster or polygon, {:.9g} m3 in particles, difference {:.1e}\n",
                    r.volume, r.particle_volume, r.relative_error);
    const char* cut = release.included_in_dem ? ", and is cut out of the bed then" : "";
    if (release.at > 0.0) text += fmt::format("            enters at {:.6g} s{}\n", release.at, cut);
    if (release.when_hit) text += fmt::format("            enters when the flow reaches it{}\n", cut);
    return text + fmt::format("            bed slope {:.1f} to {:.1f} degrees, {:.1f} on average\n",
                              release.slope_min_deg, release.slope_max_deg, release.slope_mean_deg);
}

/// Also of those that enter later.
Index particles_of(const Scene& scene) {
    Index count = 0;
    for (const Seeds* seeds : scene.all_particles()) count += seeds->count();
    return count;
}

std::string total_text(const BuiltScene& built) {
    double volume = 0.0;
    double particle_volume = 0.0;
    for (const ReleaseSummary& release : built.releases) {
        volume += release.report.volume;
        particle_volume += release.report.particle_volume;
    }
    const auto& water = built.scene.water;
    const double density =
        water ? (1.0 - water->share) * built.scene.density + water->share * water->exchange.material.fluid_density
              : built.scene.density;
    if (water_alone(built.scene))
        return fmt::format("total       {:.9g} m3 of water in releases, of {:.9g} m3\n", particle_volume, volume);
    std::string text = fmt::format("total       {} particles, {:.9g} m3 of {:.9g} m3, {:.6g} kg\n",
                                   particles_of(built.scene), particle_volume, volume, particle_volume * density);
    if (!built.scene.inflows.empty())
        text += fmt::format("            and {:.0f} that come in by the end, at most\n",
                            Feed(built.scene.inflows).outlook(built.scene.end).particles);
    return text;
}

struct Forecast {
    double fewest_steps = 0.0;      ///< at the speeds of the start
    double most_steps = 0.0;        ///< at free-fall speed all the time
    double fall_speed = 0.0;        ///< [m/s]
    double particle_seconds = 0.0;  ///< sum of the times that particles are in the flow, or cells may be [s]
};

/// All material for a forecast, at once or later.
struct Start {
    double lowest = INFINITY, top = -INFINITY;  ///< of the terrain, of the material's surface [m]
    double speed = 0.0, depth = 0.0;            ///< largest [m/s], [m]
    double particle_seconds = 0.0;

    void add(const Raster& bed, double x, double y, double depth_here) {
        const GridGeometry& grid = bed.geometry;
        const auto i = std::clamp<Index>(std::lround((x - grid.x0) / grid.cell), 0, grid.nx - 1);
        const auto j = std::clamp<Index>(std::lround((y - grid.y0) / grid.cell), 0, grid.ny - 1);
        depth = std::max(depth, depth_here);
        if (!std::isnan(bed.at(i, j))) top = std::max(top, bed.at(i, j) + depth_here);
    }
};

/// A lake, and what comes in at its line; every cell may be wet all the time.
void add_water(const Scene& scene, Start& start) {
    const GridGeometry& g = scene.bed.geometry;
    const WaterPhase& water = *scene.water;
    for (Index k = 0; water.level && k < g.size(); ++k)
        if (water.lake.empty() || water.lake[static_cast<std::size_t>(k)])
            start.add(scene.bed, g.x(k % g.nx), g.y(k / g.nx),
                      std::max(0.0, *water.level - scene.bed.values[static_cast<std::size_t>(k)]));
    for (const Inflow& inflow : scene.inflows) {
        const InflowFacts facts = facts_of(inflow, scene.gravity);
        start.speed = std::max(start.speed, facts.speed);
        for (const Vec2& place : inflow.line) start.add(scene.bed, place.x(), place.y(), facts.thickness);
        for (const Inflow::Patch& patch : inflow.patches) start.add(scene.bed, patch.at.x(), patch.at.y(), 0.0);
    }
    start.particle_seconds = static_cast<double>(g.size()) * scene.end;
}

Start start_of(const Scene& scene) {
    Start start;
    for (const double z : scene.bed.values)
        if (!std::isnan(z)) start.lowest = std::min(start.lowest, z);
    start.top = start.lowest;
    for (const Seeds* seeds : scene.all_particles())
        for (std::size_t p = 0; p < seeds->x.size(); ++p) {
            start.add(scene.bed, seeds->x[p], seeds->y[p], seeds->depth[p]);
            start.speed = std::max(start.speed, std::hypot(seeds->vx[p], seeds->vy[p]));
        }
    start.particle_seconds = static_cast<double>(particles_of(scene)) * scene.end;
    for (const LateRelease& late : scene.late)  // when the flow reaches one is not known
        start.particle_seconds -= static_cast<double>(late.seeds.count()) * std::min(late.at.value_or(0.0), scene.end);
    if (water_alone(scene)) {
        add_water(scene, start);
        return start;
    }
    const Feed::Outlook inflow = Feed(scene.inflows).outlook(scene.end);
    for (const Vec2& place : inflow.from) start.add(scene.bed, place.x(), place.y(), inflow.depth);
    start.speed = std::max(start.speed, inflow.speed);
    start.particle_seconds += inflow.particle_seconds;
    return start;
}

Forecast forecast(const Scene& scene) {
    const Start start = start_of(scene);
    Forecast result;
    double wave = std::sqrt(scene.gravity * start.depth);
    if (scene.structure) wave += StructuredLaw(scene.structure->material).sound_speed(scene.density);
    result.fall_speed = std::sqrt(start.speed * start.speed + 2.0 * scene.gravity * (start.top - start.lowest));
    const double cfl = scene.structure ? scene.structure->cfl : water_alone(scene) ? kWaterCfl : scene.scheme.cfl;
    const double reach = cfl * scene.bed.geometry.cell;
    result.fewest_steps = std::ceil(scene.end * (start.speed + wave) / reach);
    result.most_steps = std::ceil(scene.end * (result.fall_speed + wave) / reach);
    if (scene.water && scene.water->viscosity.kinematic > 0.0) {
        const double viscous = scene.end / viscous_step(scene.water->viscosity, scene.bed.geometry.cell);
        result.fewest_steps = std::max(result.fewest_steps, std::ceil(viscous));
        result.most_steps = std::max(result.most_steps, result.fewest_steps);
    }
    result.particle_seconds = start.particle_seconds;
    return result;
}

/// How many cells will lie across the flow, with a remark where they are too few.
std::string width_text(const Scene& scene) {
    const ExpectedWidth expected = expected_width(scene.bed, scene.particles, friction_at_rest(scene.bed_law));
    const double cell = scene.bed.geometry.cell;
    if (!std::isfinite(expected.width)) return "";
    std::string text = fmt::format(
        "width       about {:.3g} m, {:.2g} cells, from the release ({:.3g} m across) and the valley below; a run "
        "measures it\n",
        expected.width, expected.width / cell, expected.release);
    const std::string remark = width_remark(expected.width, cell, scene.structure || !scene.water);
    return remark.empty() ? text : text + fmt::format("remark      by the estimate {}\n", remark);
}

/// Length of a path over loose material, along the map [m].
double loose_way(const Polyline& path, const Raster& loose) {
    const GridGeometry& g = loose.geometry;
    double way = 0.0;
    for (std::size_t k = 0; k + 1 < path.size(); ++k) {
        const Vec2 middle = 0.5 * (path[k] + path[k + 1]);
        const auto i = static_cast<Index>(std::lround((middle.x() - g.x0) / g.cell)),
                   j = static_cast<Index>(std::lround((middle.y() - g.y0) / g.cell));
        if (i >= 0 && j >= 0 && i < g.nx && j < g.ny && loose.at(i, j) > 0.0) way += (path[k + 1] - path[k]).norm();
    }
    return way;
}

/// The same of the steepest path from a place to the edge of the terrain. Where memory has no room for that, it is the
/// part that the scene holds.
double loose_way(const Scene& scene, const Vec2& start) {
    constexpr double kBytesPerNode = 40.0;  // elevations, and the queue of a search from the edge inwards
    const WiderTerrain* wider = scene.wider.get();
    if (wider == nullptr || kBytesPerNode * static_cast<double>(wider->grid.size()) > free_memory())
        return loose_way(steepest_path(scene.bed, start), scene.erodible->depth);
    const Raster bed = bed_over(scene.bed, wider, wider->grid);
    const Polyline path = steepest_path(bed, start);
    if (path.empty() || !wider->fields) return loose_way(path, scene.erodible->depth);
    const NodeBox along = common(cells_of(path, wider->grid), NodeBox::all(wider->grid));
    return loose_way(path, wider->fields(part_of(bed, along)).loose);
}

/// Loose material on all of the terrain [m3]; nothing where memory does not allow to read it.
std::optional<double> loose_volume(const Scene& scene) {
    constexpr double kBytesPerNode = 64.0;  // elevations, and what is read on them
    const WiderTerrain* wider = scene.wider.get();
    if (wider == nullptr) return volume_of(scene.erodible->depth);
    if (!wider->fields || kBytesPerNode * static_cast<double>(wider->grid.size()) > free_memory()) return {};
    return volume_of(wider->fields(bed_over(scene.bed, wider, wider->grid)).loose);
}

/// Growth of a flow that takes up its bed in proportion to its way, on the steepest path over loose material, up to the
/// terrain's edge.
/// There is a remark where that is more than a hundredfold.
std::string growth_text(const BuiltScene& built) {
    constexpr double kHundredfold = 100.0, kMost = 1e12;  // more than the largest landslides, whatever the number [m3]
    const Scene& scene = built.scene;
    const auto* law = scene.erodible ? std::get_if<erosion::Growth>(&scene.erodible->law) : nullptr;
    const std::optional<Vec2> start = law ? flow_start(scene) : std::nullopt;
    if (!start) return "";
    const double way = loose_way(scene, *start);
    double volume = 0.0;
    for (const ReleaseSummary& release : built.releases) volume += release.report.volume;
    for (const Inflow& inflow : scene.inflows) volume += facts_of(inflow, scene.gravity).volume;
    const double factor = std::exp(law->growth * way);
    if (!(factor > kHundredfold)) return "";
    const double grown = volume * factor;
    const std::optional<double> loose = loose_volume(scene);
    const bool beyond = loose && (grown - volume) * scene.density > *loose * scene.erodible->density;
    const std::string limit = beyond ? fmt::format(", though there are only {:.4g} m3 of it", *loose) : "";
    return fmt::format(
        "remark      erodible.growth: found {:.4g} /m, by which {:.4g} m3 would become {} over {:.4g} m of loose "
        "material on the steepest path{}; expected growth to {:g} times at most; give a smaller one\n",
        law->growth, volume, grown < kMost ? fmt::format("{:.3g} m3", grown) : fmt::format("{:g} m3 or more", kMost),
        way, limit, kHundredfold);
}

std::string seconds_text(double seconds) {
    if (seconds < 120.0) return fmt::format("{:.2g} s", seconds);
    return seconds < 7200.0 ? fmt::format("{:.0f} min", seconds / 60.0) : fmt::format("{:.1f} h", seconds / 3600.0);
}

std::string stage_text(const Scene& scene) {
    const SolidStage& stage = *scene.solid;
    const StageForecast f = forecast_stage(scene);
    const double each = f.thin                   ? seconds_per_point_step_when_thin
                        : scene.barriers.empty() ? seconds_per_point_step
                                                 : seconds_per_point_step_at_barriers;
    return fmt::format(
        "stage       3D points from {:.6g} s to {:.6g} s, about {:.3g} of them if all of the flow is there at once, "
        "{:.3g} MB; about {:.0f} steps with sound at {:.3g} m/s and flow at {:.3g} m/s, {} on one core, assuming "
        "{:.0f} ns per point and step\n",
        stage.from, stage.until.value_or(scene.end), f.points, f.points * bytes_per_point / 1e6, f.steps, f.sound_speed,
        f.speed, seconds_text(f.steps * f.points * each), each * 1e9);
}

/// How many frames a run of the whole time leaves, and about how large they are. There is a remark where they are many.
std::string frames_text(const Scene& scene) {
    constexpr double kMany = 3000.0;
    constexpr double kParticle = 120.0, kNode = 25.0;  // bytes, compressed; measured
    const double frames = std::ceil(scene.end / scene.output.every - 1e-9) + 1.0;
    const double formats = (scene.output.vtk ? 1.0 : 0.0) + (scene.output.xdmf ? 1.0 : 0.0);
    const double bytes =
        frames * formats *
        (kParticle * static_cast<double>(particles_of(scene)) + kNode * static_cast<double>(scene.bed.geometry.size()));
    const std::string size = bytes > 0.0 ? fmt::format(", about {:.2g} MB", bytes / 1e6) : "";
    std::string text = fmt::format("frames      {:.0f}{}\n", frames, size);
    if (frames > kMany)
        text += fmt::format(
            "remark      output.every: found {:.0f} frames{}; expected {:.0f} at most; give a longer time "
            "between them\n",
            frames, size, kMany);
    return text;
}

std::string forecast_text(const Scene& scene) {
    const Forecast f = forecast(scene);
    const bool water = water_alone(scene);
    const double each = water ? seconds_per_cell_step : seconds_per_particle_step;
    const double per_step = scene.end > 0.0 ? f.particle_seconds / scene.end * each : 0.0;
    std::string text =
        fmt::format("steps       {:.0f} (as fast as at the start) to {:.0f} (in free fall, {:.3g} m/s), for {} s\n",
                    f.fewest_steps, f.most_steps, f.fall_speed, scene.end);
    text += fmt::format("memory      about {:.3g} MB{}\n", memory_need(scene).total() / 1e6,
                        water ? "" : ", as long as particles do not split");
    return text + fmt::format("time        {} to {} on one core, assuming {:.0f} ns per {} and step, output apart\n",
                              seconds_text(f.fewest_steps * per_step), seconds_text(f.most_steps * per_step),
                              each * 1e9, water ? "cell, were all of them wet," : "particle");
}

/// A line for each barrier, or one for many.
std::string barriers_text(const Scene& scene) {
    constexpr std::size_t kFew = 24;
    if (scene.barriers.size() > kFew) {
        double lowest = INFINITY, highest = 0.0;
        for (const Barrier& barrier : scene.barriers)
            if (!barrier.top && !barrier.shape)
                lowest = std::min(lowest, barrier.height), highest = std::max(highest, barrier.height);
        std::string text = fmt::format("barriers    {}", scene.barriers.size());
        if (highest > 0.0) text += fmt::format(", {:.6g} to {:.6g} m high", lowest, highest);
        return text + '\n';
    }
    std::string text;
    for (const Barrier& barrier : scene.barriers)
        text += barrier.shape ? fmt::format("barrier     {}, a mesh\n", barrier.name)
                : barrier.top ? fmt::format("barrier     {}, up to {:.6g} m\n", barrier.name, *barrier.top)
                              : fmt::format("barrier     {}, {:.6g} m high\n", barrier.name, barrier.height);
    return text;
}

}  // namespace

std::string told_of(const BuiltScene& built) {
    std::string text = fmt::format("case        {}\n", built.scene.title) + grid_text(built.scene);
    for (const ReleaseSummary& release : built.releases) text += release_text(release);
    text += total_text(built) + width_text(built.scene) + growth_text(built) + forecast_text(built.scene) +
            frames_text(built.scene);
    if (built.scene.friction)
        for (const FrictionPart& part : built.scene.friction->parts)
            text += fmt::format("friction    {}{}: {}\n", part.name, built.scene.wider ? ", around the releases" : "",
                                friction_sentence(part));
    text += barriers_text(built.scene);
    if (built.scene.solid) text += stage_text(built.scene);
    check_insitu(built.scene);
    for (const Insitu& entry : built.scene.insitu)
        text += fmt::format("in situ     {} \"{}\"\n", kind_word(entry.kind), entry.name);
    for (const std::string& remark : built.scene.log) text += "remark      " + remark + '\n';
    for (const std::string& remark : remarks_on_barriers(built.scene)) text += "remark      " + remark + '\n';
    return text + "ready to run\n";
}

int check_command(const CheckOptions& options) {
    const CaseFile file = CaseFile::read(options.case_file, options.sets);
    const MeshReader meshes = barrier_meshes_told([](const std::string& line) { std::cerr << line << std::endl; });
    const BuiltScene built = build_scene_in_detail(file, GdalReader(), meshes);
    check_page(file);
    std::cout << told_of(built);
    return 0;
}

}  // namespace frana
