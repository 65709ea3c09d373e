// `frana figures RUN_DIR`: the pictures of a finished run, drawn again from its files.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <list>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/error.h"
#include "base/shell_word.h"
#include "frana_commands.h"
#include "frana_figures.h"
#include "io/gdal_reader.h"
#include "run/folder/comparison.h"
#include "run/folder/cutoff.h"
#include "run/folder/record_file.h"
#include "run/folder/run_3d.h"
#include "run/folder/run_film.h"
#include "run/folder/run_folder.h"
#include "run/folder/run_lock.h"
#include "run/folder/run_page.h"
#include "run/folder/run_state.h"
#include "run/web/web_page.h"
#include "scene/barriers_of_case.h"
#include "scene/lines_of_case.h"
#include "scene/remarks.h"
#include "terrain/part_of.h"
#include "vtk_io/reader.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

std::string text_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream)
        throw UserError(
            fmt::format("{}: cannot be read; expected the folder of a finished run, such as the one after "
                        "--out of frana run",
                        file.string()));
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
}

/// Names of barriers that was_hit() denies.
std::vector<std::string> never_hit_in(const nlohmann::json& json) {
    std::vector<std::string> names;
    for (const nlohmann::json& barrier : json.value("barriers", nlohmann::json::array())) {
        const auto number = [&](const char* key, double otherwise) {
            const auto found = barrier.find(key);
            return found != barrier.end() && found->is_number() ? found->get<double>() : otherwise;
        };
        BarrierSummary summary;
        summary.first_contact = number("first_contact", summary.first_contact);
        summary.peak_force = number("peak_force", summary.peak_force);
        summary.run_up = number("run_up", summary.run_up);
        if (!was_hit(summary)) names.push_back(barrier.at("name").get<std::string>());
    }
    return names;
}

/// The times that forces of barriers are means over, by name [s].
std::map<std::string, double> mean_over_in(const nlohmann::json& json) {
    std::map<std::string, double> times;
    for (const nlohmann::json& barrier : json.value("barriers", nlohmann::json::array()))
        if (const auto time = barrier.find("averaged_over"); time != barrier.end() && time->is_number() && *time > 0.0)
            times[barrier.at("name").get<std::string>()] = time->get<double>();
    return times;
}

/// Killed, or without room on the disk. Where file systems have no locks it may still go on.
UserError broke_off(const fs::path& run_dir) {
    const std::string out = shell_word(run_dir.string());
    const bool saved = fs::exists(run_dir / "checkpoint.h5");
    return UserError(fmt::format(
        "{}: found a run that broke off before its end, and no process that goes on with it; expected a finished run; "
        "{}",
        run_dir.string(),
        saved ? fmt::format("let it go on with `frana run CASE --out {} --resume`", out)
              : fmt::format("it has saved no state, so run it again with `frana run CASE --out {} --overwrite`", out)));
}

/// The part of run.json that figures need.
void read_record(const fs::path& run_dir, FigureSource& source) {
    const fs::path file = run_dir / "run.json";
    const auto json = nlohmann::json::parse(text_of(file), nullptr, false);
    const auto reason = json.is_object() ? json.value("exit_reason", nlohmann::json()) : nlohmann::json();
    if (reason == kRunning && is_run_going_on(run_dir))
        throw UserError(fmt::format("{}: found a run that has not ended; expected a finished one; wait for its end",
                                    run_dir.string()));
    if (reason == kRunning || reason == kStopped) throw broke_off(run_dir);
    try {
        source.title = json.at("title").get<std::string>();
        source.footer = json.at("caption").get<std::string>();
        source.date = json.value("started", std::string()).substr(0, 10);
        const nlohmann::json& results = json.at("results");
        source.footprint_depth = results.at("footprint_depth").get<double>();
        source.front_origin = results.value("front_from", source.front_origin);  // older runs have none
        source.never_hit = never_hit_in(json);
        source.mean_over = mean_over_in(json);
        source.density = json.value("density", source.density);  // older runs have none
    } catch (const nlohmann::json::exception&) {
        throw UserError(
            fmt::format("{}: is not what a run leaves there; expected the record of a finished run; "
                        "run the case again",
                        file.string()));
    }
}

