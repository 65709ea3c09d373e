#pragma once
// What the program calls of vtk_io and vtk_io/figures. The libraries of VTK take as long to load as a small run. So all
// that uses them is a module, which is opened at the first call (on_demand.cpp). Tests link the same functions
// directly.
#include "vtk_io/barrier_mesh.h"
#include "vtk_io/catalyst.h"
#include "vtk_io/figures/barriers_3d.h"
#include "vtk_io/figures/chart_figure.h"
#include "vtk_io/figures/figure_3d.h"
#include "vtk_io/figures/filmstrip.h"
#include "vtk_io/figures/map_figure.h"
#include "vtk_io/figures/map_figure_perspective.h"
#include "vtk_io/insitu.h"
#include "vtk_io/points_vtp.h"
#include "vtk_io/pvd.h"
#include "vtk_io/reader.h"
#include "vtk_io/seeds_vtp.h"
#include "vtk_io/survey_vtp.h"
#include "vtk_io/vtk_version.h"
#include "vtk_io/writers.h"

/// All of them; one that is missing here is an undefined reference of the program.
#define FRANA_VTK_FUNCTIONS(ROW) \
    ROW(make_particle_writer)    \
    ROW(make_grid_writer)        \
    ROW(make_profile_writer)     \
    ROW(make_barrier_writer)     \
    ROW(write_barrier_meshes)    \
    ROW(write_terrain)           \
    ROW(write_terrain_maps)      \
    ROW(write_survey)            \
    ROW(write_seeds_vtp)         \
    ROW(write_points_vtp)        \
    ROW(read_pvd)                \
    ROW(frame_times)             \
    ROW(particle_times)          \
    ROW(nearest_frame)           \
    ROW(read_frame)              \
    ROW(read_particles)          \
    ROW(read_terrain)            \
    ROW(read_maps)               \
    ROW(profile_shape)           \
    ROW(barrier_times)           \
    ROW(read_barriers)           \
    ROW(read_barrier_meshes)     \
    ROW(bounds_of)               \
    ROW(barrier_meshes_told)     \
    ROW(barrier_mesh_of)         \
    ROW(barrier_triangles)       \
    ROW(level_lines_of)          \
    ROW(make_contours)           \
    ROW(cells_within)            \
    ROW(make_cell_threshold)     \
    ROW(make_particle_threshold) \
    ROW(check_catalyst)          \
    ROW(make_catalyst)           \
    ROW(vtk_version)             \
    ROW(barrier_solids)          \
    ROW(best_view)               \
    ROW(render_3d)               \
    ROW(render_section)          \
    ROW(render_chart)            \
    ROW(render_map)              \
    ROW(render_perspective)      \
    ROW(render_filmstrip)

namespace frana {

/// A pointer to each of them.
struct VtkFunctions {
    // These two come first, so that they are read of any module.
    const char* build;  ///< version and FRANA_SAME_BUILD
    std::size_t size;   ///< of this struct: one with other functions is of another build
#define FRANA_VTK_ROW(name) decltype(&frana::name) name;  // NOLINT(bugprone-macro-parentheses): it is a name
    FRANA_VTK_FUNCTIONS(FRANA_VTK_ROW)
#undef FRANA_VTK_ROW
};

}  // namespace frana

/// The one symbol of the module that the program loads.
extern "C" const frana::VtkFunctions* frana_vtk_functions();
