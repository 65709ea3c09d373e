#include "run/folder/run_state.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>
#include <utility>

#include "base/error.h"
#include "io/hdf5_particles.h"
#include "run/folder/products.h"
#include "vtk_io/pvd.h"
#include "vtk_io/reader.h"

namespace frana {
namespace fs = std::filesystem;

Index choose_frame(const std::vector<double>& times, double time, const fs::path& frames) {
    if (times.empty())
        throw UserError(fmt::format("{}: lists no frame yet; expected the frames of a run; wait for its first output",
                                    frames.string()));
    const double first = times.front(), last = times.back(), slack = 1e-9 * std::max(1.0, std::abs(last));
    const auto range = fmt::format("expected {:.6g} to {:.6g} s", first, last);
    if (!(time >= first - slack))
        throw UserError(fmt::format("--time {:.6g}: lies before the first frame of {}; {}; give a time of the run",
                                    time, frames.string(), range));
    if (time > last + slack)
        throw UserError(
            fmt::format("--time {:.6g}: is past the last frame of {}; {}; give a time of the run, or let the "
                        "run go further",
                        time, frames.string(), range));
    std::size_t nearest = 0;
    for (std::size_t k = 1; k < times.size(); ++k)
        if (std::abs(times[k] - time) < std::abs(times[nearest] - time)) nearest = k;
    return static_cast<Index>(nearest);
}

namespace {

/// Component c of an array.
template <class Loaded>
std::vector<double> component(const Loaded& loaded, const std::string& name, std::size_t c = 0) {
    const auto stride = static_cast<std::size_t>(loaded.components.at(name));
    const std::vector<double>& all = loaded.arrays.at(name);
    std::vector<double> values;
    values.reserve(all.size() / stride);
    for (std::size_t k = c; k < all.size(); k += stride) values.push_back(all[k]);
    return values;
}

/// What a state needs, with the number of components.
template <class Loaded>
void require_fields(const Loaded& loaded, const fs::path& frames) {
    std::string missing;
    for (const auto& [name, components] : {std::pair<const char*, int>{"position", 3},
                                           {"depth", 1},
                                           {"velocity", 3},
                                           {"mass", 1},
                                           {"volume", 1},
                                           {"pressure", 1}}) {
        const auto found = loaded.components.find(name);
        if (found == loaded.components.end() || found->second != components)
            missing += (missing.empty() ? "" : ", ") + std::string(name);
    }
    if (!missing.empty())
        throw UserError(
            fmt::format("{}: its particles have no {}; expected position, depth, velocity, mass, volume and "
                        "pressure; add them to output.fields and run the case again",
                        frames.string(), missing));
}

/// From a 3D stage on, what the frames call particles are 3D points.
template <class Loaded>
void require_particles(const Loaded& loaded, const fs::path& frames) {
    const auto model = loaded.arrays.find("model");
    if (model == loaded.arrays.end()) return;
    if (std::none_of(model->second.begin(), model->second.end(), [](double m) { return m != 0.0; })) return;
    throw UserError(
        fmt::format("{}: its particles are 3D points already at that time; expected depth-averaged ones; give a --time "
                    "before the stage in "
                    "space begins, or after it has ended",
                    frames.string()));
}

/// No file of ours has such numbers; one that was changed or damaged may.
void require_valid(const FlowParticles& particles, const fs::path& frames) {
    const auto refuse = [&](std::size_t p, const char* what, double found, const char* expected) {
        throw UserError(fmt::format("{}: {} of particle {} is {}; expected {}; run the case again", frames.string(),
                                    what, particles.id[p], found, expected));
    };
    for (std::size_t p = 0; p < particles.count(); ++p) {
        const std::pair<const char*, double> numbers[] = {
            {"depth", particles.depth[p]}, {"mass", particles.mass[p]},   {"volume", particles.volume[p]},
            {"velocity", particles.vx[p]}, {"velocity", particles.vy[p]}, {"pressure", particles.bed_pressure[p]},
            {"position", particles.x[p]},  {"position", particles.y[p]},  {"position", particles.bed[p]}};
        for (const auto& [what, number] : numbers)
            if (!std::isfinite(number)) refuse(p, what, number, "a finite number");
        if (particles.depth[p] < 0.0) refuse(p, "depth", particles.depth[p], "0 or more");
        if (particles.mass[p] <= 0.0) refuse(p, "mass", particles.mass[p], "more than 0");
        if (particles.volume[p] <= 0.0) refuse(p, "volume", particles.volume[p], "more than 0");
    }
}

/// The run's bed is smoother than the terrain (the scheme averages it over a cell). Where the run says how fast a particle
/// climbs, the slope along its way follows that.
void follow_climb(FlowParticles& particles, const std::vector<double>& climb) {
    if (std::all_of(climb.begin(), climb.end(), [](double w) { return w == 0.0; })) return;  // shallow terrain has none
    for (std::size_t p = 0; p < particles.count(); ++p) {
        const double vx = particles.vx[p], vy = particles.vy[p], v2 = vx * vx + vy * vy;
        if (!(v2 > 0.0) || !std::isfinite(climb[p])) continue;
        const double wrong = (climb[p] - vx * particles.slope_x[p] - vy * particles.slope_y[p]) / v2;
        particles.slope_x[p] += wrong * vx;
        particles.slope_y[p] += wrong * vy;
    }
}

template <class Loaded>
FlowParticles particles_of(const Loaded& loaded, const fs::path& frames) {
    require_fields(loaded, frames);
    require_particles(loaded, frames);
    FlowParticles particles;
    particles.x = component(loaded, "position", 0);
    particles.y = component(loaded, "position", 1);
    particles.bed = component(loaded, "position", 2);  // the free surface so far
    particles.depth = component(loaded, "depth");
    for (std::size_t p = 0; p < particles.count(); ++p) particles.bed[p] -= particles.depth[p];
    particles.vx = component(loaded, "velocity", 0);
    particles.vy = component(loaded, "velocity", 1);
    particles.mass = component(loaded, "mass");
    particles.volume = component(loaded, "volume");
    particles.bed_pressure = component(loaded, "pressure");
    particles.id = component(loaded, "id");
    if (loaded.components.count("stress") && loaded.components.at("stress") == 3)
        particles.stress = loaded.arrays.at("stress");
    require_valid(particles, frames);
    return particles;
}

Raster vtk_bed(const fs::path& run_dir) {
    LoadedFrame terrain = read_terrain(run_dir);
    Raster bed;
    bed.geometry = terrain.grid;
    bed.values = std::move(terrain.nodes.at("elevation"));
    bed.source = (run_dir / "terrain.vti").string();
    return bed;
}

/// The coordinate system of the run's rasters, where it wrote some.
std::string crs_of(const fs::path& run_dir) {
    const auto rasters = read_rasters(run_dir);
    return rasters.empty() ? "" : rasters.front().raster.crs_wkt;
}

UserError no_frames(const fs::path& run_dir, const char* file) {
    return UserError(
        fmt::format("{}: holds neither {} nor run.h5; expected the folder of a run with \"vtk\" or \"xdmf\" in "
                    "output.formats, such as the one after --out of frana run",
                    run_dir.string(), file));
}

/// Volume of free water in the frame of that time [m3].
double free_water_of(const fs::path& run_dir, double time) {
    if (!fs::exists(run_dir / "grid.pvd")) return 0.0;
    const LoadedFrame frame = read_frame(run_dir, nearest_frame(run_dir, time), {"water_depth"});
    const auto depth = frame.nodes.find("water_depth");
    if (depth == frame.nodes.end()) return 0.0;
    double sum = 0.0;
    for (const double h : depth->second)
        if (h > 0.0) sum += h;
    return sum * frame.grid.cell * frame.grid.cell;
}

RunState state_of_vtk(const fs::path& run_dir, double time) {
    RunState state;
    const fs::path list = run_dir / "particles.pvd";
    std::vector<double> times;
    for (const PvdEntry& entry : read_pvd(list)) times.push_back(entry.time);
    const Index number = choose_frame(times, time, list);
    const LoadedParticles particles = read_particles(run_dir, number);
    state.time = particles.time;
    state.particles = particles_of(particles, list);
    state.bed = vtk_bed(run_dir);
    state.free_water = free_water_of(run_dir, state.time);
    take_slopes(state.particles, state.bed);
    follow_climb(state.particles, component(particles, "velocity", 2));
    state.frames = list.string();
    return state;
}

/// A run that goes on changes the tables of run.h5 while they are read. A second try a moment later finds them whole.
template <class Read>
auto between_writes(Read&& read) {
    for (int look = 0; look < 9; ++look) {
        try {
            return read();
        } catch (const UserError&) {
            std::this_thread::sleep_for(std::chrono::milliseconds(20 << std::min(look, 4)));
        }
    }
    return read();
}

RunState state_of_hdf5(const fs::path& run_dir, double time) {
    RunState state;
    const fs::path file = run_dir / "run.h5";
    StoredParticles particles =
        between_writes([&] { return read_hdf5_particles(file, choose_frame(hdf5_frame_times(file), time, file)); });
    state.time = particles.time;
    state.particles = particles_of(particles, file);
    state.bed = std::move(particles.bed);
    take_slopes(state.particles, state.bed);
    follow_climb(state.particles, component(particles, "velocity", 2));
    state.frames = file.string();
    return state;
}

}  // namespace

RunState read_run_state(const fs::path& run_dir, double time) {
    const bool vtk = fs::exists(run_dir / "particles.pvd");
    if (!vtk && !fs::exists(run_dir / "run.h5")) throw no_frames(run_dir, "particles.pvd");
    RunState state = vtk ? state_of_vtk(run_dir, time) : state_of_hdf5(run_dir, time);
    if (state.particles.count() == 0)
        throw UserError(
            fmt::format("{}: has no particles at {:.6g} s: all is free water, or has left the terrain; give an earlier "
                        "--time",
                        state.frames, state.time));
    state.bed.crs_wkt = crs_of(run_dir);
    return state;
}

Raster bed_of_run(const fs::path& run_dir) {
    const bool vtk = fs::exists(run_dir / "terrain.vti");
    if (!vtk && !fs::exists(run_dir / "run.h5")) throw no_frames(run_dir, "terrain.vti");
    Raster bed =
        vtk ? vtk_bed(run_dir) : between_writes([&] { return read_hdf5_particles(run_dir / "run.h5", 0).bed; });
    bed.crs_wkt = crs_of(run_dir);
    return bed;
}

}  // namespace frana