/// Its line may be a file. Where that has gone maps lack the line, and charts still have the section's name.
void read_section(const CaseFile& run_case, Index i, FigureSource& source, std::vector<std::string>& warnings) {
    const std::string table = fmt::format("section.{}.", i);
    Section section{run_case.word(table + "name"), {}, true};
    try {
        std::vector<std::string> said_by_the_run;
        section.line = read_line(run_case, table + "line", GdalReader(), source.bed.crs_wkt, said_by_the_run);
    } catch (const UserError& error) {
        warnings.push_back(fmt::format("section {} is not on the maps: {}", section.name, error.what()));
    }
    source.sections.push_back(std::move(section));
}

/// The path in the overlay, as the run's comparison chose it. A line that has gone is a warning.
void read_runout_path(const CaseFile& run_case, FigureSource& source, std::vector<std::string>& warnings) {
    const ProductRaster* peak = find_product(source.rasters, "peak_depth");
    if (peak == nullptr) return;
    try {
        std::vector<std::string> said_by_the_run;
        SurveyFiles files;
        files.path = survey_files(run_case).path;
        Survey survey = read_survey_files(files, peak->raster, said_by_the_run);
        survey.footprint = *source.survey;
        source.runout_paths =
            paths_of(compare_rasters(source.rasters, &source.bed, source.footprint_depth, survey, source.starts));
    } catch (const UserError& error) {
        warnings.push_back(fmt::format("the runout path is not shown: {}", error.what()));
    }
}

/// A survey that has gone is left out.
void read_survey_of_case(const CaseFile& run_case, FigureSource& source, std::vector<std::string>& warnings) {
    if (!run_case.has("survey.footprint") || source.bed.values.empty()) return;
    const fs::path survey = run_case.path("survey.footprint");
    if (!fs::exists(survey)) {
        warnings.push_back(fmt::format("{}: the survey is not there any more and is left out", survey.string()));
        return;
    }
    source.survey = GdalReader().read_survey(survey, source.bed.geometry.pixel_extent(), source.bed.crs_wkt, warnings);
    read_runout_path(run_case, source, warnings);
}

/// Lines and points from the case in full. Files that it names may have gone.
void read_lines(const CaseFile& run_case, FigureSource& source, std::vector<std::string>& warnings) {
    for (Index i = 0; i < run_case.count("profile"); ++i) {
        const std::string table = fmt::format("profile.{}.", i);
        source.profiles.push_back({run_case.word(table + "name"), run_case.points(table + "line")});
    }
    for (Index i = 0; i < run_case.count("gauge"); ++i) {
        const std::string table = fmt::format("gauge.{}.", i);
        const std::vector<double>& point = run_case.numbers(table + "point");
        source.gauges.push_back({run_case.word(table + "name"), Vec2(point[0], point[1])});
    }
    for (Index i = 0; i < run_case.count("section"); ++i) read_section(run_case, i, source, warnings);
    source.inflows = inflow_places(run_case, source.bed.crs_wkt, warnings);
    for (Index i = 0; i < run_case.count("stage"); ++i)
        source.in_3d |= run_case.word(fmt::format("stage.{}.model", i)) == "mpm3d";
}

/// An outline that has gone is left out, and all barriers with it.
void read_barriers(const CaseFile& run_case, FigureSource& source, std::vector<std::string>& warnings) {
    if (source.bed.values.empty()) return;
    try {
        std::vector<std::string> said_by_the_run;
        source.barriers = barriers_of_case(run_case, GdalReader(), source.bed, said_by_the_run);
        for (const Barrier& barrier : source.barriers) source.barrier_tops.push_back({barrier.top, barrier.height});
    } catch (const UserError& error) {
        warnings.push_back(fmt::format("barriers are not shown: {}", error.what()));
    }
}

/// A component of a node field of a frame as a raster; without terrain nodata.
ProductRaster from_frame(const LoadedFrame& frame, const std::string& field, const std::string& name,
                         std::size_t component = 0) {
    ProductRaster product{name, frame.units.at(field), field, Raster::filled(frame.grid, Raster::nodata)};
    const std::vector<double>& values = frame.nodes.at(field);
    const std::vector<double>& elevation = frame.nodes.at("elevation");
    const std::size_t components = static_cast<std::size_t>(frame.components.at(field));
    for (std::size_t i = 0; i < elevation.size(); ++i)
        if (!std::isnan(elevation[i])) product.raster.values[i] = values[i * components + component];
    return product;
}

