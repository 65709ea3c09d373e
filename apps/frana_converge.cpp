// `frana converge CASE --cells N,N,...`: the same case on several cells, each in a run folder of its own.
#include <fmt/core.h>
#include <omp.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <functional>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "base/error.h"
#include "frana_commands.h"
#include "frana_converge_study.h"
#include "io/gdal_reader.h"
#include "run/folder/checkpoint.h"
#include "run/folder/products.h"
#include "run/folder/run_folder.h"
#include "run/folder/run_lock.h"
#include "run/interrupt.h"
#include "scene/build_scene.h"
#include "terrain/part_of.h"
#include "vtk_io/barrier_mesh.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

/// A list on the command line: two or more different numbers above 0, from large to small.
struct NumberList {
    const char *option, *meaning, *example;
    std::vector<double> read(const std::string& text) const;
};

std::vector<double> NumberList::read(const std::string& text) const {
    const auto complain = [&](const std::string& what) {
        return UserError(fmt::format("{}: {}; expected two or more different {}, each above 0; write them like {}",
                                     option, what, meaning, example));
    };
    std::vector<double> numbers;
    std::istringstream words(text);
    for (std::string word; std::getline(words, word, ',');) {
        word.erase(std::remove(word.begin(), word.end(), ' '), word.end());
        double value = 0.0;
        const char* end = word.data() + word.size();
        const auto read = std::from_chars(word.data(), end, value);
        if (read.ec != std::errc() || read.ptr != end || !(value > 0.0 && value < 1e300))
            throw complain(fmt::format("found \"{}\"", word));
        numbers.push_back(value);
    }
    std::sort(numbers.begin(), numbers.end(), std::greater<>());
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
    if (numbers.size() < 2) throw complain(fmt::format("found \"{}\"", text));
    return numbers;
}

/// A key that is varied on the finest cell, with its values.
struct Varied {
    std::string key, folder;  ///< its runs lie in `folder`_VALUE
    std::vector<double> values;
};

std::vector<Varied> read_varied(const ConvergeOptions& options) {
    std::vector<Varied> all;
    const auto take = [&](const std::string& text, const char* key, const char* folder, const NumberList& list) {
        if (text.empty()) return;
        all.push_back({key, folder, list.read(text)});
        std::reverse(all.back().values.begin(), all.back().values.end());
    };
    take(options.per_cell, "particles.per_cell", "per_cell", {"--per-cell", "numbers of particles a cell", "4,9,16"});
    take(options.cfl, "scheme.cfl", "cfl", {"--cfl", "parts of a cell", "0.5,0.25,0.12"});
    return all;
}

/// How the folder of a run is found.
enum class Standing {
    fresh,       ///< without a run's files, or with those that are to be replaced
    unfinished,  ///< with a state to go on from
    broken,      ///< a run died in it before its first state
    finished
};

struct PlannedRun {
    double cell = 0.0;
    std::string name;  ///< for people
    RunOptions options;
    Standing standing = Standing::fresh;
};

std::string exit_reason_in(const fs::path& run_dir) {
    std::ifstream stream(run_dir / "run.json");
    const auto record = nlohmann::json::parse(stream, nullptr, false);
    return record.is_object() ? record.value("exit_reason", "") : "";
}

Standing standing_of(const fs::path& run_dir) {
    const std::string reason = exit_reason_in(run_dir);
    for (const char* whole : {"end", "rest", "left"})
        if (reason == whole) return Standing::finished;
    if (fs::exists(run_dir / "checkpoint.h5")) return Standing::unfinished;
    return reason == "running" ? Standing::broken : Standing::fresh;
}

