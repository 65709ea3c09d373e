#pragma once
// How high material reaches at a barrier, and how deep it lies on top of it, without its spray.
#include <utility>
#include <vector>

#include "base/types.h"

namespace frana {

/// The elevation below which 99.9 % of the mass at a place lies at one moment. Single drops do not count: where there
/// are that many points, more than two have to be above it. Its memory is reused from one moment to the next.
class RunUp {
public:
    void begin() { reached_.clear(), mass_ = 0.0; }
    /// A point with its elevation [m] and mass [kg].
    void add(double elevation, double mass) { reached_.emplace_back(elevation, mass), mass_ += mass; }
    /// Of what was added since begin(); minus infinity without any [m]. Puts it out of order.
    double level();

private:
    std::vector<std::pair<double, double>> reached_;
    double mass_ = 0.0;
};

/// Depth of a layer by its volume over a square of the map, whatever flies above it.
class LayerDepth {
public:
    explicit LayerDepth(double side) : side_(side) {}
    void begin() { parts_.clear(); }
    /// A point at a place of the map [m], with its volume [m3].
    void add(const Vec2& place, double volume);
    /// Of the square that has most of what was added since begin(); 0 without any [m]. Puts it out of order.
    double largest();

private:
    double side_;  ///< of a square [m]
    std::vector<std::pair<std::pair<Index, Index>, double>> parts_;
};

}  // namespace frana
