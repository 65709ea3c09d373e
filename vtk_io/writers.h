#pragma once
// VTK files of a run, written while it goes on: .vtp particles, .vti grid and terrain, .pvd series. Numbers
// are written with LZ4 in inline base64. Every array `name` has its unit in the field data as `name_unit`, and each
// file its time as TimeValue. Every file appears whole or not at all.
//
// Where some nodes have no terrain (NaN elevation) the grid gets two more arrays. They are `outside` (uint8, 1 there)
// and vtkGhostType HIDDENPOINT. ParaView's surfaces and warped surfaces leave out the cells that touch hidden nodes by
// themselves. Its Slice representation and Threshold ignore hidden nodes and need `outside`. The elevation of such
// nodes in the file is the smallest of the window. So ranges stay those of the terrain.
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "observe/observer.h"
#include "observe/profiles.h"
#include "terrain/raster.h"
#include "terrain/triangle_mesh.h"
#include "vtk_io/barrier_top.h"

namespace frana {

/// particles.pvd and particles/particles_NNNNNN.vtp: vtkPolyData, points in double at "position", one vertex
/// cell a particle. Every other field of particles is an array. observe() throws UserError when a file cannot be
/// written (path and reason), NumericsError for a number that is not finite.
std::unique_ptr<Observer> make_particle_writer(const std::filesystem::path& run_dir);

/// grid.pvd and grid/grid_NNNNNN.vti: vtkImageData of one layer, point data at the nodes (z = 0). Errors as
/// above.
std::unique_ptr<Observer> make_grid_writer(const std::filesystem::path& run_dir);

/// profiles.pvd and profiles/profiles_NNNNNN.vtp: a line for each profile, points on the bed at its stations. Stations
/// without terrain are left out (observe/profiles.h). Point data `distance`, `elevation`, `depth`, `surface`,
/// `initial_surface`, `initial_elevation` (of the first frame) [m], `velocity_along` [m/s]. Cell data `profile` (0, 1, ... as in `lines`).
/// Their names are in the field data, `profile_names`. Errors as above.
std::unique_ptr<Observer> make_profile_writer(const std::filesystem::path& run_dir, std::vector<ProfileLine> lines);

/// barriers.pvd and barriers/barriers_NNNNNN.vtp, from the first frame on that has loads of barriers. They hold faces
/// in squares of about a cell of the 3D model. Cell data `pressure` (mean since the frame before, across the face),
/// `peak_pressure` (largest of these) [Pa], `impulse_per_area` [Pa s], `area` [m2], `barrier`, `face`. The area
/// is that which material can reach, where ground or an edge cuts the square: pressure times area is the force across it.
/// Squares of a top's box that
/// are not on the top are left out until a force acts on them. Sides may reach far into the ground, and above a top
/// that follows it. Point data `to_true_height` [m] is to be added to a corner's elevation. It puts the corner between
/// half a patch below the ground (`bed`) and the barrier's top. A barrier without an entry in `tops` is as high as its
/// faces. Without a bed all stay where they are. Errors as above.
std::unique_ptr<Observer> make_barrier_writer(const std::filesystem::path& run_dir, std::vector<BarrierTop> tops = {},
                                              Raster bed = {});

/// barrier_meshes.vtp: the triangles of barriers that were given as meshes, in map coordinates; cell data `barrier` as
/// above. No file without any. UserError as above.
void write_barrier_meshes(const std::filesystem::path& run_dir, const BarrierMeshes& meshes);

/// terrain.vti: "elevation" [m], "slope" [degree], "hillshade" [1, 0 dark to 1 bright] at the nodes of the
/// bed.
void write_terrain(const std::filesystem::path& run_dir, const Raster& bed);

/// Values at the nodes of a bed, without NaN.
struct NamedMap {
    std::string name, unit;
    std::vector<double> values;
};
/// maps.vti: "elevation" [m] and the maps at the nodes of the bed. UserError as above.
void write_terrain_maps(const std::filesystem::path& dir, const Raster& bed, const std::vector<NamedMap>& maps);

}  // namespace frana
