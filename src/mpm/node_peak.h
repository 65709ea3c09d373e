#pragma once
// Peaks of nodes, of models that hold them node by node. The depth-averaged model holds the same quantities as
// arrays, four nodes at a time (shallow/peaks.h).
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/speed_counts.h"
#include "base/types.h"

namespace frana {

/// What stands on a node at one time.
struct NodeState {
    double depth = 0.0;     ///< [m]
    double speed = 0.0;     ///< along the bed [m/s]
    double pressure = 0.0;  ///< on the bed, normal [Pa]
    double density = 0.0;   ///< of what moves [kg/m^3]
};

/// The largest values of a node since the start.
struct NodePeak {
    double depth = 0.0;             ///< [m]
    double speed = 0.0;             ///< where deeper than a tenth of the footprint depth [m/s]
    double pressure = 0.0;          ///< [Pa]
    double dynamic_pressure = 0.0;  ///< rho |V|^2, at the same times as the speed [Pa]
    double arrival = 0.0;           ///< first time deeper than the footprint depth; valid where `depth` is [s]

    bool covered(double footprint_depth) const { return depth > footprint_depth; }
    /// The time of arrival [s]; -1 where the flow was never deeper than the footprint depth.
    double arrival_time(double footprint_depth) const { return covered(footprint_depth) ? arrival : -1.0; }

    /// Takes in what stands on the node at `time` [s].
    void note(const NodeState& now, double time, double footprint_depth) {
        if (now.depth > footprint_depth && !covered(footprint_depth)) arrival = time;
        depth = std::max(depth, now.depth);
        pressure = std::max(pressure, now.pressure);
        if (now.depth < kSpeedCounts * footprint_depth) return;
        speed = std::max(speed, now.speed);
        dynamic_pressure = std::max(dynamic_pressure, now.density * now.speed * now.speed);
    }

    static constexpr std::size_t kNumbers = 5;
    std::array<double, kNumbers> numbers() const { return {depth, speed, pressure, dynamic_pressure, arrival}; }
    static NodePeak of(const double* n) { return {n[0], n[1], n[2], n[3], n[4]}; }
};

/// What all nodes have at one time.
struct FlowExtent {
    double max_depth = 0.0;     ///< [m]
    double max_speed = 0.0;     ///< along the bed, where deeper than a tenth of the footprint depth [m/s]
    double covered_area = 0.0;  ///< deeper than the footprint depth [m2]
    double front = 0.0;         ///< farthest of these nodes from the release's centre [m]
    double mass = 0.0;          ///< [kg]
    double motion = 0.0;        ///< sum of the nodes' mass times their speed along the bed [kg m/s]

    /// Takes in a node whose cell has `area` [m2] and that is `distance` [m] from the release's centre.
    void note(const NodeState& now, double footprint_depth, double area, double distance) {
        max_depth = std::max(max_depth, now.depth);
        if (now.depth >= kSpeedCounts * footprint_depth) max_speed = std::max(max_speed, now.speed);
        const double of_node = now.density * now.depth * area;
        mass += of_node, motion += of_node * now.speed;
        if (!(now.depth > footprint_depth)) return;
        covered_area += area;
        front = std::max(front, distance);
    }
    void add(const FlowExtent& other) {
        max_depth = std::max(max_depth, other.max_depth);
        max_speed = std::max(max_speed, other.max_speed);
        covered_area += other.covered_area;
        front = std::max(front, other.front);
        mass += other.mass, motion += other.motion;
    }
    /// All of it, to be serialized.
    std::vector<double*> numbers() { return {&max_depth, &max_speed, &covered_area, &front, &mass, &motion}; }
    double mean_speed() const { return mass > 0.0 ? motion / mass : 0.0; }  ///< along the bed [m/s]
};

}  // namespace frana
