#pragma once
// How much room barriers and closed sides leave 3D points around the nodes of the terrain.
#include <limits>
#include <map>
#include <vector>

#include "scene/scene.h"

namespace frana {

/// The shares that points can fill of what each node stands for, bilinear [1]. Barriers that stand out of the ground
/// take the rest, each part of it up to its top there. So does what lies beyond walls of the terrain and closed sides
/// of the stage's window, at any height.
class OpenShares {
public:
    /// Of the nodes of a box of the terrain, which have its numbers.
    OpenShares(const Scene& scene, const NodeBox& box);
    /// On the bed, row after row of the box. 1 where next to nothing is left: what is found there stands on top.
    const std::vector<double>& at_bed() const { return at_bed_; }
    /// The share on the bed over the one at an elevation: below 1 above the top of a barrier.
    double narrowing(Index node, double z) const {
        if (steps_.empty()) return 1.0;
        const auto k = static_cast<std::size_t>(node);
        double narrowing = 1.0;
        for (std::size_t s = begin_[k]; s < begin_[k + 1] && steps_[s].top <= z; ++s) narrowing = steps_[s].narrowing;
        return narrowing;
    }

    /// Elevation of the barrier's top that what is found at a node stands on: where barriers leave next to no room on the
    /// bed [m]. NaN elsewhere.
    double top_below(Index node) const {
        const auto top = top_below_.find(node);
        return top == top_below_.end() ? std::numeric_limits<double>::quiet_NaN() : top->second;
    }

private:
    struct Step {
        double top;        ///< from this elevation on [m]
        double narrowing;  ///< [1]
    };
    std::vector<double> at_bed_;
    std::vector<Step> steps_;            ///< node after node, upwards
    std::vector<std::size_t> begin_;     ///< of each node's, and the end; empty: no steps
    std::map<Index, double> top_below_;  ///< of barriers, at nodes that they fill [m]
};

}  // namespace frana
