#include "run/folder/run_case.h"

#include <fmt/core.h>
#include <omp.h>

#include <chrono>

#include "base/atomic_file.h"
#include "base/error.h"
#include "io/gdal_reader.h"
#include "run/folder/run_insitu.h"
#include "run/folder/run_job.h"
#include "run/folder/run_page.h"
#include "scene/build_scene.h"
#include "vtk_io/barrier_mesh.h"
#include "vtk_io/writers.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

void shorten(Scene& scene, const std::optional<double>& until) {
    if (!until) return;
    if (!(*until > 0.0))  // NaN too: a program may give it
        throw UserError(
            fmt::format("--until: found {:.10g}; expected a time above 0 and at most time.end = {:.10g} s; give one",
                        *until, scene.end));
    if (*until > scene.end)
        throw UserError(
            fmt::format("--until: found {:.10g} s; expected a time above 0 and at most time.end = {:.10g} s; "
                        "--set time.end={:.10g} runs longer",
                        *until, scene.end, *until));
    scene.end = *until;
}

std::string overrides(const RunWishes& wishes) {
    std::string text;
    for (const std::string& set : wishes.sets) text += fmt::format("{}--set {}", text.empty() ? "" : " ", set);
    if (wishes.until) text += fmt::format("{}--until {}", text.empty() ? "" : " ", *wishes.until);
    return text;
}

/// A failed run folder must not lose the case it was made from, so both come before the first step.
void keep_case(const CaseFile& file, const fs::path& run_dir) {
    std::error_code not_there;
    if (!fs::equivalent(file.file(), run_dir / "case.toml", not_there)) write_text(run_dir / "case.toml", file.text());
    write_text(run_dir / "resolved.toml", resolved_toml(file));
}

/// For pictures, which are drawn again when the files that the case names may have gone. A table of the case may have
/// made several barriers, but then it is no mesh. Those with a mesh come in the same order here and there.
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

}  // namespace

Scene scene_to_run(const CaseFile& file, const std::optional<double>& until,
                   const std::function<void(const std::string&)>& say) {
    Scene scene = build_scene(file, GdalReader(), barrier_meshes_told(say));
    shorten(scene, until);
    check_insitu(scene);
    check_page(file);
    return scene;
}

CaseRun::CaseRun(const CaseFile& file, const RunWishes& wishes)
    : run_dir_(wishes.out.empty() ? fs::path("out") / file.name() : wishes.out) {
    const std::vector<fs::path> inputs = file.inputs();
    const Overwrite overwrite = wishes.overwrite ? Overwrite::yes : Overwrite::no;
    if (fs::is_directory(run_dir_)) lock_.emplace(run_dir_);
    if (!wishes.resume) require_room_for_run(run_dir_, inputs, overwrite);  // before the work of building the scene
    scene_ = scene_to_run(file, wishes.until, wishes.say);
    const CheckpointLabels labels = checkpoint_labels(scene_, file);
    std::unique_ptr<CheckpointFile> kept;
    if (wishes.resume) kept = open_checkpoint(run_dir_, labels);
    simulation_ = make_simulation(scene_, wishes.resume ? Start::resumed : Start::placed);

    // Only now is the folder changed: what lies there survives a case that cannot run.
    open_.emplace(run_dir_);
    if (!wishes.resume) {
        if (!lock_) lock_.emplace(run_dir_);
        prepare_run_folder(run_dir_, inputs, overwrite);
    }
    keep_case(file, run_dir_);
    if (scene_.output.vtk || asks_for_page(file)) keep_meshes(file, scene_, run_dir_);
    keeper_.emplace(run_dir_, labels, std::chrono::duration<double>(60.0 * scene_.output.checkpoint_minutes),
                    std::move(kept));
    record_ = begin_record(scene_, file);
    record_.command_line = overrides(wishes);
    record_.threads = omp_get_max_threads();
}

RunRecord CaseRun::carry_out(const Interrupt& interrupt, Progress& progress, Observers more,
                             std::vector<ProductRaster>* rasters) {
    return frana::carry_out(scene_, *simulation_, run_dir_, std::move(record_), interrupt, progress, &*keeper_,
                            std::move(more), rasters);
}

}  // namespace frana
