#include "run/converge/study.h"

#include <fmt/core.h>

#include <cmath>

#include "base/error.h"
#include "compare/deposit.h"
#include "compare/flow_tracks.h"
#include "compare/flow_width.h"
#include "compare/outline.h"
#include "compare/runout.h"
#include "run/converge/left_runs.h"
#include "run/folder/left_terrain.h"
#include "run/folder/products.h"
#include "run/folder/record_file.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

/// What of a run is read.
struct RunFiles {
    nlohmann::ordered_json record;
    std::vector<ProductRaster> rasters;
    fs::path folder;

    const Raster& raster(const char* name) const {
        const ProductRaster* product = find_product(rasters, name);
        if (product == nullptr)
            throw UserError(
                fmt::format("{}: is not there; expected the rasters of a finished run; run the study again "
                            "with --overwrite",
                            (folder / "rasters" / name).string() + ".tif"));
        return product->raster;
    }
    /// The largest depth that is known of each place.
    Raster covered() const {
        raster("peak_depth");  // says what is missing
        return *ever_covered(rasters);
    }
    /// What lies there at the end, as flow or as bed.
    Raster deposit() const {
        const ProductRaster* bed = find_product(rasters, "deposited_depth");
        return with_deposit(raster("final_depth"), bed ? &bed->raster : nullptr);
    }
};

RunFiles read_run(const fs::path& folder) {
    RunFiles run{json_in(folder / "run.json"), {}, folder};
    for (const char* key : {"results", "wall_seconds", "exit_reason", "flow_width_cells"})
        if (!run.record.is_object() || !run.record.contains(key))
            throw UserError(
                fmt::format("{}: has no \"{}\"; expected the record of a finished run; run the study again "
                            "with --overwrite",
                            (folder / "run.json").string(), key));
    run.rasters = read_rasters(folder);
    return run;
}

/// The path that all runouts are measured along.
struct Path {
    Polyline line;                 ///< empty: none is known
    std::vector<Polyline> others;  ///< of releases whose flows are apart from that of the first
    std::optional<Vec2> start;     ///< the release's middle
    std::string turn;              ///< what to say of a flow that leaves it at its end
};

Path path_of(const RunFiles& finest, const Raster& bed, double limit, std::vector<std::string>& remarks) {
    Path path;
    std::vector<Vec2> starts = release_middles(finest.raster("arrival_time"));
    for (const Vec2& start : starts_in(finest.record)) starts.push_back(start);
    if (!starts.empty()) path.start = starts.front();
    if (!path.start) {
        remarks.push_back(
            "it is not known where the flow begins, so neither runout nor reach are, and the rule goes without");
        return path;
    }
    const Raster covered = finest.covered();
    const std::vector<RunoutPath> paths = runout_paths(bed, covered, limit, FlowTracks(covered, limit, starts), starts);
    for (std::size_t n = 1; n < paths.size(); ++n) path.others.push_back(paths[n].line);
    if (!paths.empty() && paths.front().start == 0) {
        path.line = paths.front().line;
        if (paths.front().of_flow) remarks.push_back("on the finest cell " + remark_on_track(paths.front()));
        if (paths.size() > 1) remarks.push_back(remark_on_others(starts.front()));
        return path;
    }
    remarks.push_back("no steepest path from the start of the flow is known; the runout is the straight reach");
    return path;
}

CellFigures figures_of(const RunFiles& run, const RunFiles& finest, Path& path, double limit) {
    const Raster &peak = run.raster("peak_depth"), &speed = run.raster("peak_speed");
    const Raster deposit = run.deposit();
    constexpr double nearly_all = 0.999;  // the maximum is that of a single node
    const Raster covered = run.covered();
    const Rings outline = pixel_outline(covered, limit);
    CellFigures figures;
    figures.cell = peak.geometry.cell;
    if (path.line.empty()) {
        figures.reach = path.start ? farthest_from(*path.start, outline) : Raster::nodata;
        figures.runout = figures.reach;
    } else {
        std::vector<Polyline> lines{path.line};
        lines.insert(lines.end(), path.others.begin(), path.others.end());
        const std::vector<Rings> rings = rings_of_parts(lines, covered, limit, outline);
        figures.reach = farthest_from(*path.start, rings.front());
        const FrontAlong front = fronts_along(lines, rings, figures.cell).front();
        figures.runout = front.place;
        if (path.turn.empty()) path.turn = remark_on_turn(front, kNoticeable * figures.cell);
    }
    figures.footprint_area = area_deeper(covered, limit);
    figures.deposit_area = area_deeper(deposit, limit);
    figures.deposit_volume = volume_of(deposit);
    if (const ProductRaster* eroded = find_product(run.rasters, "eroded_depth"))
        figures.eroded_volume = volume_of(eroded->raster);
    if (const ProductRaster* lying = find_product(run.rasters, "deposited_depth"))
        figures.deposited_volume = volume_of(lying->raster);
    figures.peak_depth = covered_quantile(peak, peak, limit, nearly_all);
    figures.largest_depth = covered_quantile(peak, peak, limit, 1.0);
    figures.peak_speed = covered_quantile(speed, peak, limit, nearly_all);
    figures.largest_speed = covered_quantile(speed, peak, limit, 1.0);
    figures.iou = footprints_iou(covered, finest.covered(), limit);
    figures.elsewhere = share_elsewhere(deposit, finest.deposit());
    const auto& across = run.record["flow_width_cells"];
    figures.cells_across = across.is_number() ? across.get<double>() : Raster::nodata;
    figures.seconds = run.record["wall_seconds"].at("total").get<double>();
    return figures;
}

