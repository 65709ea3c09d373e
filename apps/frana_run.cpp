#include <fmt/core.h>
#include <omp.h>

#include <iostream>
#include <optional>

#include "base/atomic_file.h"
#include "base/error.h"
#include "frana_commands.h"
#include "frana_progress_lines.h"
#include "io/gdal_reader.h"
#include "run/folder/run_folder.h"
#include "run/folder/run_insitu.h"
#include "run/folder/run_job.h"
#include "run/folder/run_lock.h"
#include "run/simulation.h"
#include "scene/build_scene.h"
#include "vtk_io/barrier_mesh.h"
#include "vtk_io/writers.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

void shorten(Scene& scene, const std::optional<double>& until) {
    if (!until) return;
    if (!(*until > 0.0 && *until <= scene.end))
        throw UserError(
            fmt::format("--until: found {:.10g} s; expected a time above 0 and at most time.end = {:.10g} s; "
                        "--set time.end={:.10g} runs longer",
                        *until, scene.end, *until));
    scene.end = *until;
}

std::string overrides(const RunOptions& options) {
    std::string text;
    for (const std::string& set : options.sets) text += fmt::format("{}--set {}", text.empty() ? "" : " ", set);
    if (options.until) text += fmt::format("{}--until {}", text.empty() ? "" : " ", *options.until);
    return text;
}

/// A failed run folder must not lose the case it was made from, so both come before the first step.
void keep_case(const CaseFile& file, const fs::path& run_dir) {
    std::error_code not_there;
    if (!fs::equivalent(file.file(), run_dir / "case.toml", not_there)) write_text(run_dir / "case.toml", file.text());
    write_text(run_dir / "resolved.toml", resolved_toml(file));
}

/// For pictures, which are drawn again when the files that the case names may have gone. A table of the case may have
/// made several barriers, but then it is no mesh: those with a mesh come in the same order here and there.
void keep_meshes(const CaseFile& file, const Scene& scene, const fs::path& run_dir) {
    BarrierMeshes meshes(scene.barriers.size());
    std::size_t i = 0;
    for (Index table = 0; table < file.count("barrier"); ++table) {
        const std::string prefix = fmt::format("barrier.{}.", table);
        if (!file.given(prefix + "mesh")) continue;
        while (!scene.barriers.at(i).shape) ++i;
        Vec3 origin(0, 0, 0);
        if (file.given(prefix + "origin")) origin = Vec3(file.numbers(prefix + "origin").data());
        meshes[i++] = std::make_shared<TriangleMesh>(barrier_triangles(file.path(prefix + "mesh"), origin));
    }
    write_barrier_meshes(run_dir, meshes);
}

void say_what_runs(const RunRecord& record, const fs::path& run_dir) {
    std::cout << fmt::format("{}: {} x {} nodes of {:.6g} m, {} particles, {:.6g} m3, {:.6g} s, {} thread{}; into {}\n",
                             record.title, record.grid.nx, record.grid.ny, record.grid.cell, record.particles,
                             record.release_volume, record.end, record.threads, record.threads == 1 ? "" : "s",
                             run_dir.string());
    for (const std::string& remark : record.warnings) std::cout << "  " << remark << '\n';
    std::cout << std::flush;
}

/// What people are told goes to the console only without --quiet and --progress json.
bool for_people(const RunOptions& options) { return !options.quiet && options.progress.empty(); }

void say_what_came(const RunRecord& record, const fs::path& run_dir, const RunOptions& options, ProgressLines& lines) {
    lines.result(record);
    if (for_people(options)) std::cout << closing_lines(record, run_dir) << std::flush;
}

Progress::Style style_of(const RunOptions& options) {
    return options.progress == "json" ? Progress::Style::json : Progress::fitting(options.quiet);
}

int run_case(const RunOptions& options, ProgressLines& lines) {
    if (options.threads > 0) omp_set_num_threads(options.threads);
    const CaseFile file = CaseFile::read(options.case_file, options.sets);
    const fs::path run_dir = options.out.empty() ? fs::path("out") / file.name() : options.out;
    lines.into(run_dir);
    const std::vector<fs::path> inputs = file.inputs();
    const Overwrite overwrite = options.overwrite ? Overwrite::yes : Overwrite::no;
    std::optional<RunLock> lock;
    if (fs::is_directory(run_dir)) lock.emplace(run_dir);
    if (!options.resume) require_room_for_run(run_dir, inputs, overwrite);  // before the work of building the scene
    const MeshReader meshes = barrier_meshes_told([&](const std::string& line) {
        if (for_people(options)) std::cout << line << std::endl;
    });
    Scene scene = build_scene(file, GdalReader(), meshes);
    shorten(scene, options.until);
    check_insitu(scene);
    const CheckpointLabels labels = checkpoint_labels(scene, file);
    std::unique_ptr<CheckpointFile> kept;
    if (options.resume) kept = open_checkpoint(run_dir, labels);
    const std::unique_ptr<Simulation> simulation =
        make_simulation(scene, options.resume ? Start::resumed : Start::placed);

    // Only now is the folder touched: what lies there survives a case that cannot run.
    if (!options.resume) {
        if (!lock) lock.emplace(run_dir);
        prepare_run_folder(run_dir, inputs, overwrite);
    }
    keep_case(file, run_dir);
    if (scene.output.vtk) keep_meshes(file, scene, run_dir);
    CheckpointKeeper keeper(run_dir, labels, std::chrono::duration<double>(60.0 * scene.output.checkpoint_minutes),
                            std::move(kept));

    RunRecord record = begin_record(scene, file);
    record.command_line = overrides(options);
    record.threads = omp_get_max_threads();
    lines.scene(record);
    if (for_people(options)) say_what_runs(record, run_dir);

    std::optional<Interrupt> own;
    if (!options.interrupt) own.emplace(Interrupt::Listen::signals);
    const Interrupt& interrupt = options.interrupt ? *options.interrupt : *own;
    Progress progress(std::cout, style_of(options), scene.density);
    record = carry_out(scene, *simulation, run_dir, std::move(record), interrupt, progress, &keeper);

    say_what_came(record, run_dir, options, lines);
    if (record.summary.failure) std::rethrow_exception(record.summary.failure);
    if (record.pictures_cut_off) throw Interrupted(cutoff_sentence(run_dir));
    return record.summary.reason == "interrupted" ? 130 : 0;
}

}  // namespace

int run_command(const RunOptions& options) {
    ProgressLines lines(options.progress, "run");
    return lines.around([&] { return run_case(options, lines); });
}

}  // namespace frana
