// The functions of vtk_io as the program has them. Each opens the module, if no other did, and calls the one there.
#include <dlfcn.h>
#include <fmt/core.h>

#include <new>
#include <string>

#include "base/error.h"
#include "base/version.h"
#include "vtk_io/module/functions.h"
#include "vtk_io/module/same_build.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

/// Whether the loader found a library, and no room for it.
bool tells_of_memory(const std::string& why) {
    for (const char* const part : {"failed to map segment", "llocate memory", "memory protection", "out of memory"})
        if (why.find(part) != std::string::npos) return true;
    return false;
}

/// It is found where the program's run path points. It stays open, and global: Python's own modules resolve names in it
/// when a Catalyst script imports them.
const VtkFunctions& open_module() {
    const char* const way_out =
        "expected the part of frana that draws pictures and knows VTK's files, of the same build; install it with the "
        "program, or leave \"vtk\" and \"png\" out of output.formats";
    void* const module = dlopen(FRANA_VTK_MODULE, RTLD_LAZY | RTLD_GLOBAL);
    using Face = decltype(&frana_vtk_functions);
    const auto face = module ? reinterpret_cast<Face>(dlsym(module, "frana_vtk_functions")) : nullptr;
    if (!face) {
        const char* const why = dlerror();
        if (tells_of_memory(why)) throw std::bad_alloc();
        throw UserError(fmt::format("{}; {}", why, way_out));
    }
    const VtkFunctions& functions = *face();
    const std::string expected = FRANA_VERSION " " FRANA_SAME_BUILD;
    if (functions.build != expected || functions.size != sizeof(VtkFunctions))
        throw UserError(fmt::format("{}: found that of another build, {}, where the program is {}; {}",
                                    FRANA_VTK_MODULE, functions.build, expected, way_out));
    return functions;
}

const VtkFunctions& vtk() {
    static const VtkFunctions& functions = open_module();
    return functions;
}

/// Pictures tell why there are none, and the run goes on without them.
template <class Figure>
bool rendered(bool (*VtkFunctions::*render)(const Figure&, const fs::path&, std::string&), const Figure& figure,
              const fs::path& png, std::string& why_not) {
    const VtkFunctions* functions = nullptr;
    try {
        functions = &vtk();
    } catch (const UserError& error) {
        why_not = error.what();
        return false;
    }
    return (functions->*render)(figure, png, why_not);
}

}  // namespace

std::unique_ptr<Observer> make_particle_writer(const fs::path& run_dir) { return vtk().make_particle_writer(run_dir); }
std::unique_ptr<Observer> make_grid_writer(const fs::path& run_dir) { return vtk().make_grid_writer(run_dir); }
std::unique_ptr<Observer> make_profile_writer(const fs::path& run_dir, std::vector<ProfileLine> lines) {
    return vtk().make_profile_writer(run_dir, std::move(lines));
}
std::unique_ptr<Observer> make_barrier_writer(const fs::path& run_dir, std::vector<BarrierTop> tops, Raster bed) {
    return vtk().make_barrier_writer(run_dir, std::move(tops), std::move(bed));
}
void write_barrier_meshes(const fs::path& run_dir, const BarrierMeshes& meshes) {
    vtk().write_barrier_meshes(run_dir, meshes);
}
void write_terrain(const fs::path& run_dir, const Raster& bed) { vtk().write_terrain(run_dir, bed); }
void write_terrain_maps(const fs::path& dir, const Raster& bed, const std::vector<NamedMap>& maps) {
    vtk().write_terrain_maps(dir, bed, maps);
}
void write_survey(const fs::path& run_dir, const Raster& bed, const Raster& depth, double limit, const Rings& survey) {
    vtk().write_survey(run_dir, bed, depth, limit, survey);
}
void write_seeds_vtp(const fs::path& file, const SeedsExport& data) { vtk().write_seeds_vtp(file, data); }
void write_points_vtp(const fs::path& file, const PointTable& table, const double* places) {
    vtk().write_points_vtp(file, table, places);
}

