#include "solid3d/prism.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "solid3d/bed_height.h"

namespace frana {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Of a side's length and of a height [1]. So far crossings beyond a side's end count, so that nothing passes between
/// two faces by round-off.
constexpr double kSeam = 1e-9;

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

double area_of(const std::vector<Vec2>& ring) {
    double twice = 0.0;
    for (std::size_t k = 0; k < ring.size(); ++k)
        twice += cross(ring[k] - ring[0], ring[(k + 1) % ring.size()] - ring[0]);
    return 0.5 * twice;
}

Vec3 level(const Vec2& v) { return {v.x(), v.y(), 0.0}; }

}  // namespace

Prism::Prism(const Polygons& outline, double top) : level_(top) {
    for (const Polygon& part : outline.parts)
        for (std::size_t r = 0; r < part.rings.size(); ++r) add_ring(part.rings[r], r > 0);
    if (edges_.empty()) throw UserError("a barrier's outline has no polygon; expected one or more with an area");
    find_box();
}

Prism::Prism(const Polygons& outline, Raster top) : Prism(outline, 0.0) {
    expect(top.geometry.nx > 1 && top.geometry.ny > 1, "a height field has two nodes a side");
    top_ = std::move(top);
    find_box();
}

/// Solid to the left of all sides: outlines run against the clock, holes with it.
void Prism::add_ring(std::vector<Vec2> ring, bool hole) {
    if (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
    const double area = ring.size() < 3 ? 0.0 : area_of(ring);
    if (!(std::abs(area) > 0.0))
        throw UserError(
            fmt::format("a barrier's outline has a ring of {} corners and the area {} m2; expected "
                        "three corners or more that enclose an area",
                        ring.size(), area));
    if ((area > 0.0) == hole) std::reverse(ring.begin(), ring.end());
    const int first = static_cast<int>(edges_.size()), count = static_cast<int>(ring.size());
    for (int k = 0; k < count; ++k) {
        const Vec2 from = ring[static_cast<std::size_t>(k)],
                   way = ring[static_cast<std::size_t>((k + 1) % count)] - from;
        if (!(way.norm() > 0.0))
            throw UserError(
                fmt::format("a barrier's outline has the corner ({}, {}) twice in a row; expected "
                            "different corners: leave one out",
                            from.x(), from.y()));
        const Vec2 along = way.normalized();
        edges_.push_back({from,
                          along,
                          {along.y(), -along.x()},
                          way.norm(),
                          first + (k + count - 1) % count,
                          first + (k + 1) % count,
                          false,
                          false});
    }
    for (int k = first; k < first + count; ++k) {
        Edge& edge = edges_[static_cast<std::size_t>(k)];
        edge.starts_in = cross(edges_[static_cast<std::size_t>(edge.before)].along, edge.along) < 0.0;
        edge.ends_in = cross(edge.along, edges_[static_cast<std::size_t>(edge.after)].along) < 0.0;
    }
}

void Prism::find_box() {
    low_.setConstant(kInfinity), high_.setConstant(-kInfinity);
    for (const Edge& edge : edges_) {
        low_.head<2>() = low_.head<2>().cwiseMin(edge.from);
        high_.head<2>() = high_.head<2>().cwiseMax(edge.from);
    }
    low_.z() = -kInfinity;
    high_.z() = top_.values.empty() ? level_ : highest_top();
}

/// Of the nodes around the outline's box: between nodes a top is no higher than they. Beyond the outer nodes it goes on as
/// it slopes there, and is highest at a corner of the outline.
double Prism::highest_top() const {
    const GridGeometry& g = top_.geometry;
    const auto nodes = [&](double least, double most, double start, Index count) {
        const auto node = [&](double at) {
            return static_cast<Index>(std::clamp(at, 0.0, static_cast<double>(count - 1)));
        };
        return std::pair(node(std::floor((least - start) / g.cell)), node(std::ceil((most - start) / g.cell)));
    };
    const auto [i0, i1] = nodes(low_.x(), high_.x(), g.x0, g.nx);
    const auto [j0, j1] = nodes(low_.y(), high_.y(), g.y0, g.ny);
    double highest = -kInfinity;
    for (Index j = j0; j <= j1; ++j)
        for (Index i = i0; i <= i1; ++i) highest = std::max(highest, top_.at(i, j));
    for (const Edge& edge : edges_) highest = std::max(highest, top_at(edge.from));
    return highest;
}

std::vector<std::vector<Vec2>> Prism::rings() const {
    std::vector<std::vector<Vec2>> rings;
    for (std::size_t k = 0; k < edges_.size(); ++k) {
        if (edges_[k].before >= static_cast<int>(k)) rings.emplace_back();  // the first of its ring
        rings.back().push_back(edges_[k].from);
    }
    return rings;
}

double Prism::top_at(const Vec2& p) const { return top_.values.empty() ? level_ : bed_height(top_, p.x(), p.y()).z; }

/// Half-open in y, so that each side counts once.
bool Prism::within(const Vec2& p) const {
    bool odd = false;
    for (const Edge& edge : edges_) {
        const Vec2 to = edges_[static_cast<std::size_t>(edge.after)].from;
        if ((edge.from.y() > p.y()) == (to.y() > p.y())) continue;
        const bool upward = to.y() > edge.from.y();
        const bool right = edge.normal.dot(p - edge.from) < 0.0;  // the solid's side
        odd ^= upward == right;
    }
    return odd;
}

Contact Prism::top_contact(const Vec3& x) const {
    if (top_.values.empty()) return {x.z() - level_, {0, 0, 1}, top_face()};
    const BedHeight at = bed_height(top_, x.x(), x.y());
    const Vec3 normal = Vec3(-at.slope_x, -at.slope_y, 1.0).normalized();
    return {(x.z() - at.z) * normal.z(), normal, top_face()};
}

/// The contact with the upper edge of a side where the point stands above it.
Contact Prism::lifted(const Vec3& x, double distance, const Vec2& normal, int face) const {
    const double above = x.z() - top_at(x.head<2>() - distance * normal);
    if (!(above > 0.0)) return {distance, level(normal), face};
    const double far = std::hypot(distance, above);
    return {far, Vec3(distance * normal.x(), distance * normal.y(), above) / far, face};
}

int Prism::contacts(const Vec3& x, double cell, Contact* list) const {
    const Vec2 p = x.head<2>();
    if (!within(p)) return before_it(x, kLongestReach * cell, list);
    if (x.z() < top_at(p)) return within_it(x, cell, list);
    list[0] = top_contact(x);
    return 1;
}

int Prism::before_it(const Vec3& x, double reach, Contact* list) const {
    const Vec2 p = x.head<2>();
    Contact found[kMostContacts];
    int count = 0;
    for (std::size_t k = 0; k < edges_.size(); ++k) {
        const Edge& edge = edges_[k];
        const Edge& before = edges_[static_cast<std::size_t>(edge.before)];
        const Vec2 from_start = p - edge.from;
        const double d = edge.normal.dot(from_start), t = edge.along.dot(from_start);
        const int face = static_cast<int>(k);
        if (t < 0.0 && before.along.dot(from_start) > 0.0 && !edge.starts_in) {
            const double far = from_start.norm();
            if (far < reach) keep_nearest(found, count, lifted(x, far, from_start / far, face));
            continue;
        }
        if (!(d >= 0.0) || d >= reach) continue;
        const bool faces =
            (t >= 0.0 || (edge.starts_in && t > -reach && before.normal.dot(from_start) >= 0.0)) &&
            (t <= edge.length || (edge.ends_in && t < edge.length + reach &&
                                  edges_[static_cast<std::size_t>(edge.after)].normal.dot(p - edge.to()) >= 0.0));
        if (faces) keep_nearest(found, count, lifted(x, d, edge.normal, face));
    }
    int kept = 0;
    for (int n = 0; n < count; ++n)
        if (found[n].distance < reach && bends_from(list, kept, found[n].normal) &&
            (kept == 0 || sees(x, found[n], list[0].face)))
            list[kept++] = found[n];
    return kept;
}

/// Whether nothing but the nearest face stands before another one: in a wide corner each reaches on behind
/// the other.
bool Prism::sees(const Vec3& x, const Contact& contact, int nearest) const {
    Entry entry;
    const double way = contact.distance * (1.0 - 1e-6);
    return !enters(x, x - way * contact.normal, entry) || entry.face == nearest;
}

int Prism::within_it(const Vec3& x, double cell, Contact* list) const {
    const Vec2 p = x.head<2>();
    constexpr int kNone = -1;
    int nearest = kNone, corner = kNone;
    double depth = kInfinity, corner_depth = kInfinity;
    for (std::size_t k = 0; k < edges_.size(); ++k) {
        const Edge& edge = edges_[k];
        const Vec2 from_start = p - edge.from;
        const double d = -edge.normal.dot(from_start), t = edge.along.dot(from_start);
        if (edge.starts_in && from_start.norm() < corner_depth)
            corner = static_cast<int>(k), corner_depth = from_start.norm();
        if (d >= 0.0 && d < depth && t >= 0.0 && t <= edge.length) nearest = static_cast<int>(k), depth = d;
    }
    const Contact top = top_contact(x);
    const auto side = [&](int k) {
        const Edge& edge = edges_[static_cast<std::size_t>(k)];
        return Contact{edge.normal.dot(p - edge.from), level(edge.normal), k};
    };
    int count = 0;
    if (corner != kNone && corner_depth <= depth && corner_depth <= -top.distance) {
        list[count++] = side(corner);
        const Contact other = side(edges_[static_cast<std::size_t>(corner)].before);
        if (bends_from(list, count, other.normal)) list[count++] = other;
        if (count == 2 && other.distance < list[0].distance) std::swap(list[0], list[1]);
        return count;
    }
    if (nearest == kNone || -top.distance < depth) list[count++] = top;
    if (nearest == kNone) return count;
    const Edge& edge = edges_[static_cast<std::size_t>(nearest)];
    const double thick = thickness(x, level(-edge.normal));
    const bool thin = depth + thick < mirror_reach(level(edge.normal)) * cell;
    if (count == 0 || thin) list[count++] = side(nearest);
    if (thin) {
        Entry out;
        const Vec3 beyond = x - (thick + 1e-6 * cell) * level(edge.normal);
        if (enters(beyond, x, out))
            list[count++] = {-thick * -out.normal.dot(level(edge.normal)), out.normal, out.face};
        if (list[0].face != top.face && top.distance > -1.5 * cell) list[count++] = top;
        return count;
    }
    if (list[0].face == top.face) return count;
    for (const auto& [in, neighbour] : {std::pair(edge.starts_in, edge.before), std::pair(edge.ends_in, edge.after)}) {
        const Contact other = side(neighbour);
        if (in && other.distance < kLongestReach * cell && bends_from(list, count, other.normal)) list[count++] = other;
    }
    return count;
}

bool Prism::enters(const Vec3& from, const Vec3& to, Entry& entry) const {
    entry.share = kInfinity;
    const auto place = [&](double share) { return Vec3(from + share * (to - from)); };
    for (std::size_t k = 0; k < edges_.size(); ++k) {
        const Edge& edge = edges_[k];
        const double before = edge.normal.dot(from.head<2>() - edge.from),
                     behind = edge.normal.dot(to.head<2>() - edge.from);
        if (!(before >= 0.0 && behind < 0.0)) continue;
        const double share = before / (before - behind);
        const Vec3 at = place(share);
        const double t = edge.along.dot(at.head<2>() - edge.from), seam = kSeam * edge.length;
        if (share < entry.share && t >= -seam && t <= edge.length + seam && at.z() < top_at(at.head<2>()) + seam)
            entry = {share, level(edge.normal), static_cast<int>(k)};
    }
    const double above = from.z() - top_at(from.head<2>()), below = to.z() - top_at(to.head<2>());
    if (above >= 0.0 && below < 0.0) {
        const double share = above / (above - below);
        const Vec3 at = place(share);
        if (share < entry.share && within(at.head<2>())) entry = {share, top_contact(at).normal, top_face()};
    }
    return entry.share <= 1.0;
}

/// Whether it is a face that is met, and not its edge.
bool Prism::is_face(const Contact& contact) const {
    if (contact.face == top_face()) return true;
    return contact.normal.head<2>().dot(edges_[static_cast<std::size_t>(contact.face)].normal) > 1.0 - kSeam;
}

/// Faces that a node's shape function lies on, ends that stand in apart: it reaches 3/2 cells along each axis.
int Prism::reached(const Vec3& x, double cell, Contact* list) const {
    const Vec2 p = x.head<2>();
    const double half = 0.5 * cell, height = x.z() - top_at(p);
    int count = 0;
    bool near = within(p);
    for (std::size_t k = 0; k < edges_.size(); ++k) {
        const Edge& edge = edges_[k];
        const double d = edge.normal.dot(p - edge.from), t = edge.along.dot(p - edge.from);
        const double over = mirror_reach(level(edge.along)) * half;
        if (std::abs(d) > mirror_reach(level(edge.normal)) * half) continue;
        if (t < (edge.starts_in ? 0.0 : -over) || t > edge.length + (edge.ends_in ? 0.0 : over)) continue;
        near = true;
        if (height < 3.0 * half) keep_nearest(list, count, {d, level(edge.normal), static_cast<int>(k)});
    }
    const Contact top = top_contact(x);
    if (near && std::abs(top.distance) <= mirror_reach(top.normal) * half) keep_nearest(list, count, top);
    return count;
}

MetFaces Prism::faces_at_edge(const Vec3& x, double cell, Contact* list, int count) const {
    if (count == 0) return {0, 0};
    Contact others[kMostContacts];
    const int most = reached(x, cell, others);
    return joined(
        list, count, others, most, [&](const Contact& c) { return is_face(c); },
        [](const Contact& a, const Contact& b) { return a.face == b.face; });
}

double Prism::mirror_share(const Contact& contact, const Vec3& place, double blend) const {
    if (!is_face(contact)) return 0.0;
    const bool at_top = contact.face == top_face();
    const double top = std::max(0.0, -top_contact(place).distance);
    const auto for_each_other = [&](const auto& take) {
        if (!at_top) take(top);
        for (std::size_t k = 0; k < edges_.size(); ++k) {
            const Edge& edge = edges_[k];
            if (static_cast<int>(k) == contact.face || contact.normal.head<2>().dot(edge.normal) <= kOpposite) continue;
            const Vec2 from_start = place.head<2>() - edge.from;
            const double t = edge.along.dot(from_start), depth = -edge.normal.dot(from_start);
            if (t >= 0.0 && t <= edge.length && depth >= 0.0) take(depth);
        }
    };
    return shared_place(contact.distance, blend, for_each_other);
}

double Prism::thickness(const Vec3& from, const Vec3& way) const {
    double least = kInfinity;
    for (const Edge& edge : edges_) {
        const double out = edge.normal.dot(way.head<2>());
        if (!(out > 0.0)) continue;
        const double far = edge.normal.dot(edge.from - from.head<2>()) / out;
        if (!(far > 0.0) || far >= least) continue;
        const double t = edge.along.dot(from.head<2>() + far * way.head<2>() - edge.from);
        if (t >= 0.0 && t <= edge.length) least = far;
    }
    return least;
}

Polygons wall_outline(const Polyline& line, WetSide wet, double thickness) {
    std::vector<Vec2> face;
    for (const Vec2& p : line)
        if (face.empty() || (p - face.back()).norm() > 0.0) face.push_back(p);
    if (face.size() < 2)
        throw UserError("a wall's line has less than two different points; expected a line along its face");
    const auto away = [&](std::size_t k) {  // of the segment behind point k
        const Vec2 along = (face[k + 1] - face[k]).normalized();
        return Vec2(wet == WetSide::left ? Vec2(along.y(), -along.x()) : Vec2(-along.y(), along.x()));
    };
    std::vector<Vec2> back;
    for (std::size_t k = 0; k < face.size(); ++k) {
        const Vec2 before = away(k == 0 ? 0 : k - 1), behind = away(std::min(k, face.size() - 2));
        const double turn = before.dot(behind);
        if (!(turn > kOpposite))
            throw UserError(
                fmt::format("a wall's line turns by more than 120 degrees at ({}, {}); expected a wall "
                            "without such points: draw it as two walls",
                            face[k].x(), face[k].y()));
        back.push_back(face[k] + thickness / (1.0 + turn) * (before + behind));
    }
    std::reverse(back.begin(), back.end());
    face.insert(face.end(), back.begin(), back.end());
    return {{Polygon{{face}}}, "", ""};
}

double least_wall_thickness(const Polyline& line, double cell) {
    double least = 0.0;
    for (std::size_t k = 0; k + 1 < line.size(); ++k) {
        const Vec2 way = line[k + 1] - line[k];
        if (way.norm() > 0.0) least = std::max(least, mirror_reach(level(way.normalized())) * cell);
    }
    return least;
}

}  // namespace frana
