#pragma once
// The cost of a scene's step, in nanoseconds per particle and step.
#include <cstdint>
#include <string>
#include <vector>

#include "scene/scene.h"
#include "shallow/particles.h"
#include "solid3d/mpm3d.h"
#include "structured/structured_points.h"

namespace frana::bench {

/// How long a scene is timed.
struct Plan {
    int threads = 1;
    int warm_steps = 6;    ///< before the first window: arrays have grown, caches are full
    int windows = 6;       ///< the fastest of these counts, with its phases
    int window_steps = 6;  ///< a multiple of three, so that each has its share of sorting, splitting and merging
};

/// Cost of a phase, or of the whole step ("full"); "other" is what the solver records under no phase.
struct PhaseCost {
    std::string name;
    double cpu_ns = 0.0;   ///< CPU time per particle and step: whole step: team_clock.h; phase: stepping thread
    double wall_ns = 0.0;  ///< wall time per particle and step
    double bytes = 0.0;    ///< memory traffic per particle and step, modelled (checks/bench/traffic.h)
};

struct Cost {
    std::vector<PhaseCost> phases;  ///< "full" first
    Index particles = 0;            ///< at the start
    Index particles_end = 0;
    Index steps = 0;
    int threads = 1;
    double bytes_per_particle = 0.0;  ///< memory that grows with the points, sort buffers included
    double nodes_per_particle = 0.0;  ///< nodes that points touch
    std::uint64_t hash = 0;           ///< of all points at the end

    const PhaseCost& full() const { return phases.front(); }
    /// CPU time with one thread, wall time with more: there a thread's own time says little about its team's.
    double ns(const PhaseCost& phase) const { return threads == 1 ? phase.cpu_ns : phase.wall_ns; }
};

/// Runs the scene and times it. From then on OpenMP uses plan.threads threads.
Cost measure(const Scene& scene, const Plan& plan);
/// The scenes in turns, a window each. Other work of the machine meets all alike, and the fastest windows can be
/// compared with one another. With a structure a scene's steps are those of its particles.
std::vector<Cost> measure_in_turns(const std::vector<Scene>& scenes, const Plan& plan);
/// The same for 3D points. They are sorted when they have moved far enough, which few windows see.
Cost measure(const SolidScene& scene, const Plan& plan);

/// Of every bit of every array, in storage order. It is FNV-1a (Fowler, Noll and Vo 1991), on 8 bytes at a time.
std::uint64_t hash_of(const Particles& particles);
std::uint64_t hash_of(const MaterialPoints& points);
std::uint64_t hash_of(const StructuredPoints& points);

}  // namespace frana::bench