/// The elevation model that the case names, where the run's rasters show it, for runs that wrote no VTK files.
Raster bed_of_case(const fs::path& run_dir, const std::vector<ProductRaster>& rasters) {
    return dem_of_case(case_of_run(run_dir), [&](const Raster& whole) {
        const NodeBox all = NodeBox::all(whole.geometry);
        if (rasters.empty()) return all;
        const auto shown = box_of(rasters.front().raster.geometry, whole.geometry);
        return shown && common(*shown, all) == *shown ? *shown : all;
    });
}

/// Where the run's files have the same nodes to round-off, the rasters' are taken.
bool brought_onto(Raster& bed, const GridGeometry& grid) {
    const GridGeometry& g = bed.geometry;
    constexpr double round_off = 1e-6;  // of a cell
    const bool same = g.nx == grid.nx && g.ny == grid.ny && std::abs(g.x0 - grid.x0) < round_off * grid.cell &&
                      std::abs(g.y0 - grid.y0) < round_off * grid.cell &&
                      std::abs(g.cell - grid.cell) < round_off * grid.cell;
    if (same) bed.geometry = grid;
    return same;
}

void read_bed(FigureSource& source, std::vector<std::string>& warnings) {
    if (fs::exists(source.run_dir / "terrain.vti")) {
        source.bed = from_frame(read_terrain(source.run_dir), "elevation", "terrain").raster;
        if (!source.rasters.empty()) source.bed.crs_wkt = source.rasters.front().raster.crs_wkt;
        return;
    }
    try {
        Raster bed = bed_of_case(source.run_dir, source.rasters);
        const bool fits = source.rasters.empty() || brought_onto(bed, source.rasters.front().raster.geometry);
        if (fits) source.bed = std::move(bed);
    } catch (const UserError&) {
        source.bed = Raster();  // said below
    }
    if (source.bed.values.empty())
        warnings.push_back(
            fmt::format("{}: no terrain.vti, and the case's elevation model is not there any more, so no maps; add "
                        "\"vtk\" to output.formats and run again",
                        source.run_dir.string()));
}

/// Maps of the frame nearest to a time: figures/map_depth_t12.5s.png, map_speed_t12.5s.png, damage, and with stresses
/// map_effective_stress_xx_t12.5s.png and so on.
/// `shown` stores what they show. Depth has with it what has become bed. Other fields are shown where the flow is.
void add_moment(const FigureSource& source, double time, std::list<ProductRaster>& shown, Gallery& gallery) {
    const Index nearest = choose_frame(frame_times(source.run_dir), time, source.run_dir / "grid.pvd");
    LoadedFrame frame = read_frame(source.run_dir, nearest);
    if (std::abs(frame.time - time) > 1e-9 * std::max(1.0, std::abs(frame.time)))
        gallery.warn(fmt::format("no frame at {:.6g} s; the nearest, at {:.6g} s, is drawn", time, frame.time));
    const std::string moment = fmt::format("{:.6g}", frame.time);
    const auto keep = [&](ProductRaster product) { return &shown.emplace_back(std::move(product)); };
    const ProductRaster* extent = frame.has("depth") ? keep(from_frame(frame, "depth", "depth")) : nullptr;
    add_deposit(frame);
    const auto words_of = [&](const std::string& field) -> std::string {
        if (field == "water_depth") return "depth of free water";
        return field == "depth" && frame.has("deposited_depth") ? "depth with what has become bed" : field;
    };
    for (const char* field : {"depth", "speed", "damage", "water_depth"}) {
        if (!frame.has(field)) {
            if (field == std::string("damage") || field == std::string("water_depth")) continue;  // of few runs only
            gallery.warn(fmt::format("no {} in the frames of this run, so no map of it", field));
            continue;
        }
        const ProductRaster* product = keep(from_frame(frame, field, fmt::format("{}_t{}s", field, moment)));
        add_map(source, *product, fmt::format("{} at t = {} s", words_of(field), moment), extent, gallery);
    }
    constexpr const char* kComponents[] = {"xx", "yy", "xy"};
    for (const char* field : {"effective_stress", "stress"}) {
        if (!frame.has(field) || frame.components.at(field) != 3) continue;
        for (std::size_t n = 0; n < 3; ++n) {
            const ProductRaster* product =
                keep(from_frame(frame, field, fmt::format("{}_{}_t{}s", field, kComponents[n], moment), n));
            const std::string what = std::string(field) == "stress" ? "stress" : "effective stress";
            add_map(source, *product, fmt::format("{} {} at t = {} s", what, kComponents[n], moment), extent, gallery);
        }
    }
}

}  // namespace

