#include "run/folder/run_job.h"

#include <fmt/core.h>
#include <omp.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <optional>

#include "base/atomic_file.h"
#include "base/error.h"
#include "compare/flow_width.h"
#include "io/gdal_writer.h"
#include "io/netcdf_series.h"
#include "io/xdmf_writer.h"
#include "observe/gauges.h"
#include "observe/history.h"
#include "observe/only_fields.h"
#include "observe/profiles.h"
#include "observe/sections.h"
#include "observe/side_by_side.h"
#include "run/end_remarks.h"
#include "run/folder/comparison.h"
#include "run/folder/cutoff.h"
#include "run/folder/gis_files.h"
#include "run/folder/left_terrain.h"
#include "run/folder/run_3d.h"
#include "run/folder/run_figures.h"
#include "run/folder/run_film.h"
#include "run/folder/run_folder.h"
#include "run/folder/run_insitu.h"
#include "run/folder/run_page.h"
#include "run/folder/section_ends.h"
#include "run/folder/states.h"
#include "run/simulation.h"
#include "scene/remarks.h"
#include "scene/taken_of_bed.h"
#include "terrain/part_of.h"
#include "vtk_io/survey_vtp.h"
#include "vtk_io/writers.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

/// Work after the time loop, counted as output of the run.
template <class Work>
void timed(RunSummary& summary, const char* name, const Work& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    summary.output.push_back({name, seconds});
    summary.wall_seconds += seconds;
    summary.ended = utc_now();
}

double largest(const std::vector<ProductRaster>& rasters, const char* name) {
    double result = 0.0;
    if (const ProductRaster* product = find_product(rasters, name))
        for (const double value : product->raster.values)
            if (value > result) result = value;
    return result;
}

/// The flow's width, and a remark where too few cells lie across it.
void note_width(RunRecord& record, const Raster& covered) {
    record.flow_width = flow_width(covered, record.footprint_depth);
    const std::string remark = width_remark(record.flow_width, record.grid.cell, !record.of_water_alone());
    if (!remark.empty()) record.warnings.push_back(remark);
}

/// Where the 3D stage or the run ends too early for the largest forces. At rest there is nothing to wait for.
void note_rising_forces(RunRecord& record, const Scene& scene) {
    if (!scene.solid) return;
    const double last = record.summary.last.time, until = scene.solid->until.value_or(INFINITY);
    if (until > last && record.summary.reason == "rest") return;
    const ForcesEnd end = until <= last ? ForcesEnd{until, "the 3D stage ends", "stage.until"}
                                        : ForcesEnd{last, "the run ends", "time.end"};
    for (std::string& remark : remarks_on_rising(record.barriers, end)) record.warnings.push_back(std::move(remark));
}

void note_simulation(RunRecord& record, const Scene& scene, const Simulation& simulation) {
    record.extras = simulation.extras();
    if (record.extras.inflow && scene.inflows.size() == 1)
        record.inflow_until = time_of(scene.inflows.front(), record.extras.inflow->expected);
    for (EndRemark& remark : remarks_at_end(simulation, record.summary))
        record.warnings.push_back(std::move(remark.text));
    note_rising_forces(record, scene);
    if (const Friction* used = simulation.friction()) record.friction = used->parts, record.friction_of_part = true;
    if (!record.extras.water || record.of_water_alone())  // of which the scene's particles tell a part only
        record.release_volume = (record.summary.first.mass - record.summary.first.mass_in) / scene.density;
    const bool has_lake = scene.water && scene.water->level;
    if (!has_lake) record.volume_of_releases = record.release_volume;
}

void note_results(RunRecord& record, const std::vector<ProductRaster>& rasters) {
    if (const std::optional<Raster> covered = ever_covered(rasters)) {
        record.footprint_area = area_deeper(*covered, record.footprint_depth);
        note_width(record, *covered);
    }
    record.peak_depth = largest(rasters, "peak_depth");
    record.peak_speed = largest(rasters, "peak_speed");
    record.peak_pressure = largest(rasters, "peak_pressure");
    record.peak_dynamic_pressure = largest(rasters, "peak_dynamic_pressure");
    if (const std::optional<Raster> solids = solids_at_end(rasters)) {
        for (const double depth : solids->values)
            if (depth > record.final_flow_depth) record.final_flow_depth = depth;
        record.final_depth = std::max(record.final_flow_depth, largest(rasters, "lying_depth"));
    }
}

