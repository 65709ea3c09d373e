#include "run/converge/study_run.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <utility>

#include "base/error.h"
#include "io/gdal_reader.h"
#include "run/end_remarks.h"
#include "run/folder/checkpoint.h"
#include "run/folder/record_file.h"
#include "run/folder/run_folder.h"
#include "run/run_loop.h"
#include "scene/bed_over.h"
#include "scene/build_scene.h"
#include "vtk_io/barrier_mesh.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

/// How the folder of a run is found.
enum class Standing {
    fresh,       ///< without a run's files, or with those that are to be replaced
    unfinished,  ///< with a state to go on from
    broken,      ///< a run died in it before its first state
    finished
};

Standing standing_of(const fs::path& run_dir) {
    const auto record = json_in(run_dir / "run.json");
    const std::string reason = record.is_object() ? record.value("exit_reason", "") : "";
    if (has_answer(reason)) return Standing::finished;
    if (fs::exists(run_dir / "checkpoint.h5")) return Standing::unfinished;
    return reason == "running" ? Standing::broken : Standing::fresh;
}

/// The case's overrides and the cell; rasters are what runs are held against each other by.
std::vector<std::string> sets_of(const StudyWishes& wishes, double cell, const std::vector<std::string>& more) {
    std::vector<std::string> sets = wishes.sets;
    sets.push_back(fmt::format("grid.cell={}", cell));
    sets.insert(sets.end(), more.begin(), more.end());
    const CaseFile file = CaseFile::read(wishes.case_file, sets);
    std::vector<std::string> formats = file.words("output.formats");
    if (std::find(formats.begin(), formats.end(), "geotiff") != formats.end()) return sets;
    formats.emplace_back("geotiff");
    std::string list;
    for (const std::string& format : formats) list += fmt::format("{}\"{}\"", list.empty() ? "" : ", ", format);
    sets.push_back(fmt::format("output.formats=[{}]", list));
    return sets;
}

std::vector<PlannedRun> plan_runs(const StudyWishes& wishes) {
    std::vector<PlannedRun> runs;
    const auto plan = [&](double cell, const std::string& name, const std::string& folder,
                          const std::vector<std::string>& sets) {
        PlannedRun& run = runs.emplace_back();
        run.cell = cell, run.name = name;
        run.wishes.out = wishes.out / folder;
        run.wishes.sets = sets_of(wishes, cell, sets);
        const Standing standing = wishes.resume ? standing_of(run.wishes.out) : Standing::fresh;
        run.finished = standing == Standing::finished;
        run.wishes.resume = standing == Standing::unfinished;
        run.wishes.overwrite = wishes.overwrite || standing == Standing::broken;
    };
    for (const double cell : wishes.cells)
        plan(cell, fmt::format("cells of {:g} m", cell), fmt::format("cell_{}", cell), {});
    const double finest = wishes.cells.back();
    for (const VariedKey& one : wishes.varied)
        for (const double value : one.values)
            plan(finest, fmt::format("cells of {:g} m, {} = {:g}", finest, one.key, value),
                 fmt::format("{}_{:g}", one.folder, value), {fmt::format("{}={}", one.key, value)});
    return runs;
}

/// The tables of an earlier study are replaced when requested, other files of their names never.
void require_room_for_tables(const StudyWishes& wishes) {
    const fs::path& out = wishes.out;
    const auto record = json_in(out / "converge.json");
    for (const std::string& name : study_files()) {
        if (!fs::exists(out / name)) continue;
        const bool listed = lists_files(record) &&
                            std::find(record["files"].begin(), record["files"].end(), name) != record["files"].end();
        if (!listed)
            throw UserError(
                fmt::format("{}: found a file that no study left there; expected a folder without files of "
                            "such names; choose another one with --out, or move it away",
                            (out / name).string()));
        if (!wishes.overwrite && !wishes.resume)
            throw UserError(
                fmt::format("{}: found {} of an earlier study; expected a folder without; choose another "
                            "one with --out, give --overwrite to replace that study, or --resume to go on with it",
                            out.string(), name));
    }
}

/// Tables of an earlier study do not stand next to runs that replace its own.
void remove_tables(const fs::path& out) {
    for (const std::string& name : study_files()) fs::remove(out / name);
}

