#include "solid3d/surfaces.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solid3d/bed_height.h"
#include "solid3d/mesh_edges.h"

namespace frana {
namespace {

constexpr double kSquare = 1e-9;

}  // namespace

Surface Surface::plane(const Vec3& through, const Vec3& normal, Hold hold, double friction) {
    Surface s;
    s.normal = normal.normalized();
    s.offset = s.normal.dot(through);
    s.hold = hold;
    s.friction = friction;
    return s;
}

Surface Surface::symmetry_plane(const Vec3& through, const Vec3& normal) {
    Surface s = plane(through, normal);
    s.symmetry = true;
    return s;
}

Surface Surface::ground(Raster bed, Hold hold, double friction) {
    Surface s;
    s.kind = Kind::ground;
    s.bed = std::move(bed);
    s.hold = hold;
    s.friction = friction;
    return s;
}

Surface Surface::barrier(Prism prism, Hold hold, double friction) {
    Surface s;
    s.kind = Kind::prism;
    s.prism = std::make_shared<const Prism>(std::move(prism));
    s.hold = hold;
    s.friction = friction;
    return s;
}

Surface Surface::barrier(DistanceField shape, Hold hold, double friction) {
    Surface s;
    s.kind = Kind::shape;
    s.shape = std::make_shared<const DistanceField>(std::move(shape));
    s.hold = hold;
    s.friction = friction;
    return s;
}

bool Surface::inside(const Vec3& x) const {
    if (kind == Kind::prism) return prism->inside(x);
    return contact(*this, x).distance < 0.0;
}

Contact contact(const Surface& surface, const Vec3& x) {
    if (surface.kind == Surface::Kind::plane) return {surface.normal.dot(x) - surface.offset, surface.normal};
    if (surface.kind != Surface::Kind::ground) {
        Contact list[kMostContacts];
        contacts(surface, x, std::numeric_limits<double>::infinity(), list);
        return list[0];
    }
    const BedHeight g = bed_height(surface.bed, x.x(), x.y());
    const Vec3 normal = Vec3(-g.slope_x, -g.slope_y, 1.0).normalized();
    return {(x.z() - g.z) * normal.z(), normal};
}

int contacts(const Surface& barrier, const Vec3& x, double cell, Contact* list) {
    if (barrier.kind == Surface::Kind::prism) return barrier.prism->contacts(x, cell, list);
    list[0] = sharp_contact(*barrier.shape, x);
    return 1;
}

namespace {

/// What lies behind planes or the ground, or on them to `seam` [m], and faces them.
Hidden behind(const std::vector<Surface>& surfaces, double seam) {
    return [&surfaces, seam](const Vec3& x, const Vec3& normal) {
        return std::any_of(surfaces.begin(), surfaces.end(), [&](const Surface& s) {
            if (s.is_barrier()) return false;
            const Contact c = contact(s, x);
            return c.distance < seam && c.normal.dot(normal) <= kOpposite;
        });
    };
}
constexpr double kPlaceSeam = 1e-6;  // [cells]: round-off of places

}  // namespace

MetFaces faces_at_edge(const std::vector<Surface>& surfaces, const Surface& barrier, const Vec3& x, double cell,
                       Contact* list, int count) {
    if (barrier.kind == Surface::Kind::prism) return barrier.prism->faces_at_edge(x, cell, list, count);
    return faces_at_edge(*barrier.shape, x, cell, behind(surfaces, kPlaceSeam * cell), list, count);
}

bool enters(const Surface& barrier, const Vec3& from, const Vec3& to, Entry& entry) {
    return barrier.kind == Surface::Kind::prism ? barrier.prism->enters(from, to, entry)
                                                : barrier.shape->enters(from, to, entry);
}

double thickness(const Surface& barrier, const Vec3& from, const Vec3& way) {
    return barrier.kind == Surface::Kind::prism ? barrier.prism->thickness(from, way)
                                                : barrier.shape->thickness(from, way);
}

bool is_covered(const std::vector<Surface>& surfaces, SurfaceSet near, const Vec3& x, const Contact& contact,
                double cell) {
    constexpr double kSole = 0.05;  // [cells]: a barrier may end on the ground, but for what its field errs by there
    if (!is_floor(contact.normal) || !(contact.distance > 0.0)) return false;
    const Vec3 foot = x - (contact.distance - kSole * cell) * contact.normal;
    for (; near != 0; near &= near - 1) {
        const Surface& barrier = surfaces[static_cast<std::size_t>(__builtin_ctz(near))];
        Entry entry;
        // By its top: on a slope the way to the ground may enter the wall's side that is up the slope.
        if (barrier.is_barrier() && enters(barrier, x, foot, entry) && is_floor(entry.normal)) return true;
    }
    return false;
}

SurfaceSet surfaces_near(const std::vector<Surface>& surfaces, const Vec3& low, const Vec3& high, double cell,
                         double more) {
    SurfaceSet set = 0;
    const Vec3 centre = 0.5 * (low + high), half = 0.5 * (high - low);
    for (std::size_t s = 0; s < surfaces.size(); ++s) {
        const Surface& surface = surfaces[s];
        bool near = false;
        if (surface.kind == Surface::Kind::plane) {
            const double span = surface.normal.cwiseAbs().dot(half);
            near = contact(surface, centre).distance - span < mirror_reach(surface.normal) * cell + more;
        } else if (surface.is_barrier()) {
            const auto [least, most] =
                surface.kind == Surface::Kind::prism ? surface.prism->box() : surface.shape->box();
            const double reach = kLongestReach * cell + more;
            near = (least - high).maxCoeff() < reach && (low - most).maxCoeff() < reach;
        } else {
            const double step = std::min(surface.bed.geometry.cell, cell);
            for (double y = low.y(); y < high.y() + step && !near; y += step)
                for (double x = low.x(); x < high.x() + step && !near; x += step) {
                    const Contact c = contact(surface, {x, y, low.z()});
                    near = c.distance < mirror_reach(c.normal) * cell + more;
                }
        }
        if (near) set |= SurfaceSet{1} << s;
    }
    return set;
}

namespace {

/// Least and largest size of two numbers and all between.
struct Sizes {
    double least, most;
    Sizes(double a, double b)
        : least(a * b < 0.0 ? 0.0 : std::min(std::abs(a), std::abs(b))), most(std::max(std::abs(a), std::abs(b))) {}
};

/// With slopes a and b along x and y the normal's entries are a, b and 1 over sqrt(1 + a^2 + b^2).
double sideways_reach(const Sizes& x, const Sizes& y) {
    const double square = 1.0 + x.least * x.least + y.least * y.least;
    return 2.0 * mirror_reach({x.most, y.most, 1.0}) * std::max(x.most, y.most) / square;
}

}  // namespace

double sideways_reach(const Surface& surface, const Vec3& low, const Vec3& high) {
    if (surface.kind == Surface::Kind::plane) {
        const Vec3& n = surface.normal;
        return 2.0 * mirror_reach(n) * std::max(std::abs(n.x()), std::abs(n.y()));
    }
    if (surface.is_barrier()) return std::numeric_limits<double>::infinity();
    const Raster& bed = surface.bed;
    const GridGeometry& g = bed.geometry;
    const auto cell_at = [&](double x, double x0, Index n) {
        return static_cast<Index>(std::clamp((x - x0) / g.cell, 0.0, static_cast<double>(n - 2)));
    };
    double reach = 0.0;  // where the bed is no number no mirror particle stands
    for (Index j = cell_at(low.y(), g.y0, g.ny); j <= cell_at(high.y(), g.y0, g.ny); ++j)
        for (Index i = cell_at(low.x(), g.x0, g.nx); i <= cell_at(high.x(), g.x0, g.nx); ++i) {
            const double a = bed.at(i, j), b = bed.at(i + 1, j), c = bed.at(i, j + 1), d = bed.at(i + 1, j + 1);
            reach = std::max(reach, sideways_reach(Sizes((b - a) / g.cell, (d - c) / g.cell),
                                                   Sizes((c - a) / g.cell, (d - b) / g.cell)));
        }
    return reach;
}

MirrorParticles::MirrorParticles(const std::vector<Surface>& surfaces, SurfaceSet near, const Vec3& x, double cell) {
    Near list[kMostNear];
    int count = 0;
    const SurfaceSet all = near;
    for (; near != 0 && count < kMostNear; near &= near - 1) {
        const Surface& surface = surfaces[static_cast<std::size_t>(__builtin_ctz(near))];
        if (surface.is_barrier()) {
            count = near_barrier(surfaces, surface, x, cell, list, count);
            continue;
        }
        const Contact c = contact(surface, x);
        if (!(c.distance < mirror_reach(c.normal) * cell)) continue;
        if (is_covered(surfaces, all, x, c, cell))
            covered_ = true;
        else
            list[count++] = {
                c, surface.hold == Hold::stuck, std::numeric_limits<double>::infinity(), 1.0, false, surface.symmetry};
    }
    for (int n = 0; n < count; ++n) list[n].slides = !list[n].symmetry && corner(list, count, n);
    if (count > 0) reflect(list, count, x);
}

namespace {

/// Of a barrier; without end where that lies behind another surface.
double thickness(const std::vector<Surface>& surfaces, const Surface& barrier, const Vec3& from, const Vec3& way,
                 double cell) {
    const double thick = thickness(barrier, from, way);
    const bool hidden = barrier.kind == Surface::Kind::shape && std::isfinite(thick) &&
                        behind(surfaces, kPlaceSeam * cell)(from + thick * way, way);
    return hidden ? std::numeric_limits<double>::infinity() : thick;
}

/// Of a barrier.
double mirror_share(const std::vector<Surface>& surfaces, const Surface& barrier, const Contact& contact, const Vec3& x,
                    double cell) {
    constexpr double kBlend = 0.5;  // [cells], about the distance of points
    const Vec3 place = x - 2.0 * contact.distance * contact.normal;
    return barrier.kind == Surface::Kind::prism
               ? barrier.prism->mirror_share(contact, place, kBlend * cell)
               : mirror_share(*barrier.shape, x, contact, place, kBlend * cell, behind(surfaces, kPlaceSeam * cell));
}

}  // namespace

int MirrorParticles::near_barrier(const std::vector<Surface>& surfaces, const Surface& surface, const Vec3& x,
                                  double cell, Near* list, int count) {
    Contact found[kMostContacts];
    const int faces = contacts(surface, x, cell, found);
    for (const Contact* c = found; c < found + faces && count < kMostNear; ++c) {
        if (c->distance < 0.0 || c->distance >= mirror_reach(c->normal) * cell) continue;
        const double share = mirror_share(surfaces, surface, *c, x, cell);
        if (!(share > 0.0)) continue;
        const double thick = thickness(surfaces, surface, x - c->distance * c->normal, -c->normal, cell);
        list[count++] = {*c, surface.hold == Hold::stuck, thick, share, true};
    }
    return count;
}

/// In a barrier a mirror particle shows only down to half of its thickness.
void MirrorParticles::cut_off(MirrorParticle& mirror, const Near& near, const Vec3& from) {
    const Vec3& normal = near.contact.normal;
    if (near.thick < std::numeric_limits<double>::infinity() && mirror.cuts < 2)
        mirror.cut[mirror.cuts++] = {{normal[0], normal[1], normal[2]},
                                     normal.dot(from) - near.contact.distance - 0.5 * near.thick};
}

/// Whether surface n meets another one. A plane of symmetry is none: what is near it goes on there.
bool MirrorParticles::corner(const Near* near, int count, int n) {
    for (int m = 0; m < count; ++m)
        if (m != n && !near[m].symmetry && near[n].contact.normal.dot(near[m].contact.normal) >= kOpposite) return true;
    return false;
}

/// Where it is in a corner: the next surface that a mirror particle is mirrored in, after those of `turn`.
void MirrorParticles::slide_along(MirrorParticle& mirror, const Near& near, const Mat3& turn) {
    if (!mirror.held && near.slides) mirror.slide[mirror.slides++] = turn.transpose() * near.contact.normal;
}

/// Reflects a point in each of the surfaces, and these mirror particles in those listed behind. It does so at most
/// three times in a row.
void MirrorParticles::reflect(const Near* near, int count, const Vec3& x) {
    for (int n = 0; n < count && count_ < kMost; ++n) {
        const Vec3& normal = near[n].contact.normal;
        MirrorParticle& mirror = list_[static_cast<std::size_t>(count_++)];
        mirror.place = x - 2.0 * near[n].contact.distance * normal;
        mirror.turn = Mat3::Identity() - 2.0 * normal * normal.transpose();
        mirror.motion = near[n].stuck ? Mat3(-Mat3::Identity()) : mirror.turn;
        mirror.held_normal = near[n].bends() ? normal : Vec3(Vec3::Zero());
        mirror.held_above = near[n].bends() ? near[n].contact.distance : 0.0;
        mirror.held = near[n].stuck, mirror.of_barrier = near[n].of_barrier, mirror.share = near[n].share;
        mirror.slides = 0, mirror.cuts = 0;
        slide_along(mirror, near[n], Mat3::Identity());
        cut_off(mirror, near[n], x);
        if (n + 1 < count) reflect_in_others(near, count, n, x, mirror, 0);
    }
}

/// The mirror particle of `from` in near[n], in the surfaces behind that one.
void MirrorParticles::reflect_in_others(const Near* near, int count, int n, const Vec3& from,
                                        const MirrorParticle& mirror, int depth) {
    Near others[kMostNear];
    int left = 0;
    for (int m = n + 1; m < count; ++m) {
        if (near[n].contact.normal.dot(near[m].contact.normal) < kOpposite) continue;
        Near other = near[m];
        other.contact.distance += other.contact.normal.dot(mirror.place - from);
        if (other.contact.distance > 0.0) others[left++] = other;  // in a wide corner it may lie behind already
    }
    reflect(others, left, mirror, depth + 1);
}

/// The same of a mirror particle. Surfaces are perpendicular to each other when the cosine of their angle is below
/// kSquare, round-off.
void MirrorParticles::reflect(const Near* near, int count, const MirrorParticle& from, int depth) {
    for (int n = 0; n < count && count_ < kMost; ++n) {
        const Vec3& normal = near[n].contact.normal;
        const Mat3 reflection = Mat3::Identity() - 2.0 * normal * normal.transpose();
        MirrorParticle mirror{from.place - 2.0 * near[n].contact.distance * normal,
                              reflection * from.turn,
                              near[n].stuck ? Mat3(-from.motion) : Mat3(reflection * from.motion),
                              Vec3::Zero(),
                              0.0,
                              from.held || near[n].stuck,
                              from.of_barrier || near[n].of_barrier,
                              from.share * near[n].share,
                              from.slides,
                              {from.slide[0], from.slide[1], from.slide[2]},
                              from.cuts,
                              {from.cut[0], from.cut[1]}};
        const bool square = (from.turn * normal - normal).norm() < kSquare;  // to all mirrors before
        if (near[n].bends() && square && !from.held)
            mirror.held_normal = normal, mirror.held_above = near[n].contact.distance;
        else if (!near[n].stuck && std::abs(from.held_normal.dot(normal)) < kSquare)
            mirror.held_normal = from.held_normal, mirror.held_above = from.held_above;
        slide_along(mirror, near[n], from.turn);
        cut_off(mirror, near[n], from.place);
        list_[static_cast<std::size_t>(count_++)] = mirror;
        if (depth < 2) reflect_in_others(near, count, n, from.place, mirror, depth);
    }
}

}  // namespace frana
