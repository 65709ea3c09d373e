#pragma once
// How much memory a run needs, told before it is allocated.
#include <string>

#include "scene/scene.h"

namespace frana {

/// Where the memory of a run goes [bytes].
struct MemoryNeed {
    double base = 0.0;       ///< libraries, and of pictures what draws them
    double nodes = 0.0;      ///< grows with the terrain's nodes
    double particles = 0.0;  ///< grows with the particles at the start
    double space = 0.0;      ///< 3D points if all of the release is in the window, and their grid's tiles
    double total() const { return base + nodes + particles + space; }
};

/// Of a run with so many nodes and particles; with `vtk` VTK writes its frames.
MemoryNeed memory_need(double nodes, double particles, bool vtk);
/// Of the nodes of a part of a terrain (scene/terrain_part.h), most of which are never reached [bytes].
double memory_of_part(double nodes);
/// The same for what a scene has besides on so many nodes: loose material, forest, friction that varies, a 3D stage [bytes].
double memory_of_fields(const Scene& scene, double nodes);
/// Of a scene that is built.
MemoryNeed memory_need(const Scene& scene);

/// 3D points if all of the release were in the window: one of each particle at least, or 8 a cell of (2 spacing)^3.
double most_points(const Scene& scene);
constexpr double bytes_per_point = 450.0;  ///< of 3D points

/// A key of the case with what it needs, and what would need less.
struct MemoryUse {
    std::string place, what, way_out;
};
/// "place: what need 56 GB; expected what fits into the 23 GB that are free; way out".
std::string memory_sentence(double needed, double free, const MemoryUse& use);
/// Throws UserError, with that sentence, when more bytes are needed than are free.
void require_memory(double needed, double free, const MemoryUse& use);

}  // namespace frana
