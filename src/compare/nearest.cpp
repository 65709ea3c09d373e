#define BOOST_ALLOW_DEPRECATED_HEADERS  // the tree of Boost 1.74 includes one
#include "compare/nearest.h"

#include <algorithm>
#include <boost/geometry/algorithms/correct.hpp>
#include <boost/geometry/algorithms/distance.hpp>
#include <boost/geometry/geometries/point_xy.hpp>
#include <boost/geometry/geometries/polygon.hpp>
#include <boost/geometry/geometries/segment.hpp>
#include <boost/geometry/index/rtree.hpp>
#include <boost/geometry/strategies/strategies.hpp>
#include <limits>

#include "base/error.h"

namespace frana {

double nearest_fraction(const Vec2& a, const Vec2& b, const Vec2& p) {
    const Vec2 along = b - a;
    const double square = along.squaredNorm();
    return square > 0.0 ? std::clamp((p - a).dot(along) / square, 0.0, 1.0) : 0.0;
}

namespace {
using Point = boost::geometry::model::d2::point_xy<double>;
}  // namespace

double distance_to(const Polygon& polygon, const Vec2& p) {
    if (polygon.rings.empty()) return std::numeric_limits<double>::infinity();
    boost::geometry::model::polygon<Point> shape;
    shape.inners().resize(polygon.rings.size() - 1);
    for (std::size_t n = 0; n < polygon.rings.size(); ++n)
        for (const Vec2& v : polygon.rings[n])
            (n == 0 ? shape.outer() : shape.inners()[n - 1]).emplace_back(v.x(), v.y());
    boost::geometry::correct(shape);
    return boost::geometry::distance(Point(p.x(), p.y()), shape);
}

struct NearestOnRings::Tree {
    using Edge = boost::geometry::model::segment<Point>;
    boost::geometry::index::rtree<Edge, boost::geometry::index::rstar<16>> edges;
};

NearestOnRings::NearestOnRings(const Rings& rings) {
    std::vector<Tree::Edge> edges;
    for (const auto& ring : rings)
        for (std::size_t k = 0; k < ring.size(); ++k) {
            const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
            edges.emplace_back(Point(a.x(), a.y()), Point(b.x(), b.y()));
        }
    expect(!edges.empty(), "distances need an outline");
    tree_ = std::make_unique<const Tree>(Tree{decltype(Tree::edges)(edges)});
}

NearestOnRings::~NearestOnRings() = default;

double NearestOnRings::distance(const Vec2& p) const {
    const Point from(p.x(), p.y());
    const auto nearest = boost::geometry::index::qbegin(tree_->edges, boost::geometry::index::nearest(from, 1));
    return boost::geometry::distance(from, *nearest);
}

}  // namespace frana
