// The program: command line in, exit code out. 0 done, 1 our bug, 2 case, data or command line, 3 numerics,
// 130 interrupted.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iostream>
#include <limits>
#include <new>
#include <optional>

#include "base/error.h"
#include "base/number_text.h"
#include "base/version.h"
#include "frana_commands.h"
#include "frana_failure.h"
#include "io/gdal_reader.h"
#include "io/hdf5_version.h"
#include "run/folder/run_folder.h"
#include "scene/parameters.h"
#include "vtk_io/vtk_version.h"

namespace frana {
namespace {

using Action = std::function<int()>;  ///< what the chosen subcommand does

std::string version_text() {
    const char* arch = FRANA_ARCH[0] ? FRANA_ARCH : "compiler's default";
    std::string text = fmt::format("frana {}\n", FRANA_VERSION);
    text += fmt::format("build {}, {}, march {}\n", FRANA_BUILD_TYPE, FRANA_COMPILER, arch);
    return text + fmt::format("VTK {}, GDAL {}, HDF5 {}", vtk_version(), gdal_version(), hdf5_version());
}

void add_case(CLI::App& command, std::filesystem::path& file, std::vector<std::string>& sets) {
    command.add_option("CASE", file, "case file (TOML)")->required();
    command.add_option("--set", sets, "override a key: key=value, as often as wanted")
        ->type_name("key=value")
        ->allow_extra_args(false);
}

/// --quiet or --progress json.
void add_telling(CLI::App& command, bool& quiet, std::string& progress) {
    CLI::Option* none = command.add_flag("--quiet", quiet, "no progress");
    command.add_option("--progress", progress, "json: a line of JSON a second for other programs")
        ->check(CLI::IsMember({"json"}))
        ->excludes(none);
}

/// What the number of an option has to be: finite, and no smaller than a bound.
struct Bound {
    double least;
    bool least_too;
    const char* expected;
};
constexpr Bound kAboveZero{0.0, false, "a finite number above 0"}, kFromZero{0.0, true, "a finite number, 0 or more"},
    kFinite{std::numeric_limits<double>::lowest(), true, "a finite number"};

/// CLI11 takes "nan" and "inf" for numbers, and prints the largest double where one is out of bounds.
CLI::Option* numeric(CLI::Option* option, const Bound& bound) {
    return option->check(CLI::Validator(
        [option, bound](std::string& text) -> std::string {
            const std::optional<double> value = number_in(text);
            const bool fits =
                value && std::isfinite(*value) && (bound.least_too ? *value >= bound.least : *value > bound.least);
            if (fits) return "";
            throw UserError(
                fmt::format("{}: found {}; expected {}; give one", option->get_name(), text, bound.expected));
        },
        ""));
}

/// What a command on a finished run makes is listed in its run.json, as what the run made.
int adding_to(const std::filesystem::path& run_dir, const Action& command) {
    int code = 0;
    add_to_files(run_dir, [&] { code = command(); });
    return code;
}

void add_run(CLI::App& app, RunOptions& options, Action& action) {
    CLI::App* command = app.add_subcommand("run", "run a case");
    add_case(*command, options.case_file, options.sets);
    command->add_option("--out", options.out, "folder of the results; default out/<case name>");
    command->add_option("--threads", options.threads, "threads; default OMP_NUM_THREADS")->check(CLI::Range(1, 4096));
    numeric(command->add_option("--until", options.until, "stop at this simulated time [s]"), kAboveZero);
    command->add_flag("--resume", options.resume, "go on, bit for bit, from the checkpoint.h5 that a run left");
    command->add_flag("--overwrite", options.overwrite, "replace the files of an earlier run in the folder");
    add_telling(*command, options.quiet, options.progress);
    command->callback([&] { action = [&] { return run_command(options); }; });
}

void add_converge(CLI::App& app, ConvergeOptions& options, Action& action) {
    CLI::App* command = app.add_subcommand("converge", "the same case on several cells: has the answer converged?");
    add_case(*command, options.case_file, options.sets);
    command->add_option("--cells", options.cells, "cells [m]: N,N,...; two or more")->required();
    command->add_option("--per-cell", options.per_cell,
                        "also run the finest cell with each particles.per_cell: N,N,...");
    command->add_option("--cfl", options.cfl, "also run the finest cell with each scheme.cfl: N,N,...");
    command->add_option("--out", options.out, "folder of the runs and the tables; default out/<case name>_converge");
    command->add_option("--threads", options.threads, "threads; default OMP_NUM_THREADS")->check(CLI::Range(1, 4096));
    command->add_flag("--resume", options.resume, "take finished runs as they are, go on with the others");
    command->add_flag("--overwrite", options.overwrite, "replace the files of an earlier study in the folder");
    command->add_flag("--quiet", options.quiet, "no progress");
    command->callback([&] { action = [&] { return converge_command(options); }; });
}

void add_ensemble(CLI::App& app, EnsembleOptions& options, Action& action) {
    CLI::App* command = app.add_subcommand("ensemble", "many runs of a case whose keys vary, and maps of probability");
    command->add_option("FILE", options.file, "what varies, and how (TOML)");
    command->add_option("--out", options.out, "folder of the runs and the maps");
    command->add_option("--threads", options.threads, "runs at a time; default OMP_NUM_THREADS")
        ->check(CLI::Range(1, 4096));
    command->add_option("--shard", options.shard, "run one of N parts only, counted from 0: I/N");
    command->add_flag("--resume", options.resume, "go on with what has been run in the folder");
    command->add_flag("--check", options.check, "show the first samples and foretell time and space, from two runs");
    command->add_option("--join", options.join, "make the maps of all runs in this folder");
    command->add_option("--exceed", options.exceed, "one more map of probability: FIELD=VALUE")
        ->type_name("FIELD=VALUE")
        ->allow_extra_args(false);
    command->add_option("--again", options.again, "write a sample as a case of its own");
    command->add_option("--slurm", options.slurm, "print the script of a Slurm job array with so many parts")
        ->check(CLI::Range(1, 100000));
    add_telling(*command, options.quiet, options.progress);
    command->callback([&] { action = [&] { return ensemble_command(options); }; });
}

void add_calibrate(CLI::App& app, CalibrateOptions& options, Action& action) {
    CLI::App* command = app.add_subcommand("calibrate", "what surveyed events tell of the keys of their cases");
    command->add_option("FILE", options.file, "what varies, and the events (TOML)")->required();
    command->add_option("--out", options.out, "folder of the result")->required();
    command->add_option("--threads", options.threads, "runs at a time; default OMP_NUM_THREADS")
        ->check(CLI::Range(1, 4096));
    CLI::Option* resume = command->add_flag("--resume", options.resume, "go on with what has been run in the folder");
    command->add_flag("--overwrite", options.overwrite, "replace an earlier calibration in the folder")
        ->excludes(resume);
    add_telling(*command, options.quiet, options.progress);
    command->callback([&] { action = [&] { return calibrate_command(options); }; });
}

void add_check(CLI::App& app, CheckOptions& options, Action& action) {
    CLI::App* command = app.add_subcommand("check", "read and build the whole scene without running it");
    add_case(*command, options.case_file, options.sets);
    command->callback([&] { action = [&] { return check_command(options); }; });
}

void add_describe(CLI::App& app, DescribeOptions& options, Action& action) {
    CLI::App* command = app.add_subcommand("describe", "case keys: meaning, unit, range, default");
    CLI::Option* wanted =
        command->add_option("key", options.key, "a key, a table or the beginning of either; default all");
    CLI::Option* page =
        command->add_flag("--markdown", options.markdown, "the whole table as a page of Markdown (cases/KEYS.md)");
    page->excludes(wanted);
    CLI::Option* json =
        command->add_flag("--json", options.json, "the keys as JSON, for other programs")->excludes(page);
    command->add_flag("--combinations", options.combinations, "what is refused together, and what to do instead")
        ->excludes(wanted)
        ->excludes(page)
        ->excludes(json);
    command
        ->add_flag(
            "--parameters", options.parameters,
            "friction and density by the kind of mass, with sources, as a page of Markdown (cases/PARAMETERS.md)")
        ->excludes(wanted)
        ->excludes(page)
        ->excludes(json);
    command->callback([&] { action = [&] { return describe_command(options); }; });
}

void add_particles(CLI::App& app, ParticlesOptions& options, Action& action) {
    CLI::App* command = app.add_subcommand("particles", "particle generation alone");
    add_case(*command, options.case_file, options.sets);
    command->add_option("--out", options.out, "file to write: .h5, .json, .csv or .vtp")->required();
    command->add_option("--count", options.count, "number of particles, as particles.count");
    command->callback([&] { action = [&] { return particles_command(options); }; });
}

void add_convert(CLI::App& app, ConvertOptions& options, Action& action) {
    CLI::App* command =
        app.add_subcommand("convert", "particles of a run to 3D points, with what is conserved on the way");
    command->add_option("RUN_DIR", options.run_dir, "folder of the run")->required();
    numeric(command->add_option("--time", options.time, "simulated time [s]; the nearest frame is taken"), kFinite);
    numeric(command->add_option("--spacing", options.spacing, "vertical distance of the points [m]"), kFinite);
    command->add_option("--out", options.out, "file to write: .h5, .json, .csv, .vtp or .mdpa");
    command->add_option("--layers", options.layers, "centres (of equal slices, default) or end-points (bed to surface)")
        ->check(CLI::IsMember({"centres", "end-points"}));
    command->add_option("--vertical", options.vertical, "velocity: along-bed (default) or zero")
        ->check(CLI::IsMember({"along-bed", "zero"}));
    command->add_option("--profile", options.profile, "of the velocity: plug (default), linear, parabolic, bagnold")
        ->check(CLI::IsMember({"plug", "linear", "parabolic", "bagnold"}));
    numeric(command->add_option("--window", options.window, "only particles within: xmin,ymin,xmax,ymax"), kFinite)
        ->delimiter(',')
        ->expected(4);
    command->add_option("--points", options.points, "3D points (.h5) to bring back onto the run's grid, with --back");
    command->add_option("--back", options.back, "folder for depth.tif, velocity_x.tif, velocity_y.tif of --points");
    command->callback([&] { action = [&] { return convert_command(options); }; });
}

/// "1600x1200" into width and height.
void read_size(const std::string& text, FiguresOptions& options) {
    int end = 0;
    const int read = std::sscanf(text.c_str(), "%5dx%5d%n", &options.width, &options.height, &end);
    const bool whole = read == 2 && end == static_cast<int>(text.size());
    if (!whole || options.width < 100 || options.height < 100 || options.width > 16384 || options.height > 16384)
        throw UserError(
            fmt::format("--size: found \"{}\"; expected WIDTHxHEIGHT in pixels, each 100 to 16384; write it "
                        "like 1600x1200",
                        text));
}

void add_figures(CLI::App& app, FiguresOptions& options, std::string& size, Action& action) {
    CLI::App* command = app.add_subcommand("figures", "render the figures of a run again, headless");
    command->add_option("RUN_DIR", options.run_dir, "folder of the run")->required();
    numeric(command->add_option("--time", options.time, "simulated time [s]; default the last frame"), kFinite);
    command->add_option("--size", size, "pixels; default 1600x1200")->type_name("WxH");
    command->add_option("--film", options.film, "a film of the depth besides, mp4 or gif; needs the program ffmpeg")
        ->check(CLI::IsMember({"mp4", "gif"}));
    command->add_flag("--web", options.web, "only figures/view.html, a page for a browser");
    command->callback([&] {
        action = [&] {
            if (!size.empty()) read_size(size, options);
            return adding_to(options.run_dir, [&] { return figures_command(options); });
        };
    });
}

void add_compare(CLI::App& app, CompareOptions& options, Action& action) {
    CLI::App* command = app.add_subcommand("compare", "hold a finished run against a survey");
    command->add_option("RUN_DIR", options.run_dir, "folder of the run")->required();
    CLI::Option* survey =
        command->add_option("--survey", options.survey, "surveyed extent: polygons, or a raster that is above 0 there");
    command->add_option("--deposit", options.deposit, "raster of the surveyed deposit's thickness [m]")->needs(survey);
    CLI::Option* change =
        command->add_option("--bed-change", options.bed_change,
                            "raster of the difference of two surveys, after minus before [m]; without "
                            "--survey the changes of the bed are compared alone");
    numeric(command->add_option("--bed-change-noise", options.bed_change_noise,
                                "change within the noise of both surveys, which counts as none [m]; default 0.1"),
            kFromZero)
        ->needs(change);
    command->add_option("--path", options.path, "line for the runout; default the steepest from the release");
    command->add_option("--json", options.json, "file of the scores; default RUN_DIR/compare.json");
    command->footer(
        "Give --survey, --bed-change, or both. A case with a [survey] of its own was compared at the end of its run, "
        "in "
        "report.md. What other files give is named after them and stands beside it: "
        "compare_with_NAME.json, compare_with_NAME.md, figures/compare_with_NAME.png.");
    command->callback(
        [&] { action = [&] { return adding_to(options.run_dir, [&] { return compare_command(options); }); }; });
}

void add_states(CLI::App& app, StatesOptions& options, Action& action) {
    CLI::App* command =
        app.add_subcommand("states", "write the ParaView states of a run, or an ensemble, again, after it was moved");
    command->add_option("RUN_DIR", options.run_dir, "folder of the run")->required();
    command->add_option("NAME", options.names,
                        "states that must be there: overview, stress, profiles, survey, impact, structure, phases, "
                        "budgets, probability");
    command->footer(
        "File > Load State opens one in ParaView. pvstates/frana_paraview.py (share/frana where frana is installed) is "
        "a "
        "plugin of ParaView that opens run.json; the README.md beside it says how to load it.");
    command->callback(
        [&] { action = [&] { return adding_to(options.run_dir, [&] { return states_command(options); }); }; });
}

/// An option without effect beside another one is refused with it.
void exclude_all_but(CLI::App& command, CLI::Option* chosen, const std::vector<std::string>& kept) {
    for (CLI::Option* other : command.get_options()) {
        const std::string name = other->get_name();
        if (other == chosen || name == "--help" || std::find(kept.begin(), kept.end(), name) != kept.end()) continue;
        chosen->excludes(other);
    }
}

/// What is found after the work would be lost with it: the folder of a file to write has to be there before.
CLI::Option* in_folder(CLI::Option* option) {
    return option->check(CLI::Validator(
        [option](std::string& file) -> std::string {
            const std::filesystem::path folder = std::filesystem::absolute(file).parent_path();
            std::error_code none;
            if (std::filesystem::is_directory(folder, none)) return "";
            throw UserError(fmt::format("{} {}: found no folder {}; expected one to write into; make it first",
                                        option->get_name(), file, folder.string()));
        },
        ""));
}

void add_verify(CLI::App& app, VerifyOptions& options, Action& action) {
    CLI::App* command = app.add_subcommand("verify", "problems with exact answers: errors, order, run time");
    command->add_option("NAME", options.names, "problems; default all");
    CLI::Option* list = command->add_flag("--list", options.list, "list the problems");
    command->add_option("--cells", options.cells, "grids: N,N,...")->delimiter(',')->check(CLI::Range(4, 100000));
    command->add_flag("--coarse", options.coarse, "leave out the finest grid of problems that take long");
    command
        ->add_option("--preset", options.preset,
                     "default, fast, paper, or float: the default with scheme.precision = \"float\"")
        ->check(CLI::IsMember({"default", "fast", "paper", "float"}));
    command
        ->add_option("--points", options.per_cell,
                     "points a cell: 1, 4, 9 or 16 on the plane, 1, 8, 27 or 64 in 3D; without NAME of those problems "
                     "that have so many")
        ->check(CLI::IsMember({1, 4, 8, 9, 16, 27, 64}));
    command->add_option("--threads", options.threads, "threads; default OMP_NUM_THREADS")->check(CLI::Range(1, 4096));
    in_folder(command->add_option("--json", options.json, "write the results as JSON"));
    in_folder(command->add_option("--table", options.table, "write the table as text, without times"));
    command->add_option("--against", options.against, "compare with a table written before: fails where one differs")
        ->check(CLI::ExistingFile);
    CLI::Option* figure = in_folder(command->add_option(
        "--figure", options.figure,
        "draw error over run time beside other codes; of clay_flume, blocks_2, blocks_3: how their blocks "
        "end (PNG)"));
    CLI::Option* study = command->add_flag("--study", options.study, "change one component of the scheme at a time");
    exclude_all_but(*command, list, {});
    exclude_all_but(*command, figure, {"NAME", "--threads"});
    exclude_all_but(*command, study, {"--table", "--threads"});
    command->callback([&] { action = [&] { return verify_command(options); }; });
}

void add_bench(CLI::App& app, BenchOptions& options, Action& action) {
    CLI::App* command = app.add_subcommand("bench", "cost of a step by phase, beside the machine's own speed");
    in_folder(command->add_option("--json", options.json, "write the results as JSON"));
    command->add_option("--particles", options.particles, "N,N,...; default 70000,500000,4000000")->delimiter(',');
    command->add_option("--threads", options.threads, "N,N,...; default 1,2")->delimiter(',');
    command->add_flag("--quick", options.quick, "fewer rounds, no more than 500000 particles, no wide grid");
    command->callback([&] { action = [&] { return bench_command(options); }; });
}

/// A case under watch in place of random scenes: their options say nothing of it, nor its own of them.
void add_watched_case(CLI::App& command, FuzzOptions& options) {
    CLI::Option* watched = command.add_option("--case", options.case_file, "watch this case instead");
    exclude_all_but(command, watched, {});
    const std::vector<CLI::Option*> of_it{
        numeric(command.add_option("--steps", options.steps, "of that case; default 100"), kAboveZero),
        command.add_flag("--rests", options.rests, "nothing in that case may move"),
        command.add_option("--mirror", options.mirror, "that case is its own mirror image: x, y or diagonal"),
        command.add_flag("--same-threads", options.same_threads,
                         "one thread and two must give that case the same bits"),
        command.add_flag("--same-resumed", options.same_resumed,
                         "saved half way and resumed it must end with the same bits")};
    for (CLI::Option* option : of_it) option->needs(watched);
}

void add_fuzz(CLI::App& app, FuzzOptions& options, Action& action) {
    CLI::App* command = app.add_subcommand("stress", "random hostile scenes; invariants checked each step");
    numeric(command->add_option("--seconds", options.seconds, "wall time for running scenes; default 60"), kAboveZero);
    command->add_option(
        "--model", options.models,
        "what carries the scenes: all (the default), or with commas between them depth_averaged, mpm3d "
        "(3D points), structured, water, mixture (structured particles and water), staged, flood (water alone)");
    numeric(command->add_option("--seed", options.seed, "of the series; default 1"), kFromZero);
    numeric(command->add_option("--scenes", options.scenes, "at most so many; default as many as the time allows"),
            kAboveZero);
    numeric(command->add_option("--first", options.first, "number of the first scene of the series; default 0"),
            kFromZero);
    numeric(command->add_option("--shrunk", options.shrunk, "failures that are shrunk and saved; default 20"),
            kFromZero);
    in_folder(command->add_option("--json", options.json, "write the results as JSON"));
    command->add_option("--out", options.out, "folder for cases of failing scenes; default out/stress");
    command->add_option("--known", options.known,
                        "list of known failures (SEED MODEL SCENE INVARIANT): only others count");
    CLI::Option* cfl_map =
        command->add_flag("--cfl-map", options.cfl_map, "find the largest stable scheme.cfl of each scheme instead");
    exclude_all_but(*command, cfl_map, {});
    in_folder(command->add_option("--figure", options.figure, "draw that map (PNG)"))->needs(cfl_map);
    add_watched_case(*command, options);
    command->callback([&] { action = [&] { return fuzz_command(options); }; });
}

/// CLI11 alone would only say that a command is missing.
void refuse_unknown(const CLI::App& app, const std::string& word) {
    std::vector<std::string> names;
    std::string listed;
    for (const CLI::App* command : app.get_subcommands(nullptr)) {
        names.push_back(command->get_name());
        listed += (listed.empty() ? "" : ", ") + command->get_name();
    }
    const bool known = std::find(names.begin(), names.end(), word) != names.end();
    if (known || word.empty() || word[0] == '-') return;
    const std::string near = closest(word, names);
    throw UserError(fmt::format("command line: found the unknown command \"{}\"; expected one of {}; {}", word, listed,
                                near.empty() ? "see `frana --help`" : "did you mean " + near + "?"));
}

/// CLI11 takes what stands behind an option for its value, also another option: `--out --quiet` is a folder's name to it.
void refuse_options_as_values(CLI::App& app) {
    const auto mistake = [](const std::string& value) {
        return value.rfind("--", 0) == 0 ? "its value is missing before " + value : std::string();
    };
    for (CLI::App* command : app.get_subcommands(nullptr))
        for (CLI::Option* option : command->get_options())
            if (option->get_expected_min() > 0) option->check(mistake, "");
}

/// Parses the command line and does what it says.
int run_program(int argc, char** argv) {
    CLI::App app("frana: landslides with the depth-averaged material point method", "frana");
    app.require_subcommand(1);
    app.set_version_flag("--version", version_text);
    RunOptions run;
    ConvergeOptions converge;
    EnsembleOptions ensemble;
    CalibrateOptions calibrate;
    CheckOptions check;
    DescribeOptions describe;
    ParticlesOptions particles;
    ConvertOptions convert;
    FiguresOptions figures;
    std::string size;
    CompareOptions compare;
    StatesOptions states;
    VerifyOptions verify;
    BenchOptions bench;
    FuzzOptions fuzz;
    Action action;
    add_run(app, run, action);
    add_converge(app, converge, action);
    add_ensemble(app, ensemble, action);
    add_calibrate(app, calibrate, action);
    add_check(app, check, action);
    add_describe(app, describe, action);
    add_particles(app, particles, action);
    add_convert(app, convert, action);
    add_figures(app, figures, size, action);
    add_compare(app, compare, action);
    add_states(app, states, action);
    add_verify(app, verify, action);
    add_bench(app, bench, action);
    add_fuzz(app, fuzz, action);
    refuse_options_as_values(app);
    if (argc > 1) refuse_unknown(app, argv[1]);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {  // CLI11 also throws for help and version
        if (error.get_exit_code() == 0) return app.exit(error);
        throw UserError(
            fmt::format("command line: found a mistake: {}; expected a command with its arguments; see "
                        "`frana --help`, or --help behind the command",
                        error.what()));
    }
    return action();
}

/// Threads of OpenMP spin for milliseconds before they sleep. With other work on the machine the others would compute
/// in that time. Measured: 25 times slower with two threads on two busy cores. They are told to sleep soon, unless the
/// environment has a wish of its own. The runtime reads the environment once. This comes before, where it is a part of
/// the program (CMakeLists.txt), and elsewhere is in vain.
[[gnu::constructor(101)]] void wait_briefly() {
    if (!std::getenv("OMP_WAIT_POLICY")) setenv("GOMP_SPINCOUNT", "1000", 0);
}

int complain(const Failure& failure) {
    std::cout << std::flush;
    std::cerr << failure.text << '\n';
    if (failure.problems > 1) std::cerr << failure.problems << " problems\n";
    return failure.code;
}

}  // namespace
}  // namespace frana

int main(int argc, char** argv) {
    try {
        return frana::run_program(argc, argv);
    } catch (...) {
        return frana::complain(frana::failure_of(std::current_exception()));
    }
}
