#pragma once
// Distance from any point to a set of rings.
#include <memory>

#include "terrain/outline_area.h"

namespace frana {

/// The point on the segment from a to b that is nearest to p. It is given as a fraction of the way from a.
double nearest_fraction(const Vec2& a, const Vec2& b, const Vec2& p);

/// From a place to a polygon [m]; 0 within it.
double distance_to(const Polygon& polygon, const Vec2& p);

/// The edges of rings in a tree, so that a search visits only those that may be nearest.
class NearestOnRings {
public:
    explicit NearestOnRings(const Rings& rings);  ///< at least one ring
    ~NearestOnRings();

    /// To the nearest point of any edge [m].
    double distance(const Vec2& p) const;

private:
    struct Tree;
    std::unique_ptr<const Tree> tree_;
};

}  // namespace frana