CaseFile case_of_run(const fs::path& run_dir) {
    const fs::path file = run_dir / "resolved.toml";
    return CaseFile::parse(text_of(file), file);
}

Raster dem_of_case(const CaseFile& run_case, const std::function<NodeBox(const Raster& whole)>& choose) {
    DemRequest request;
    if (run_case.has("terrain.window")) {
        const auto& w = run_case.numbers("terrain.window");
        request.window = {w[0], w[1], w[2], w[3]};
    }
    if (run_case.has("grid.cell")) request.cell = run_case.number("grid.cell");
    request.choose = choose;
    std::vector<std::string> said_by_the_run;
    return GdalReader().read_dem(run_case.path("terrain.dem"), request, said_by_the_run);
}

std::string title_of_run(const fs::path& run_dir) {
    FigureSource source;
    read_record(run_dir, source);
    return source.title;
}

std::vector<LateEntry> late_of_run(const fs::path& run_dir) {
    const auto json = nlohmann::json::parse(text_of(run_dir / "run.json"), nullptr, false);
    std::vector<LateEntry> late;
    if (!json.is_object()) return late;  // said elsewhere
    for (const auto& entry : json.value("late_releases", nlohmann::json::array())) {
        LateEntry one;
        one.name = entry.value("name", std::string());
        if (entry.contains("entered") && entry["entered"].is_number()) one.entered = entry["entered"].get<double>();
        late.push_back(one);
    }
    return late;
}

FigureSource read_finished_run(const fs::path& run_dir, std::vector<std::string>& warnings) {
    FigureSource source;
    source.run_dir = run_dir;
    read_record(run_dir, source);
    source.starts = starts_in(json_in(run_dir / "run.json"));
    source.rasters = read_rasters(run_dir);
    read_bed(source, warnings);
    return source;
}

void read_places(FigureSource& source, std::vector<std::string>& warnings) {
    const CaseFile run_case = case_of_run(source.run_dir);
    read_lines(run_case, source, warnings);
    read_barriers(run_case, source, warnings);
}

int figures_command(const FiguresOptions& options) {
    const auto interrupted = [&] {
        std::cerr << fmt::format(
                         "interrupted; the pictures that are there are whole; `frana figures {}` "
                         "draws all again\n",
                         options.run_dir.string())
                  << std::flush;
    };
    const Cutoff cutoff([&, add = adding_to_files(options.run_dir)] {
        remove_half_written(options.run_dir);
        add();
        interrupted();
    });
    std::vector<std::string> warnings;
    FigureSource source = read_finished_run(options.run_dir, warnings);
    source.width = options.width;
    source.height = options.height;
    source.time = options.time;
    if (source.bed.values.empty()) source.rasters.clear();
    read_places(source, warnings);
    read_survey_of_case(case_of_run(options.run_dir), source, warnings);
    Gallery gallery(options.run_dir);
    std::list<ProductRaster> of_the_moment;
    FlowFrames frames(source.footprint_depth);
    if (options.web) {
        if (const std::string why_not = no_page_reason(); !why_not.empty())
            throw UserError(fmt::format("--web: {}", why_not));
        frames = frames_of_run(source);
        add_page(source, frames, text_of(options.run_dir / "run.json"), gallery);
    } else {
        add_figures(source, gallery);
    }
    if (options.time) add_moment(source, *options.time, of_the_moment, gallery);
    if (!options.film.empty()) {
        add_film(source, options.film, gallery);
        add_film_3d(source, options.film, gallery);
    }
    const std::size_t wanted = gallery.pictures();
    const std::vector<DrawnFigure> figures = gallery.draw(threads_for_figures(), warnings);
    for (const DrawnFigure& figure : figures) std::cout << (options.run_dir / figure.path).string() << '\n';
    join_remarks_on_coordinates(warnings);
    for (const std::string& warning : warnings) std::cerr << "warning: " << warning << '\n';
    if (!Cutoff::asked()) {
        if (figures.empty() && wanted > 0)
            throw UserError(fmt::format("{}: none of the {} pictures could be drawn; the warnings above tell why",
                                        options.run_dir.string(), wanted));
        return 0;
    }
    interrupted();
    return 130;
}

}  // namespace frana