void note_section_ends(RunRecord& record, const Scene& scene, const std::vector<ProductRaster>& rasters) {
    const ProductRaster* const peak = find_product(rasters, "peak_depth");
    if (peak == nullptr) return;
    for (std::string& remark : remarks_on_ends(scene.sections, peak->raster, record.footprint_depth))
        record.warnings.push_back(std::move(remark));
}

void note_taken(RunRecord& record, const Scene& scene, const std::vector<ProductRaster>& rasters) {
    if (const ProductRaster* eroded = find_product(rasters, "eroded_depth"))
        record.taken_of_bed = taken_of_bed(scene, eroded->raster.geometry, eroded->raster.values);
}

/// The first of the remarks: it says what the figures of the run are worth.
void note_left(RunRecord& record) {
    if (std::string remark = remark_on_left(record); !remark.empty())
        record.warnings.insert(record.warnings.begin(), std::move(remark));
}

/// footprint.geojson of a CRS without a code is in degrees or, where there is no way to them, looks so.
void remark_on_unnamed_crs(const Raster& covered, bool has_layers, RunRecord& record) {
    if (covered.crs_wkt.empty()) return;
    const FootprintPlace place = footprint_place(covered.crs_wkt);
    if (place == FootprintPlace::degrees)
        record.warnings.push_back(
            "footprint.geojson: found a CRS without an EPSG code, which GeoJSON cannot name; it is in longitude and "
            "latitude (WGS 84)");
    if (place != FootprintPlace::unnamed) return;
    record.warnings.push_back(fmt::format(
        "footprint.geojson: found a CRS without an EPSG code, which GeoJSON cannot name, so that a GIS takes "
        "its coordinates for degrees; expected those of the elevation model's CRS; {}give the layer that CRS "
        "in the GIS",
        has_layers ? "open results.gpkg, which names it, or " : ""));
}

/// compare.json, when the case gives a survey. The run is worth more than its scores: trouble is a warning.
void compare_with_survey(const Scene& scene, const Raster& bed, const fs::path& run_dir,
                         const std::vector<ProductRaster>& rasters, RunRecord& record) {
    if (!scene.survey || find_product(rasters, "peak_depth") == nullptr) return;
    try {
        const Raster& peak = find_product(rasters, "peak_depth")->raster;
        SurveyFiles others = record.survey_files;
        others.footprint.clear();  // was read with the scene
        Survey survey = read_survey_files(others, peak, record.warnings);
        survey.footprint = *scene.survey;
        const std::optional<Raster> later = released_later_on(record.release_sources, record.extras.late, peak);
        Comparison comparison = compare_rasters(rasters, &bed, scene.output.footprint_depth, survey, record.starts,
                                                later ? &*later : nullptr);
        if (!record.of_water_alone()) remark_on_left(left_share(record), comparison);
        write_scores(run_dir, run_dir / "compare.json", comparison);
        if (scene.output.vtk)
            write_survey(run_dir, bed, *ever_covered(rasters), comparison.limit, rings_of(survey.footprint));
        record.comparison = std::move(comparison);
    } catch (const UserError& error) {
        record.warnings.push_back(fmt::format("the run was not compared with the survey: {}", error.what()));
    }
}

/// When the flow came to barriers that no force is known of, and barriers.csv. Trouble is a warning here as well.
void leave_barrier_table(const Scene& scene, const Raster& bed, const fs::path& run_dir,
                         const std::vector<ProductRaster>& rasters, RunRecord& record) {
    if (scene.barriers.empty()) return;
    record.barrier_hits = hits_on(scene.barriers, rasters, &bed);
    note_contacts(record.barrier_hits, record.barriers);
    try {
        write_barrier_table(run_dir / "barriers.csv", record.barriers, record.barrier_hits);
    } catch (const UserError& error) {
        record.warnings.push_back(fmt::format("the table of the barriers was not written: {}", error.what()));
    }
}

/// states/, when there are files for them to show. Trouble is a warning here as well.
void leave_states(const Scene& scene, const fs::path& run_dir, RunRecord& record) {
    if (!scene.output.vtk) return;
    try {
        write_states(run_dir, record.title);
    } catch (const UserError& error) {
        record.warnings.push_back(fmt::format("the ParaView states were not written: {}", error.what()));
    }
}

/// Of all barriers, in the case's order. One that was given as a mesh is as high as that.
std::vector<BarrierTop> tops_of(const Scene& scene) {
    constexpr double kNowhere = 1e300;
    std::vector<BarrierTop> tops;
    for (const Barrier& barrier : scene.barriers)
        tops.push_back(barrier.shape ? BarrierTop{kNowhere, 0.0} : BarrierTop{barrier.top, barrier.height});
    return tops;
}