/// The case's overrides and the cell; rasters are what runs are held against each other by.
std::vector<std::string> sets_of(const ConvergeOptions& options, double cell, const std::vector<std::string>& more) {
    std::vector<std::string> sets = options.sets;
    sets.push_back(fmt::format("grid.cell={}", cell));
    sets.insert(sets.end(), more.begin(), more.end());
    const CaseFile file = CaseFile::read(options.case_file, sets);
    std::vector<std::string> formats = file.words("output.formats");
    if (std::find(formats.begin(), formats.end(), "geotiff") != formats.end()) return sets;
    formats.emplace_back("geotiff");
    std::string list;
    for (const std::string& format : formats) list += fmt::format("{}\"{}\"", list.empty() ? "" : ", ", format);
    sets.push_back(fmt::format("output.formats=[{}]", list));
    return sets;
}

/// The cells, coarse to fine, then what is varied on the finest.
std::vector<PlannedRun> plan_runs(const ConvergeOptions& options, const std::vector<double>& cells,
                                  const std::vector<Varied>& varied, const fs::path& out) {
    std::vector<PlannedRun> runs;
    const auto plan = [&](double cell, const std::string& name, const std::string& folder,
                          const std::vector<std::string>& sets) {
        PlannedRun run;
        run.cell = cell, run.name = name;
        run.options.case_file = options.case_file;
        run.options.out = out / folder;
        run.options.sets = sets_of(options, cell, sets);
        run.options.threads = options.threads;
        run.options.quiet = options.quiet;
        if (options.resume) run.standing = standing_of(run.options.out);
        run.options.resume = run.standing == Standing::unfinished;
        run.options.overwrite = options.overwrite || run.standing == Standing::broken;
        runs.push_back(run);
    };
    for (const double cell : cells) plan(cell, fmt::format("cells of {:g} m", cell), fmt::format("cell_{}", cell), {});
    for (const Varied& one : varied)
        for (const double value : one.values)
            plan(cells.back(), fmt::format("cells of {:g} m, {} = {:g}", cells.back(), one.key, value),
                 fmt::format("{}_{:g}", one.folder, value), {fmt::format("{}={}", one.key, value)});
    return runs;
}

/// The tables of an earlier study are replaced when requested, other files of their names never.
void require_room_for_tables(const fs::path& out, const ConvergeOptions& options) {
    std::ifstream stream(out / "converge.json");
    const auto record = nlohmann::json::parse(stream, nullptr, false);
    for (const std::string& name : study_files()) {
        if (!fs::exists(out / name)) continue;
        const bool listed = record.is_object() && record.contains("files") && record["files"].is_array() &&
                            std::find(record["files"].begin(), record["files"].end(), name) != record["files"].end();
        if (!listed)
            throw UserError(
                fmt::format("{}: found a file that no study left there; expected a folder without files of "
                            "such names; choose another one with --out, or move it away",
                            (out / name).string()));
        if (!options.overwrite && !options.resume)
            throw UserError(
                fmt::format("{}: found {} of an earlier study; expected a folder without; choose another "
                            "one with --out, give --overwrite to replace that study, or --resume to go on with it",
                            out.string(), name));
    }
}

struct FinestTerrain {
    Raster bed;
    std::shared_ptr<const WiderTerrain> wider;  ///< of which the bed may be a part
};

/// The finest run's terrain, as far as its rasters go.
Raster bed_of_finest(const FinestTerrain& finest, const fs::path& run_dir) {
    const std::vector<ProductRaster> rasters = finest.wider ? read_rasters(run_dir) : std::vector<ProductRaster>();
    if (rasters.empty()) return finest.bed;
    const auto shown = box_of(rasters.front().raster.geometry, finest.wider->grid);
    return shown ? finest.wider->read(united(*shown, finest.wider->held)) : finest.bed;
}

