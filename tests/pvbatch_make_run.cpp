// Makes a small run directory from made-up frames, and the JSON of what a viewer has to find in it.
// Usage: pvbatch_make_run RUN_DIR EXPECTED.json
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <nlohmann/json.hpp>

#include "frame_maker.h"
#include "io/xdmf_writer.h"
#include "observe/file_arrays.h"
#include "vtk_io/reader.h"
#include "vtk_io/writers.h"

using namespace frana;
using nlohmann::json;

namespace {

/// Number of components, and smallest and largest finite value of each as a file holds it.
json array_of(const Field& field) {
    json ranges = json::array();
    for (int c = 0; c < field.components; ++c) {
        double least = INFINITY, most = -INFINITY;
        for (Index k = c; k < field.count * field.components; k += field.components) {
            const double value = storage_of(field) == Storage::float32
                                     ? static_cast<double>(static_cast<float>(field.data[k]))
                                     : field.data[k];
            if (std::isnan(value)) continue;
            least = std::min(least, value);
            most = std::max(most, value);
        }
        ranges.push_back({least, most});
    }
    return {{"components", field.components}, {"ranges", ranges}, {"unit", field.unit}};
}

json arrays_of(const std::vector<Field>& fields) {
    json arrays = json::object();
    for (const Field& field : fields)
        if (field.name != "position") arrays[field.name] = array_of(field);
    return arrays;
}

json particles_of(const Frame& frame) {
    if (frame.particle("position")->count == 0) return {{"points", 0}, {"cells", 0}};  // no ranges of nothing
    const json ranges = array_of(*frame.particle("position"))["ranges"];
    json bounds = json::array();
    for (const json& range : ranges) bounds.insert(bounds.end(), range.begin(), range.end());
    const Index count = frame.particle("position")->count;
    return {{"points", count}, {"cells", count}, {"bounds", bounds}, {"arrays", arrays_of(frame.particles)}};
}

json image_of_nodes(const GridGeometry& grid, const std::vector<Field>& fields) {
    return {{"points", grid.size()},
            {"cells", (grid.nx - 1) * (grid.ny - 1)},
            {"bounds", {grid.x0, grid.x_max(), grid.y0, grid.y_max(), 0.0, 0.0}},
            {"arrays", arrays_of(fields)}};
}

json make_terrain(const std::filesystem::path& run_dir, FrameMaker& maker) {
    Raster bed;
    bed.geometry = maker.frame.grid;
    bed.values = maker.node_numbers("elevation");
    write_terrain(run_dir, bed);
    const LoadedFrame terrain = read_terrain(run_dir);
    const auto& slope = terrain.nodes.at("slope");
    const auto& shade = terrain.nodes.at("hillshade");
    return image_of_nodes(bed.geometry, {*maker.frame.node("elevation"),
                                         {"slope", "degree", 1, slope.data(), bed.geometry.size()},
                                         {"hillshade", "1", 1, shade.data(), bed.geometry.size()}});
}

json make_run(const std::filesystem::path& run_dir) {
    std::filesystem::remove_all(run_dir);
    std::filesystem::create_directories(run_dir);
    const auto particles = make_particle_writer(run_dir);
    const auto grid = make_grid_writer(run_dir);
    const auto xdmf = make_xdmf_writer(run_dir);
    const GridGeometry nodes = FrameMaker::utm(90, 60);
    json times = json::array(), grids = json::array(), clouds = json::array(), terrain;
    for (const double time : {0.0, 10.0 / 3.0, 12.5}) {
        const auto number = static_cast<Index>(times.size());
        FrameMaker maker(number, time, 3000 - 1500 * number, nodes);
        maker.cut_corner();
        if (number == 0) terrain = make_terrain(run_dir, maker);
        for (const auto* writer : {&particles, &grid, &xdmf}) (*writer)->observe(maker.frame);
        times.push_back(time);
        grids.push_back(image_of_nodes(nodes, maker.frame.nodes));
        clouds.push_back(particles_of(maker.frame));
    }
    const json particle_series{{"times", times}, {"frames", clouds}};
    const json grid_series{{"times", times}, {"frames", grids}};
    return {{"particles.pvd", {{"particles", particle_series}}},
            {"grid.pvd", {{"grid", grid_series}}},
            {"terrain.vti", {{"terrain", {{"times", json::array()}, {"frames", {terrain}}}}}},
            {"run.xdmf", {{"particles", particle_series}, {"grid", grid_series}}}};
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3) {
        fmt::print(stderr, "usage: pvbatch_make_run RUN_DIR EXPECTED.json\n");
        return 2;
    }
    try {
        std::ofstream(argv[2]) << make_run(argv[1]).dump(1) << '\n';
    } catch (const std::exception& problem) {
        fmt::print(stderr, "{}\n", problem.what());
        return 1;
    }
    return 0;
}