FigureSource figure_source(const Scene& scene, const Raster& bed, const fs::path& run_dir, const RunRecord& record,
                           const std::vector<ProductRaster>& rasters) {
    FigureSource source;
    source.run_dir = run_dir;
    source.title = record.title;
    source.footer = record.caption;
    source.date = record.summary.started.substr(0, 10);
    source.bed = bed;
    source.rasters = rasters;
    source.footprint_depth = scene.output.footprint_depth;
    source.survey = scene.survey;
    if (record.comparison) source.runout_paths = paths_of(*record.comparison);
    source.profiles = scene.profiles;
    source.gauges = scene.gauges;
    source.sections = scene.sections;
    source.inflows = record.inflows;
    source.front_origin = record.front_origin;
    for (const BarrierSummary& barrier : record.barriers) {
        if (!was_hit(barrier)) source.never_hit.push_back(barrier.name);
        if (barrier.blur > 0.0) source.mean_over[barrier.name] = barrier.blur;
    }
    source.in_3d = scene.solid.has_value();
    source.barrier_tops = tops_of(scene);
    source.barriers = scene.barriers;
    source.density = scene.density;
    return source;
}

/// Forest::pressure on that ground. Nothing without a forest, or where its files have gone.
Raster trees_on(const Scene& scene, const Raster& ground) {
    if (!scene.forest) return {};
    if (scene.forest->pressure.geometry == ground.geometry) return scene.forest->pressure;
    if (!scene.wider || !scene.wider->fields) return {};
    try {
        return scene.wider->fields(ground).trees;
    } catch (const UserError&) {
        return {};  // the run has what it read before
    }
}

/// The terrain that rasters and frames show: the scene's, or the part of it that the flow has reached.
Raster shown_bed(const Scene& scene, const Simulation& simulation, const std::vector<ProductRaster>& rasters) {
    const Raster* const ground = simulation.ground();
    if (ground == nullptr || rasters.empty()) return scene.bed;
    return part_of(*ground, box_of(rasters.front().raster.geometry, ground->geometry).value());
}

/// Friction and forest as the run used them, where rasters show the terrain.
void add_friction(const Scene& scene, const Simulation& simulation, std::vector<ProductRaster>& rasters) {
    const Friction* const used = simulation.friction() != nullptr ? simulation.friction() : scene.friction.get();
    const Raster& ground = simulation.ground() != nullptr ? *simulation.ground() : scene.bed;
    std::vector<ProductRaster> all;
    if (used != nullptr) all = friction_rasters(*used, ground);
    if (auto forest = forest_raster(trees_on(scene, ground), ground)) all.push_back(std::move(*forest));
    if (all.empty()) return;
    const GridGeometry shown = shown_bed(scene, simulation, rasters).geometry;
    for (ProductRaster& product : all) {
        if (!(shown == ground.geometry))
            product.raster = part_of(product.raster, box_of(shown, ground.geometry).value());
        rasters.push_back(std::move(product));
    }
}

void close_record(RunRecord& record, const fs::path& run_dir) {
    join_remarks_on_coordinates(record.warnings);
    write_text(run_dir / "report.md", report_markdown(record, run_dir));
    record.files = files_made(run_dir);
    write_text(run_dir / "run.json", run_json(record));  // last: until then it says which files are not the run's
}

/// Where the address space is limited, writers that allocate room beforehand do so one after the other.
int threads_for_files() {
    rlimit limit{};
    const bool known = getrlimit(RLIMIT_AS, &limit) == 0;
    return known && limit.rlim_cur == RLIM_INFINITY ? omp_get_max_threads() : 1;
}

/// Of one phase all is solid, except with a bed law that has the share of grains. Where that varies spatially it is the
/// mean along the line: material has the share of the ground that it is on.
double solid_share(const Scene& scene, const Polyline& line) {
    const auto* granular = std::get_if<bed::Pouliquen>(&scene.bed_law);
    if (!granular) return 1.0;
    if (!scene.bed_laws()) return granular->solid_fraction;
    const std::vector<Station> places = stations(line, 0.5 * scene.bed.geometry.cell);
    double sum = 0.0;
    for (const Station& station : places)
        sum += std::get<bed::Pouliquen>(bed_law_at(scene, station.point)).solid_fraction;
    return sum / static_cast<double>(places.size());
}

