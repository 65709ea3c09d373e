#pragma once
// Structured solids and their free water seen from above: depth and velocity on the nodes, and their peaks.
#include "mpm/node_peak.h"
#include "observe/archive.h"
#include "shallow/bed_geometry.h"
#include "structured/structured_flow.h"
#include "water/water_flow.h"

namespace frana {

class StructuredMap {
public:
    /// `centre` of the release [m], from which the front is measured; `path`: slopes that velocities follow, on the grid.
    StructuredMap(const TileGrid& grid, const Vec2& centre, double footprint_depth, LazyArray<Pair> path);

    enum class Peaks { grow, stay };
    /// Takes what the nodes are now into the extent, and with `Peaks::grow` into the peaks. The run does not come by
    /// states aside, so their peaks would be gone in the next frame. Visits tiles near material only. Same bits for any
    /// number of threads.
    void note(const StructuredBody& body, const WaterFlow* water, double time, Peaks peaks);
    const FlowExtent& extent() const { return extent_; }
    /// Nodes that are covered since a time at most, and where material is faster than `speed` (MovingMass::fronts).
    Index fronts(const StructuredBody& body, const WaterFlow* water, double since, double speed) const;
    double footprint_depth() const { return footprint_depth_; }
    /// How fast what moves along the map with (vx, vy) at a node climbs [m/s].
    double climb(Index node, double vx, double vy) const { return vx * path_[node].x + vy * path_[node].y; }
    const NodePeak& peak(Index node) const { return peaks_[node]; }
    /// Depth of particles on a node [m], also where parts of them reach and none's shape function does. With water it
    /// is spread by shape functions, and nothing lies beyond them.
    static double depth_of(const StructuredBody& body, Index k) {
        if (body.moved[k].depth > 0.0 || !body.grains || body.water) return body.moved[k].depth;
        return body.flow.nodes.column_mass[k] / (body.density * body.flow.area);
    }
    /// Gravity by which a node's particles press on the bed and on the water that bears a part of them [m/s^2]. It
    /// holds on a bend of the bed too.
    static double pressing(const StructuredBody& body, Index k);
    /// Of a node's particles [kg/m^3]: what breaks loses its confined water.
    static double density_of(const StructuredBody& body, Index k);
    /// Whether the node is near material: elsewhere the body's nodes are of another time.
    static bool is_in_reach(const StructuredBody& body, Index i, Index j);
    /// Depth and velocity between the nodes, bilinear; beyond them the nearest. No elevation.
    static void sample(const StructuredBody& body, const WaterFlow* water, const Vec2& point, double& depth,
                       Vec2& velocity);
    void serialize(Archive& archive);

private:
    LazyArray<Pair> path_;
    LazyArray<NodePeak> peaks_;
    std::vector<Index> tiles_;  ///< with particles or water near
    std::vector<FlowExtent> of_tile_;
    FlowExtent extent_;
    Index nx_, ny_, stride_;
    Vec2 centre_;
    double footprint_depth_;
};

}  // namespace frana
