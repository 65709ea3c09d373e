// `frana particles`: the particle generation alone (Fois, de Falco, Formaggia 2025, Algorithm 1).
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <iostream>

#include "base/error.h"
#include "frana_commands.h"
#include "io/gdal_reader.h"
#include "io/hdf5_seeds.h"
#include "particles/export.h"
#include "scene/build_scene.h"
#include "vtk_io/seeds_vtp.h"

namespace frana {
namespace {

using Writer = void (*)(const std::filesystem::path&, const SeedsExport&);

/// The writer of a file name; known before any work is done.
Writer writer_of(const std::filesystem::path& file) {
    std::string extension = file.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (extension == ".h5" || extension == ".hdf5") return write_seeds_hdf5;
    if (extension == ".json") return write_seeds_json;
    if (extension == ".csv") return write_seeds_csv;
    if (extension == ".vtp") return write_seeds_vtp;
    throw UserError(
        fmt::format("--out {}: found the extension \"{}\"; expected .h5, .json, .csv or .vtp; name the "
                    "file after the format you want",
                    file.string(), extension));
}

std::vector<ReleaseReport> reports_of(const BuiltScene& built) {
    std::vector<ReleaseReport> reports;
    for (const ReleaseSummary& release : built.releases) reports.push_back(release.report);
    return reports;
}

}  // namespace

int particles_command(const ParticlesOptions& options) {
    const Writer write = writer_of(options.out);
    std::vector<std::string> sets = options.sets;
    if (options.count) sets.push_back(fmt::format("particles.count={}", *options.count));
    const BuiltScene built = build_scene_in_detail(CaseFile::read(options.case_file, sets), GdalReader());
    const Scene& scene = built.scene;
    for (const std::string& remark : scene.log) std::cout << remark << '\n';
    if (options.out.has_parent_path()) std::filesystem::create_directories(options.out.parent_path());
    write(options.out, make_seeds_export(scene.particles, scene.density, scene.bed));
    std::cout << conservation_table(reports_of(built));
    std::cout << fmt::format("{} particles in {}\n", scene.particles.count(), options.out.string());
    return 0;
}

}  // namespace frana