/// What passes the sections of the scene; nothing without any.
std::unique_ptr<Observer> make_sections(const Scene& scene, const fs::path& run_dir,
                                        std::vector<SectionSummary>& summaries) {
    std::vector<SectionLine> lines;
    const GridGeometry& terrain = scene.wider ? scene.wider->grid : scene.bed.geometry;
    for (const Section& section : scene.sections)
        lines.push_back(
            {section.name, section.line, section.to_right, terrain.pixel_extent(), solid_share(scene, section.line)});
    if (lines.empty()) return {};
    return std::make_unique<Sections>(run_dir, lines, 0.5 * scene.bed.geometry.cell, summaries);
}

void note_cutoff(RunRecord& record, const fs::path& run_dir) {
    record.pictures_cut_off = true;
    record.warnings.push_back(
        fmt::format("interrupted while pictures were drawn; `frana figures {}` draws all of them", run_dir.string()));
}

/// The pictures of the case. A request to end meanwhile leaves a whole run with fewer of them. Where the run does not
/// own the signals they go on to their owner.
void draw(const FigureSource& source, const Output& output, const FlowFrames& frames, const Interrupt& interrupt,
          Progress& progress, RunRecord& record) {
    const fs::path& run_dir = source.run_dir;
    std::optional<Cutoff> cutoff;
    if (interrupt.listens())
        cutoff.emplace([&run_dir, without = record]() mutable {
            remove_half_written(run_dir);
            note_cutoff(without, run_dir);
            close_record(without, run_dir);
            std::cerr << cutoff_sentence(run_dir) << std::endl;
        });
    Gallery gallery(run_dir);
    gallery.stop_when([&interrupt] { return interrupt.requested(); });
    if (output.png) add_figures(source, gallery);
    if (record.page) add_page(source, frames, run_json(record), gallery);
    if (!output.film.empty()) {
        add_film(source, output.film, gallery);
        add_film_3d(source, output.film, gallery);
    }
    record.figures = gallery.draw(threads_for_figures(), record.warnings,
                                  [&](std::size_t done, std::size_t all) { progress.pictures(done, all); });
    if (Cutoff::asked()) note_cutoff(record, run_dir);
}

}  // namespace

std::string cutoff_sentence(const fs::path& run_dir) {
    return fmt::format(
        "interrupted while pictures were drawn; all else of the run is in {0}; `frana figures {0}` "
        "draws the pictures",
        run_dir.string());
}

Observers make_observers(const Scene& scene, const fs::path& run_dir, std::vector<BarrierSummary>& barriers,
                         std::vector<ProductRaster>& rasters) {
    const Output& output = scene.output;
    Observers observers;
    const auto lines = output.history_per_step ? History::Lines::per_step : History::Lines::per_output;
    observers.push_back(std::make_unique<History>(run_dir, lines));
    std::vector<GaugePoint> gauges;
    for (const Gauge& gauge : scene.gauges) gauges.push_back({gauge.name, gauge.point});
    if (!gauges.empty()) observers.push_back(std::make_unique<Gauges>(run_dir, gauges));
    std::vector<NamedBarrier> names;
    for (const Barrier& barrier : scene.barriers) names.push_back({barrier.name, barrier.windows});
    if (!names.empty()) observers.push_back(std::make_unique<Barriers>(run_dir, names, barriers));
    std::vector<ProfileLine> profiles;
    for (const Profile& profile : scene.profiles) profiles.push_back({profile.name, profile.line});
    if (!profiles.empty()) observers.push_back(std::make_unique<Profiles>(run_dir, profiles));
    if (output.vtk) {
        std::vector<std::unique_ptr<Observer>> writers;
        writers.push_back(only_fields(make_particle_writer(run_dir), output.fields));
        writers.push_back(only_fields(make_grid_writer(run_dir), output.fields));
        if (!names.empty()) writers.push_back(make_barrier_writer(run_dir, tops_of(scene), scene.bed));
        if (!profiles.empty()) writers.push_back(make_profile_writer(run_dir, profiles));
        observers.push_back(side_by_side("VTK files", std::move(writers), threads_for_files()));
    }
    if (output.xdmf) observers.push_back(only_fields(make_xdmf_writer(run_dir), output.fields));
    observers.push_back(std::make_unique<LastFields>(scene.bed.crs_wkt, rasters));
    return observers;
}

RunPlan plan_of(const Scene& scene, bool cut_short) {
    return {scene.end, scene.output.every, scene.stop_at_rest, cut_short, scene.bed.geometry.cell, scene.rest_fraction};
}

