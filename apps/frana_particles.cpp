// `frana particles`: the particle generation alone (Fois, de Falco, Formaggia 2025, Algorithm 1).
#include <fmt/format.h>

#include <iostream>

#include "frana_commands.h"
#include "frana_export.h"
#include "io/gdal_reader.h"
#include "io/hdf5_seeds.h"
#include "particles/export.h"
#include "run/folder/run_folder.h"
#include "scene/build_scene.h"
#include "vtk_io/seeds_vtp.h"

namespace frana {
namespace {

using Writer = void (*)(const std::filesystem::path&, const SeedsExport&);

Writer writer_of(const std::string& format) {
    if (format == ".h5") return write_seeds_hdf5;
    if (format == ".json") return write_seeds_json;
    return format == ".csv" ? write_seeds_csv : write_seeds_vtp;
}

std::vector<ReleaseReport> reports_of(const BuiltScene& built) {
    std::vector<ReleaseReport> reports;
    for (const ReleaseSummary& release : built.releases) reports.push_back(release.report);
    return reports;
}

/// What the file holds, and what it has no place for: it says nothing of times.
std::string content_text(const Scene& scene, const std::filesystem::path& file) {
    Index late = 0;
    for (const LateRelease& release : scene.late) late += release.seeds.count();
    const Index there = scene.particles.count();
    if (late == 0) return fmt::format("{} particles in {}\n", there, file.string());
    return fmt::format("{} of {} particles in {}, those at the start; the {} that enter later are not in it\n", there,
                       there + late, file.string(), late);
}

}  // namespace

int particles_command(const ParticlesOptions& options) {
    const Writer write = writer_of(export_format(options.out));
    std::vector<std::string> sets = options.sets;
    if (options.count) sets.push_back(fmt::format("particles.count={}", *options.count));
    const CaseFile file = CaseFile::read(options.case_file, sets);
    require_no_input("--out", options.out, file.inputs());
    const BuiltScene built = build_scene_in_detail(file, GdalReader());
    const Scene& scene = built.scene;
    for (const std::string& remark : scene.log) std::cout << remark << '\n';
    make_folder_of(options.out);
    write(options.out, make_seeds_export(scene.particles, scene.density, scene.bed));
    std::cout << conservation_table(reports_of(built));
    std::cout << content_text(scene, options.out);
    return 0;
}

}  // namespace frana
