#pragma once
// 3D points seen from above: depth and velocity on the nodes of the terrain, and their peaks.
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "convert/flow_particles.h"
#include "coupling/open_share.h"
#include "mpm/node_peak.h"
#include "observe/archive.h"
#include "observe/observer.h"
#include "scene/scene.h"
#include "solid3d/mpm3d.h"

namespace frana {

/// On the nodes that points can give to (nodes_of_points()), numbered row after row.
class FlowMap {
public:
    /// A node's material: what the points around it give it, bilinear. What stands above a barrier's top, where the node
    /// is wider, counts as the share of it that goes onto the width on the bed (OpenShares::narrowing()).
    struct Node {
        double mass = 0.0;       ///< [kg]
        Vec3 momentum{0, 0, 0};  ///< [kg m/s]
    };

    explicit FlowMap(const Scene& scene);
    enum class Peaks { grow, stay };
    /// Takes the points as they are now, and with `Peaks::grow` the peaks. The run does not come by states that are put
    /// aside, and their peaks stay. Same bits for any number of threads.
    void sample(const Mpm3d& flow, double time, Peaks peaks = Peaks::grow);

    const NodeBox& nodes() const { return box_; }
    /// The number of a node of the terrain; -1 where the map has none.
    Index number(Index i, Index j) const {
        const Index a = i - box_.i0, b = j - box_.j0;
        return a < 0 || b < 0 || a >= box_.nx || b >= box_.ny ? -1 : b * box_.nx + a;
    }
    /// Volume without stress over the area that is open at its height [m]. A pile of air and drops is as deep as if it had settled.
    double depth(Index k) const {
        return nodes_[static_cast<std::size_t>(k)].mass / (density_ * areas_[static_cast<std::size_t>(k)]);
    }
    Vec3 velocity(Index k) const {
        const Node& node = nodes_[static_cast<std::size_t>(k)];
        return node.mass > 0.0 ? Vec3(node.momentum / node.mass) : Vec3(0, 0, 0);
    }
    /// Of what stands on a node, normal to the bed [Pa].
    double pressure(Index k) const;
    double cosine(Index k) const {
        return 1.0 / std::sqrt(steepening_[static_cast<std::size_t>(k)]);
    }  ///< of the slope
    /// Of the barrier that fills a node, which its depth stands on [m]; NaN where it stands on the bed.
    double top_below(Index k) const { return open_.top_below(k); }
    /// Particles that are adjacent to the points from now on: mean_at() counts them too.
    void set_adjacent(const FlowParticles& particles);
    /// Of the flow between the nodes, bilinear; beyond them the nearest. The speed is that of the common momentum, up and down
    /// included.
    struct Mean {
        double depth = 0.0;   ///< [m]
        double speed = 0.0;   ///< [m/s]
        double cosine = 0.0;  ///< of the slope [1]
    };
    Mean mean_at(const Vec2& point) const;
    /// Depth and velocity between the nodes, bilinear; beyond them the nearest. No elevation.
    Sample at(const Vec2& point) const;
    /// The pressure is the weight of what stands there, normal to the bed.
    const NodePeak& peak(Index k) const { return peaks_[static_cast<std::size_t>(k)]; }

    const FlowExtent& extent() const { return extent_; }
    /// A node whose depth is more than half again what its points reach up to: they lie in one another there.
    struct Piled {
        double depth = 0.0;       ///< of the node, 0: none ever was so [m]
        double height = 0.0;      ///< of the highest point around above the bed, with half its size [m]
        double x = 0.0, y = 0.0;  ///< of the node [m]
        double time = 0.0;        ///< [s]
    };
    /// The deepest of all samples.
    const Piled& piled() const { return piled_; }
    /// What a run says of it.
    std::optional<std::string> remark() const;
    double footprint_depth() const { return footprint_depth_; }  ///< [m]
    /// Nodes that are covered since a time at most, and where material is faster than `speed` (MovingMass::fronts).
    Index fronts(double since, double speed) const;
    void serialize(Archive& archive);

private:
    void note_nodes(double time, Peaks peaks);
    void note_piled(Index k, double time);
    bool on_pixels(const Vec3& place) const;
    double height_above_bed(const Vec3& place) const;
    Vec2 place_of(Index k) const { return {grid_.x(box_.i0 + k % box_.nx), grid_.y(box_.j0 + k / box_.nx)}; }
    template <class Body>
    void for_each_around(double x, double y, Body&& body) const;

    GridGeometry grid_;  ///< of the terrain
    NodeBox box_;
    double density_, gravity_, footprint_depth_;
    Vec2 centre_{0, 0};               ///< of the release [m]
    OpenShares open_;                 ///< of the nodes' cells
    std::vector<double> areas_;       ///< of the nodes' cells, without what walls and barriers take of them [m2]
    std::vector<double> steepening_;  ///< 1 + |grad Z|^2 at the nodes
    std::vector<double> ground_;      ///< of the points at the nodes [m]
    std::vector<Node> nodes_;
    std::vector<double> heights_;  ///< of the highest point around each node above the bed, with half its size [m]
    Piled piled_;
    std::vector<Node> adjacent_;          ///< of the adjacent particles; empty: none were ever set
    std::vector<Index> adjacent_places_;  ///< nodes that have any of that
    std::vector<NodePeak> peaks_;
    FlowExtent extent_;
};

}  // namespace frana