void remark_on_ends(ConvergenceStudy& study) {
    for (std::size_t k = 0; k < study.runs.size(); ++k)
        if (study.ends[k] == "end")
            study.remarks.push_back(
                fmt::format("on cells of {:g} m the simulated time ended the run: what it has for "
                            "a deposit may still move; raise time.end",
                            study.runs[k].cell));
}

/// Beyond the end of the path its last direction tells nothing of the flow's, so runouts there are not the flow's.
void leave_short_path(ConvergenceStudy& study, const Path& path) {
    std::vector<CellFigures*> all;
    for (CellFigures& f : study.figures) all.push_back(&f);
    for (Variation& varied : study.variations)
        for (CellFigures& f : varied.figures) all.push_back(&f);
    const double length = length_of(path.line);
    const CellFigures* farthest = nullptr;
    for (const CellFigures* f : all)
        // Outlines of pixels are good to a cell.
        if (std::isgreater(f->runout, length + f->cell) && (!farthest || f->runout > farthest->runout)) farthest = f;
    if (!farthest && path.turn.empty()) return;
    study.remarks.push_back((farthest ? remark_on_end(length, farthest->runout, farthest->cell) : path.turn) +
                            "; so the straight reach counts as the runout");
    study.along_path = false;
    for (CellFigures* f : all) f->runout = f->reach;
}

/// A flow that runs up an opposite slope leaves the path that water would take.
void remark_on_path(ConvergenceStudy& study) {
    const CellFigures& finest = study.figures.back();
    for (const CellFigures& f : study.figures) {
        const double along = f.runout - finest.runout, straight = f.reach - finest.reach;
        if (!(std::abs(along - straight) > kNoticeable * f.cell)) continue;
        study.remarks.push_back(fmt::format(
            "the steepest path may turn away from the fronts: on cells of {:g} m they differ from the finest by "
            "{:+.4g} m along it, but by {:+.4g} m straight from the release",
            f.cell, along, straight));
    }
}

}  // namespace

void measure_runs(ConvergenceStudy& study, const Raster& bed) {
    const RunFiles finest = read_run(study.runs.back().folder);
    study.footprint_depth = finest.record["results"].at("footprint_depth").get<double>();
    study.title = finest.record.value("title", "");
    Path path = path_of(finest, bed, study.footprint_depth, study.remarks);
    bool particles = false;
    for (const StudiedRun& run : study.runs) {
        const RunFiles files = read_run(run.folder);
        study.figures.push_back(figures_of(files, finest, path, study.footprint_depth));
        study.ends.push_back(files.record["exit_reason"].get<std::string>());
        study.left.push_back(noticeably_left_in(files.record));
        particles = particles || files.record.value("particle_steps", 1.0) > 0.0;
    }
    for (Variation& varied : study.variations)
        for (const fs::path& folder : varied.folders)
            varied.figures.push_back(figures_of(read_run(folder), finest, path, study.footprint_depth));
    study.along_path = !path.line.empty();
    if (study.along_path) leave_short_path(study, path);
    for (Variation& varied : study.variations)
        varied.sentence = spread_sentence(varied.key, varied.values, varied.figures, study.rule);
    const double across = study.figures.back().cells_across, cell = study.figures.back().cell;
    const std::string narrow = width_remark(across * cell, cell, particles);
    if (!narrow.empty()) study.remarks.push_back(fmt::format("on the finest cell of {:g} m {}", cell, narrow));
    remark_on_ends(study);
    remark_on_path(study);
    study.verdict = judge(study.figures, study.rule);
    doubt_left(study);
}

}  // namespace frana