/// What the case gives on all cells alike.
std::vector<std::string> same_on_all(const CaseFile& file) {
    std::vector<std::string> remarks;
    if (file.given("particles.count"))
        remarks.emplace_back(
            "particles.count is the same on all cells, so finer cells have fewer particles each; per_cell would keep "
            "their number in a cell");
    for (Index n = 0; n < file.count("stage"); ++n)
        for (const char* key : {"cell", "spacing"})
            if (file.given(fmt::format("stage.{}.{}", n, key)))
                remarks.push_back(fmt::format(
                    "stage.{}.{} is the same on all cells, so the 3D grid is refined in none of the runs, and what "
                    "converges is the depth-averaged flow alone; without it, it goes with grid.cell",
                    n, key));
    return remarks;
}

/// What building the runs' cases remarked. What all have word for word is told once, the rest with one of its runs.
std::vector<std::string> remarks_on_inputs(const std::vector<PlannedRun>& runs,
                                           const std::vector<std::vector<std::string>>& logs) {
    RemarkTally tally;
    std::map<std::string, std::size_t> alike;
    for (std::size_t k = 0; k < logs.size(); ++k) {
        std::vector<EndRemark> remarks;
        for (const std::string& text : logs[k]) remarks.push_back({text}), ++alike[text];
        tally.add(static_cast<Index>(k), remarks);
    }
    std::vector<std::string> lines;
    for (const SharedRemark& remark : tally.all()) {
        const std::string& name = runs[static_cast<std::size_t>(remark.worst)].name;
        const std::string which =
            remark.runs == 1 ? name : fmt::format("{} of {} runs, such as {}", remark.runs, runs.size(), name);
        lines.push_back(alike[remark.text] == runs.size() ? remark.text
                                                          : fmt::format("found in {}: {}", which, remark.text));
    }
    return lines;
}

std::string overrides(const std::vector<std::string>& sets) {
    std::string text;
    for (const std::string& set : sets) text += fmt::format("{}--set {}", text.empty() ? "" : " ", set);
    return text;
}

}  // namespace

StudyRun::StudyRun(StudyWishes wishes) : wishes_(std::move(wishes)) {
    const CaseFile file = CaseFile::read(wishes_.case_file, wishes_.sets);
    if (wishes_.out.empty()) wishes_.out = fs::path("out") / (file.name() + "_converge");
    const fs::path& out = wishes_.out;
    if (fs::exists(out) && !fs::is_directory(out))
        throw UserError(
            fmt::format("{}: this is a file; expected a folder that can be written to; choose another one "
                        "with --out",
                        out.string()));
    if (fs::is_directory(out)) lock_.emplace(out);
    require_room_for_tables(wishes_);
    remarks_ = same_on_all(file);
    runs_ = plan_runs(wishes_);
    check_scenes();
    if (!lock_) lock_.emplace(out);
    if (wishes_.overwrite) remove_tables(out);
}

void StudyRun::check_scenes() {
    std::vector<std::vector<std::string>> logs;
    for (const PlannedRun& run : runs_) {
        const CaseFile file = CaseFile::read(wishes_.case_file, run.wishes.sets);
        if (!run.finished && !run.wishes.resume)
            require_room_for_run(run.wishes.out, file.inputs(), run.wishes.overwrite ? Overwrite::yes : Overwrite::no);
        Scene scene = build_scene(file, GdalReader(), barrier_mesh_of);
        if (run.finished) open_checkpoint(run.wishes.out, checkpoint_labels(scene, file));
        bed_ = std::move(scene.bed), wider_ = std::move(scene.wider);
        logs.push_back(std::move(scene.log));
    }
    for (std::string& remark : remarks_on_inputs(runs_, logs)) remarks_.push_back(std::move(remark));
}

/// The finest run's terrain, as far as its rasters go.
Raster StudyRun::bed_of_finest() const {
    const PlannedRun& finest = runs_[wishes_.cells.size() - 1];
    const std::vector<ProductRaster> rasters = wider_ ? read_rasters(finest.wishes.out) : std::vector<ProductRaster>();
    return rasters.empty() ? bed_ : bed_over(bed_, wider_.get(), rasters.front().raster.geometry);
}

ConvergenceStudy StudyRun::judge() const {
    ConvergenceStudy study;
    study.folder = wishes_.out;
    study.case_file = wishes_.case_file.string();
    study.overrides = overrides(wishes_.sets);
    study.remarks = remarks_;
    auto run = runs_.begin();
    for (; study.runs.size() < wishes_.cells.size(); ++run) study.runs.push_back({run->cell, run->wishes.out});
    for (const VariedKey& one : wishes_.varied) {
        study.variations.push_back({one.key, one.values, {}, {}, ""});
        for (std::size_t k = 0; k < one.values.size(); ++k, ++run)
            study.variations.back().folders.push_back(run->wishes.out);
    }
    measure_runs(study, bed_of_finest());
    write_study(study);
    return study;
}

}  // namespace frana