/// Every scene is built before the first run. What is wrong with the finest must not show after hours on the others.
/// Finished runs must be of this very case. Returns the finest terrain.
FinestTerrain check_scenes(const std::vector<PlannedRun>& runs) {
    FinestTerrain finest;
    for (const PlannedRun& run : runs) {
        const CaseFile file = CaseFile::read(run.options.case_file, run.options.sets);
        const Overwrite overwrite = run.options.overwrite ? Overwrite::yes : Overwrite::no;
        if (run.standing == Standing::fresh || run.standing == Standing::broken)
            require_room_for_run(run.options.out, file.inputs(), overwrite);
        Scene scene = build_scene(file, GdalReader(), barrier_mesh_of);
        if (run.standing == Standing::finished) open_checkpoint(run.options.out, checkpoint_labels(scene, file));
        finest = {std::move(scene.bed), std::move(scene.wider)};
    }
    return finest;
}

/// Tables of an earlier study do not stand next to runs that replace its own.
void remove_tables(const fs::path& out) {
    for (const std::string& name : study_files()) fs::remove(out / name);
}

/// 0 when all runs are finished, 130 when one was interrupted.
int carry_out(const std::vector<PlannedRun>& runs, bool quiet) {
    const Interrupt interrupt(Interrupt::Listen::signals);
    for (PlannedRun run : runs) {
        if (run.standing == Standing::finished) {
            if (!quiet) std::cout << fmt::format("{}: finished, in {}\n", run.name, run.options.out.string());
            continue;
        }
        run.options.interrupt = &interrupt;
        const int code = interrupt.requested() ? 130 : run_command(run.options);
        if (code != 0 || interrupt.requested()) {
            if (!quiet) std::cout << "interrupted; --resume goes on where the study stopped\n";
            return code != 0 ? code : 130;
        }
    }
    return 0;
}

std::string overrides(const ConvergeOptions& options) {
    std::string text;
    for (const std::string& set : options.sets) text += fmt::format("{}--set {}", text.empty() ? "" : " ", set);
    return text;
}

std::string remark_on_count(const CaseFile& file) {
    if (!file.given("particles.count")) return "";
    return "particles.count is the same on all cells, so finer cells have fewer particles each; per_cell would keep "
           "their number in a cell";
}

}  // namespace

int converge_command(const ConvergeOptions& options) {
    const std::vector<double> cells = NumberList{"--cells", "cells in metres", "10,5,2.5"}.read(options.cells);
    const std::vector<Varied> varied = read_varied(options);
    const CaseFile file = CaseFile::read(options.case_file, options.sets);
    const fs::path out = options.out.empty() ? fs::path("out") / (file.name() + "_converge") : options.out;
    if (fs::exists(out) && !fs::is_directory(out))
        throw UserError(
            fmt::format("{}: this is a file; expected a folder that can be written to; choose another one "
                        "with --out",
                        out.string()));
    std::optional<RunLock> lock;
    if (fs::is_directory(out)) lock.emplace(out);
    require_room_for_tables(out, options);
    if (options.threads > 0) omp_set_num_threads(options.threads);
    const std::vector<PlannedRun> runs = plan_runs(options, cells, varied, out);
    const FinestTerrain finest = check_scenes(runs);
    if (!lock) lock.emplace(out);
    if (options.overwrite) remove_tables(out);
    if (const int code = carry_out(runs, options.quiet)) return code;

    ConvergenceStudy study;
    study.folder = out;
    study.case_file = options.case_file.string();
    study.overrides = overrides(options);
    auto run = runs.begin();
    for (; study.runs.size() < cells.size(); ++run) study.runs.push_back({run->cell, run->options.out});
    for (const Varied& one : varied) {
        study.variations.push_back({one.key, one.values, {}, {}, ""});
        for (std::size_t k = 0; k < one.values.size(); ++k, ++run)
            study.variations.back().folders.push_back(run->options.out);
    }
    if (const std::string remark = remark_on_count(file); !remark.empty()) study.remarks.push_back(remark);
    measure_runs(study, bed_of_finest(finest, runs[cells.size() - 1].options.out));
    write_study(study);
    std::cout << '\n' << study_section(study);
    for (const std::string& name : study.files) std::cout << (out / name).string() << '\n';
    return 0;
}

}  // namespace frana
