#include "scene/memory_need.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "scene/stage_reach.h"

namespace frana {
namespace {

/// What a run needs at its peak: of libraries, and for each node and particle.
struct Rates {
    double base, node, particle;
};
/// From 36 runs of the case `bindo` (cells of 1.5 to 4 m, 20 000 to 400 000 particles).
constexpr Rates solver_rates{85e6, 315.0, 431.0};
constexpr Rates vtk_rates{4e6, 240.0, 388.0};  ///< besides, for VTK's frames: the grid or the particles
/// On a part of a terrain most nodes are never reached or shown, and have a bed only. From two runs on parts of 2.7 and
/// 34 million nodes.
constexpr double part_node_rate = 160.0;
/// Besides, for each node of solids that hold together, and of free water (4 million nodes). With the bed's curvature,
/// five numbers and three: 1630 and 2440 MB in all.
constexpr double structure_rate = 75.0, water_rate = 200.0;
/// Likewise of an erodible bed: seven numbers with its depth, two more where the bed's smoothing follows.
constexpr double erodible_rate = 56.0, path_rate = 16.0, deposition_rate = 16.0, forest_rate = 16.0, raised_rate = 8.0;
/// Besides, for each particle that exchanges mass with the bed: six numbers, and the weights of its sub-points on nodes.
constexpr double exchange_rate = 48.0 + 136.0 * 9.0 / 8.0;
constexpr double graphics_need = 250e6;  ///< besides, for pictures: software OpenGL, 200 to 310 MB in ten cases

/// A 3D grid has an entry for each of its tiles, and storage of those that are reached only.
constexpr double tile_nodes_3d = 512.0, bytes_per_tile_3d = 16.0;

/// For each node of the terrain with a 3D stage: its own copy of the bed, the points' ground, their depth for
/// particles, and marks. Besides, for each that points can give to: what stands there, its peaks, and particles beside
/// them.
constexpr double stage_rate = 3.0 * sizeof(double) + 2.0, points_map_rate = 18.0 * sizeof(double);

double memory_of_map(const Scene& scene) {
    const NodeBox box = nodes_of_points(scene);
    return points_map_rate * double(box.nx * box.ny);
}

double tiles_3d(const Scene& scene) {
    const SolidStage& stage = *scene.solid;
    const double cell = scene.bed.geometry.cell;
    const double across = static_cast<double>(stage.window[2] - stage.window[0] + 1) * cell / stage.cell;
    const double along = static_cast<double>(stage.window[3] - stage.window[1] + 1) * cell / stage.cell;
    double low = INFINITY, high = -INFINITY;
    for (Index j = stage.window[1]; j <= stage.window[3]; ++j)
        for (Index i = stage.window[0]; i <= stage.window[2]; ++i) {
            low = std::fmin(low, scene.bed.at(i, j));
            high = std::fmax(high, scene.bed.at(i, j));
        }
    const double up = std::max(0.0, stage.top.value_or(high) - low) / stage.cell;
    return (across + 1.0) * (along + 1.0) * (up + 1.0) / tile_nodes_3d;
}

}  // namespace

MemoryNeed memory_need(double nodes, double particles, bool vtk) {
    MemoryNeed need;
    need.base = solver_rates.base;
    need.nodes = solver_rates.node * nodes;
    need.particles = solver_rates.particle * particles;
    if (!vtk) return need;
    need.base += vtk_rates.base;
    double& larger = nodes * vtk_rates.node > particles * vtk_rates.particle ? need.nodes : need.particles;
    larger += std::max(nodes * vtk_rates.node, particles * vtk_rates.particle);
    return need;
}

double memory_of_part(double nodes) { return part_node_rate * nodes; }

double most_points(const Scene& scene) {
    const double full = std::pow(scene.solid->spacing, 3);
    double points = 0.0;
    for (const double volume : scene.particles.volume) points += std::max(1.0, volume / full);
    return std::ceil(points);
}

/// Of the laws of nodes, in the scene and in the solver [bytes].
double memory_of(const Friction& friction, double nodes) {
    const auto of = [nodes](const auto& map) {
        if (map.place.empty()) return 0.0;
        const double places = 2.0 * sizeof(std::uint32_t) * nodes;
        return places + std::visit(
                            [](const auto& table) {
                                using Law = typename std::decay_t<decltype(table)>::value_type;
                                return (2.0 * sizeof(Law) + sizeof(double)) * double(table.size());
                            },
                            map.laws);
    };
    return of(friction.laws) + of(friction.rheologies) + of(friction.water);
}

/// Particles begin from a copy of the fields that barriers stand in.
double memory_of_fields_among_barriers(const Scene& scene, double nodes) {
    const double fields =
        1.0 + (scene.erodible ? 1.0 : 0.0) + (scene.forest ? 1.0 : 0.0);  // the bed, and those of nodes
    return sizeof(double) * fields * nodes;
}

double memory_of_fields(const Scene& scene, double nodes) {
    double bytes = 0.0;
    if (scene.bed_changes()) bytes += (scene.bed_evolves() ? erodible_rate + path_rate : erodible_rate) * nodes;
    if (scene.deposition || scene.forest) bytes += (deposition_rate + (scene.erodible ? raised_rate : 0.0)) * nodes;
    if (scene.forest) bytes += forest_rate * nodes;
    if (scene.friction) bytes += memory_of(*scene.friction, nodes);
    if (scene.solid) bytes += stage_rate * nodes;
    if (!scene.barriers.empty() && !scene.solid) bytes += memory_of_fields_among_barriers(scene, nodes);
    return bytes;
}

MemoryNeed memory_need(const Scene& scene) {
    const double nodes = double(scene.bed.geometry.size());
    double particles = 0.0;
    for (const Seeds* seeds : scene.all_particles()) particles += double(seeds->count());
    MemoryNeed need = memory_need(scene.wider ? 0.0 : nodes, particles, scene.output.vtk);
    if (scene.wider) need.nodes = memory_of_part(nodes);
    need.nodes += memory_of_fields(scene, nodes);
    if (scene.erodible || scene.deposition || scene.forest) need.particles += exchange_rate * particles;
    if (scene.structure) need.nodes += structure_rate * nodes;
    if (scene.water) need.nodes += water_rate * nodes;
    const bool draws = std::any_of(scene.insitu.begin(), scene.insitu.end(),
                                   [](const Insitu& entry) { return kind_word(entry.kind) == std::string("figure"); });
    if (scene.output.png || draws) need.base += graphics_need;
    if (!scene.solid) return need;
    need.nodes += memory_of_map(scene);
    need.space = bytes_per_point * most_points(scene) + bytes_per_tile_3d * tiles_3d(scene);
    return need;
}

std::string memory_sentence(double needed, double free, const MemoryUse& use) {
    return fmt::format("{}: {} need {:.3g} GB; expected what fits into the {:.3g} GB that are free; {}", use.place,
                       use.what, needed / 1e9, free / 1e9, use.way_out);
}

void require_memory(double needed, double free, const MemoryUse& use) {
    if (needed > free) throw UserError(memory_sentence(needed, free, use));
}

}  // namespace frana
