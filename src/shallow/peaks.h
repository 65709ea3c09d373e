#pragma once
#include "shallow/flow.h"

namespace frana {

/// Peaks of every node, updated after each step on nodes near material only.
struct Peaks {
    LazyArray<double> depth;     ///< of the flow and of the deposit that lies below it [m]
    LazyArray<double> speed;     ///< along the smoothed bed, where deeper than a tenth of the footprint depth [m/s]
    LazyArray<double> pressure;  ///< on the bed, normal [Pa]
    LazyArray<double> dynamic_pressure;  ///< rho |V|^2, same nodes as speed [Pa]
    LazyArray<double>
        arrival;  ///< first time of flow and deposit deeper than the footprint depth; 0 before, or of the start [s]

    /// The time of arrival on a node [s]; -1 where nothing was ever deeper than the footprint depth [m].
    double arrival_time(Index k, double footprint_depth) const {
        return depth[k] > footprint_depth || arrival[k] > 0.0 ? arrival[k] : -1.0;
    }

    explicit Peaks(const TileGrid& grid)
        : depth(grid.size()),
          speed(grid.size()),
          pressure(grid.size()),
          dynamic_pressure(grid.size()),
          arrival(grid.size()) {}
};

/// THEORY (59): speed along the bed and normal pressure on it at a node, from the velocity (vx, vy) there. Both by the
/// bed smoothed to `curvature_length`. A particle slides over the roughness of single cells, and does not jump up and
/// down with them. By the raw slope the speed would grow with every finer cell.
struct BedContact {
    double speed, pressure;
};
BedContact bed_contact(const Flow& flow, bool steep, bool curved, Index k, double vx, double vy);

/// Speeds along the bed of all material at one time [m/s].
struct FlowSpeeds {
    double fastest = 0.0;  ///< of nodes deeper than a tenth of the footprint depth
    double mean = 0.0;     ///< over the mass on the nodes
};

/// Takes the present depth and velocity into the peaks.
FlowSpeeds update_peaks(Flow& flow, bool steep, bool curved, double time, double footprint_depth, Peaks& peaks);

/// The same speeds, with all its sums, and no peaks: for states that a run does not go on from.
FlowSpeeds speeds_of_nodes(Flow& flow, bool steep, bool curved, double footprint_depth);

}  // namespace frana