std::vector<PvdEntry> read_pvd(const fs::path& pvd) { return vtk().read_pvd(pvd); }
std::vector<double> frame_times(const fs::path& run_dir) { return vtk().frame_times(run_dir); }
std::vector<double> particle_times(const fs::path& run_dir) { return vtk().particle_times(run_dir); }
Index nearest_frame(const fs::path& run_dir, double time) { return vtk().nearest_frame(run_dir, time); }
LoadedFrame read_frame(const fs::path& run_dir, Index number, const std::vector<std::string>& only) {
    return vtk().read_frame(run_dir, number, only);
}
LoadedParticles read_particles(const fs::path& run_dir, Index number) { return vtk().read_particles(run_dir, number); }
LoadedFrame read_terrain(const fs::path& run_dir) { return vtk().read_terrain(run_dir); }
LoadedFrame read_maps(const fs::path& dir) { return vtk().read_maps(dir); }
ProfileShape profile_shape(const fs::path& run_dir) { return vtk().profile_shape(run_dir); }
std::vector<double> barrier_times(const fs::path& run_dir) { return vtk().barrier_times(run_dir); }
std::vector<LoadedPatch> read_barriers(const fs::path& run_dir, Index number) {
    return vtk().read_barriers(run_dir, number);
}
BarrierMeshes read_barrier_meshes(const fs::path& run_dir) { return vtk().read_barrier_meshes(run_dir); }
std::optional<std::array<double, 4>> bounds_of(const fs::path& vtp) { return vtk().bounds_of(vtp); }

/// Most cases have no mesh, and open nothing.
MeshReader barrier_meshes_told(std::function<void(const std::string&)> say) {
    return [say = std::move(say)](const fs::path& file, const MeshSampling& sampling) {
        return vtk().barrier_meshes_told(say)(file, sampling);
    };
}
MeshField barrier_mesh_of(const fs::path& file, const MeshSampling& sampling) {
    return vtk().barrier_mesh_of(file, sampling);
}
TriangleMesh barrier_triangles(const fs::path& file, const Vec3& origin) {
    return vtk().barrier_triangles(file, origin);
}

std::vector<std::pair<double, Polyline>> level_lines_of(const Frame& frame, const std::string& field,
                                                        const std::vector<double>& levels) {
    return vtk().level_lines_of(frame, field, levels);
}
std::unique_ptr<InsituWork> make_contours(const fs::path& folder, const std::string& name, const std::string& field,
                                          const std::vector<double>& levels) {
    return vtk().make_contours(folder, name, field, levels);
}
std::vector<std::uint8_t> cells_within(const Frame& frame, const std::string& field, const Interval& kept) {
    return vtk().cells_within(frame, field, kept);
}
std::unique_ptr<InsituWork> make_cell_threshold(const fs::path& folder, const std::string& name,
                                                const std::string& field, const Interval& kept) {
    return vtk().make_cell_threshold(folder, name, field, kept);
}
std::unique_ptr<InsituWork> make_particle_threshold(const fs::path& folder, const std::string& name,
                                                    const std::string& field, const Interval& kept) {
    return vtk().make_particle_threshold(folder, name, field, kept);
}
void check_catalyst(const fs::path& script, const std::string& place) { vtk().check_catalyst(script, place); }
std::unique_ptr<InsituWork> make_catalyst(const fs::path& script) { return vtk().make_catalyst(script); }

/// For `frana --version`, which tells that there is none.
std::string vtk_version() {
    try {
        return vtk().vtk_version();
    } catch (const UserError& error) {
        return fmt::format("none ({})", error.what());
    }
}

std::vector<BarrierSolid> barrier_solids(const std::vector<LoadedPatch>& patches, const std::vector<BarrierTop>& tops,
                                         const Raster& bed, const BarrierMeshes& meshes) {
    return vtk().barrier_solids(patches, tops, bed, meshes);
}
ViewAngles3d best_view(const Figure3d& figure) { return vtk().best_view(figure); }
bool render_3d(const Figure3d& figure, const fs::path& png, std::string& why_not) {
    return rendered(&VtkFunctions::render_3d, figure, png, why_not);
}
bool render_section(const Figure3d& figure, const fs::path& png, std::string& why_not) {
    return rendered(&VtkFunctions::render_section, figure, png, why_not);
}
bool render_chart(const ChartFigure& figure, const fs::path& png, std::string& why_not) {
    return rendered(&VtkFunctions::render_chart, figure, png, why_not);
}
bool render_map(const MapFigure& figure, const fs::path& png, std::string& why_not) {
    return rendered(&VtkFunctions::render_map, figure, png, why_not);
}
bool render_perspective(const PerspectiveFigure& figure, const fs::path& png, std::string& why_not) {
    return rendered(&VtkFunctions::render_perspective, figure, png, why_not);
}
bool render_filmstrip(const Filmstrip& strip, const fs::path& png, std::string& why_not) {
    return rendered(&VtkFunctions::render_filmstrip, strip, png, why_not);
}

}  // namespace frana