RunRecord carry_out(const Scene& scene, Simulation& simulation, const fs::path& run_dir, RunRecord record,
                    const Interrupt& interrupt, Progress& progress, CheckpointKeeper* keeper, Observers more,
                    std::vector<ProductRaster>* keep_rasters) {
    std::vector<ProductRaster> rasters;
    Observers observers = make_observers(scene, run_dir, record.barriers, rasters);
    if (auto sections = make_sections(scene, run_dir, record.sections)) observers.push_back(std::move(sections));
    if (record.netcdf)
        observers.push_back(
            make_netcdf_writer(run_dir, record.title, scene.bed.crs_wkt, scene.output.fields, record.warnings));
    for (auto& observer : make_insitu(scene, run_dir, record.insitu)) observers.push_back(std::move(observer));
    FlowFrames frames(scene.output.footprint_depth);
    if (record.page) observers.push_back(make_frame_keeper(frames));
    for (auto& observer : more) observers.push_back(std::move(observer));
    if (scene.output.vtk) write_terrain(run_dir, scene.bed);

    progress.expect_after_the_end(expected_drawing_seconds(
        scene, static_cast<Index>(std::ceil(scene.end / scene.output.every)), threads_for_figures()));
    record.summary =
        run(simulation, plan_of(scene, record.end < record.whole_end), observers, interrupt, progress, keeper);
    note_simulation(record, scene, simulation);
    if (keeper) {
        record.checkpoints = keeper->progress();
        for (const std::string& warning : keeper->warnings()) record.warnings.push_back(warning);
    }
    for (const std::string& warning : insitu_warnings(record.insitu)) record.warnings.push_back(warning);
    if (scene.deposition || scene.forest) add_lying_depth(rasters);
    note_results(record, rasters);
    note_section_ends(record, scene, rasters);
    note_taken(record, scene, rasters);
    note_left(record);
    const Raster bed = shown_bed(scene, simulation, rasters);
    add_ground_at_end(rasters, bed, scene.bed_evolves());
    add_friction(scene, simulation, rasters);
    if (scene.output.geotiff && !rasters.empty() && bed.geometry == rasters.front().raster.geometry)
        rasters.push_back(elevation_raster(bed));
    if (scene.output.vtk && scene.wider) write_terrain(run_dir, bed);

    timed(record.summary, "rasters", [&] {
        if (scene.output.geotiff) write_rasters(run_dir, rasters, record.title, threads_for_files());
        if (const std::optional<Raster> covered = ever_covered(rasters)) {
            write_outline(run_dir, *covered, scene.output.footprint_depth);
            remark_on_unnamed_crs(*covered, scene.output.geotiff, record);
        }
        leave_barrier_table(scene, bed, run_dir, rasters, record);
        leave_gis_files(scene, run_dir, rasters, record);
    });
    timed(record.summary, "survey", [&] { compare_with_survey(scene, bed, run_dir, rasters, record); });
    timed(record.summary, "figures", [&] {
        if (!scene.output.png && scene.output.film.empty() && !record.page) return;
        draw(figure_source(scene, bed, run_dir, record, rasters), scene.output, frames, interrupt, progress, record);
    });
    timed(record.summary, "states", [&] { leave_states(scene, run_dir, record); });
    close_record(record, run_dir);
    if (keep_rasters) {  // those that are read back from the folder, too
        if (const ProductRaster* bed_too = find_product(rasters, "elevation"))
            rasters.erase(rasters.begin() + (bed_too - rasters.data()));
        *keep_rasters = std::move(rasters);
    }
    return record;
}

RunRecord carry_out_in_memory(const Scene& scene, Simulation& simulation, RunRecord record, const Interrupt& interrupt,
                              Progress& progress, Observers more, std::vector<ProductRaster>& rasters) {
    Observers observers;
    observers.push_back(std::make_unique<LastFields>(scene.bed.crs_wkt, rasters));
    for (auto& observer : more) observers.push_back(std::move(observer));
    record.summary =
        run(simulation, plan_of(scene, record.end < record.whole_end), observers, interrupt, progress, nullptr);
    note_simulation(record, scene, simulation);
    if (scene.deposition || scene.forest) add_lying_depth(rasters);
    note_results(record, rasters);
    note_taken(record, scene, rasters);
    note_left(record);
    add_ground_at_end(rasters, shown_bed(scene, simulation, rasters), scene.bed_evolves());
    add_friction(scene, simulation, rasters);
    return record;
}

}  // namespace frana
