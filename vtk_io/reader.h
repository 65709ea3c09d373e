#pragma once
// Frames read back from the VTK files of a run directory, for figures and comparisons made after the run.
#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/types.h"
#include "terrain/raster.h"
#include "terrain/triangle_mesh.h"

namespace frana {

/// Node arrays of one output frame, as stored (float32 precision).
struct LoadedFrame {
    Index number = 0;   ///< 0, 1, 2, ... position in grid.pvd
    double time = 0.0;  ///< [s]
    GridGeometry grid;
    /// grid.size() * components numbers per name, components interleaved, row 0 = south. "elevation" is NaN
    /// where there is no terrain, as it was in the run. Other arrays hold their stand-in there, and "outside" is 1
    /// (writers.h).
    std::map<std::string, std::vector<double>> nodes;
    std::map<std::string, int> components;
    std::map<std::string, std::string> units;
    std::vector<std::string> names;  ///< of all arrays in the file, read or not

    bool has(const std::string& name) const { return nodes.count(name) != 0; }
};

/// Particle arrays of one output frame; "position" holds x, y, z.
struct LoadedParticles {
    Index number = 0;
    double time = 0.0;
    Index count = 0;
    std::map<std::string, std::vector<double>> arrays;  ///< count * components numbers, interleaved
    std::map<std::string, int> components;
    std::map<std::string, std::string> units;
};

/// Times [s] of the frames in RUN_DIR/grid.pvd, in order. Throws UserError when it is missing or not a .pvd.
std::vector<double> frame_times(const std::filesystem::path& run_dir);

/// The same of RUN_DIR/particles.pvd.
std::vector<double> particle_times(const std::filesystem::path& run_dir);

/// Position in frame_times of the frame nearest to `time`. Throws UserError when there is no frame.
Index nearest_frame(const std::filesystem::path& run_dir, double time);

/// Frame `number` of RUN_DIR/grid.pvd; negative counts from the end (-1 is the last one).
/// Throws UserError when there is no such frame or its file cannot be read.
/// With names in `only`, the arrays of these names alone, the elevation and where the terrain ends.
LoadedFrame read_frame(const std::filesystem::path& run_dir, Index number, const std::vector<std::string>& only = {});

/// The same frame of RUN_DIR/particles.pvd.
LoadedParticles read_particles(const std::filesystem::path& run_dir, Index number);

/// RUN_DIR/terrain.vti as a frame at time 0: "elevation" (NaN: no terrain), "slope", "hillshade".
LoadedFrame read_terrain(const std::filesystem::path& run_dir);

/// maps.vti of an ensemble's folder, likewise.
LoadedFrame read_maps(const std::filesystem::path& dir);

/// The first profile of a run, over at most seven of its frames.
struct ProfileShape {
    std::vector<double> elevation;  ///< at its stations in the first frame [m]
    double deepest = 0.0;           ///< flow on it, or how far its surface is from the first frame's bed [m]
};

/// Of RUN_DIR/profiles.pvd; empty when the profile has no station. UserError when a file is missing or damaged.
ProfileShape profile_shape(const std::filesystem::path& run_dir);

/// A square of a barrier's face with its load (writers.h).
struct LoadedPatch {
    int barrier = 0, face = 0;
    std::array<Vec3, 4> corners;  ///< [m]; from the first to the second to the right, to the last upwards
    double pressure = 0.0;        ///< mean since the frame before [Pa]
};

/// Times of RUN_DIR/barriers.pvd, in order; none when the run has no such file.
std::vector<double> barrier_times(const std::filesystem::path& run_dir);

/// The faces in frame `number` of RUN_DIR/barriers.pvd. UserError when there is no such frame or no file of it.
std::vector<LoadedPatch> read_barriers(const std::filesystem::path& run_dir, Index number);

/// The meshes in RUN_DIR/barrier_meshes.vtp (writers.h) by the number of their barrier; none when the run has no such
/// file. UserError when it cannot be read.
BarrierMeshes read_barrier_meshes(const std::filesystem::path& run_dir);

/// [xmin, ymin, xmax, ymax] of the points of a .vtp file; nothing when it has none.
std::optional<std::array<double, 4>> bounds_of(const std::filesystem::path& vtp);

}  // namespace frana
