#include "solid3d/surface_contact.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "base/error.h"
#include "solid3d/stencil3d.h"

namespace frana {
namespace {

// flip: points retain their velocities (mpm3d.h). averages: nodes tell the mean J. Functions are inline so that what a node
// meets is compiled in one piece. Where a product and a sum become one rounding is the compiler's choice there.

constexpr double kRounding = 1e-9;  ///< of sums over points, a generous share

inline Vec3 place_of(const Grid3d& grid, Index tile, Index within) {
    const std::array<Index, 3> t = grid.tile_place(tile);
    const Index i = within % kTile3d, j = within / kTile3d % kTile3d, k = within / (kTile3d * kTile3d);
    const Vec3 node(static_cast<double>(grid.first_node(t[0]) + i), static_cast<double>(grid.first_node(t[1]) + j),
                    static_cast<double>(grid.first_node(t[2]) + k));
    return grid.geometry().origin + grid.cell() * node;
}

/// What a barrier does to a node or a point. It changes its speed, and moves it at the speed it then has.
struct ImpulseAt {
    double mass;
    Vec3 place;
    double reach;  ///< of the material that it stands for, along the face [m]
    Vec3 change, shift, v;
};
/// Records it with the face. Not inlined, like all that barriers need, so that scenes without them have the
/// bits they had. In place, it would share sums with other code, and so change what is fused there.
[[gnu::noinline]] void list_impulse(const SolidBody& body, int surface, const Contact& c, const ImpulseAt& source,
                                    std::vector<FaceImpulse>& list) {
    const Vec3 impulse = source.mass * source.change;
    if (impulse.isZero(0.0) && source.shift.isZero(0.0)) return;
    const int face = body.ledger.first(surface) + c.face;
    const Patches& patches = body.ledger.faces()[static_cast<std::size_t>(face)].patches;
    list.push_back(
        {face, patches.around(source.place - c.distance * c.normal, source.reach, body.surfaces), impulse,
         (source.place - body.grid.geometry().origin).cross(impulse) + source.mass * source.shift.cross(source.v)});
}

/// v across the surface, `along` along it.
inline Vec3 along_of(const Vec3& along, const Vec3& v, const Vec3& normal) {
    return along + (v - along).dot(normal) * normal;
}

/// Less speed along a surface by `brake`, or none at all.
inline Vec3 braked(const Vec3& v, const Vec3& normal, double brake) {
    const Vec3 across = v.dot(normal) * normal, along = v - across;
    const double speed = along.norm();
    return across + along * (speed > brake ? 1.0 - brake / speed : 0.0);
}

/// A surface that a node's material meets, and how it changes the node's velocity.
struct Touch {
    int surface;
    Contact contact;
    double least;                ///< speed away from the surface that it requires [m/s]
    double normal_change = 0.0;  ///< along its normal, below zero at planes of symmetry only [m/s]
    Vec3 brake{0, 0, 0};         ///< along the surface [m/s]
    bool both_ways = false;      ///< a plane of symmetry: `least` is the speed, neither less nor more
};
constexpr int kMostTouched = 6;

/// `touched` for the faces of a barrier. In one so thin that material of both sides shares a node, the sides' mirror
/// particles are not told apart. Nothing goes into either side. At an edge a node carries some of the pressure
/// of faces that it is not before. They require no more than the impulse of their mirror particles' pressure. With
/// their motion too they would brake what passes the edge.
[[gnu::noinline]] int touched_barrier(const SolidBody& body, int s, Index node, const Vec3& x, const Vec3& mixed,
                                      Touch* list, int count) {
    Contact found[kMostContacts];
    const Surface& barrier = body.surfaces[static_cast<std::size_t>(s)];
    const int faces = contacts(barrier, x, body.grid.cell(), found);
    bool thin = false;  // of any two: the nearest may be the top
    for (int n = 1; n < faces; ++n)
        for (int m = 0; m < n; ++m) thin |= found[m].normal.dot(found[n].normal) < kOpposite;
    thin = thin && found[0].distance <= 0.0;
    const MetFaces met =
        thin ? MetFaces{faces, faces} : faces_at_edge(body.surfaces, barrier, x, body.grid.cell(), found, faces);
    const SolidBody::Node &real = body.real[node], &pressure = body.mirror_force[node];
    const Vec3 pressed = Vec3(real.x + pressure.x, real.y + pressure.y, real.z + pressure.z) / real.m;
    for (int n = 0; n < met.all && count < kMostTouched; ++n) {
        const Contact& c = found[n];
        if (c.distance > 0.5 * mirror_reach(c.normal) * body.grid.cell()) continue;
        const double asked = thin ? 0.0 : mixed.dot(c.normal);
        const double least = n >= met.faced      ? std::min(asked, pressed.dot(c.normal))
                             : c.distance <= 0.0 ? std::max(asked, 0.0)
                                                 : asked;
        list[count++] = {s, c, least};
    }
    return count;
}

/// Surfaces that mirror particles of points at `x` can reach, with the speeds they require. That is what points and
/// mirror particles together have along the normal (`mixed`), and behind a surface none into it.
inline int touched(const SolidBody& body, SurfaceSet near, Index node, const Vec3& x, const Vec3& mixed, Touch* list) {
    int count = 0;
    const bool all_on_barriers =
        (near & body.barriers) && body.on_barriers[node].m >= (1.0 - kRounding) * body.real[node].m;
    for (; near != 0 && count < kMostTouched; near &= near - 1) {
        const int s = __builtin_ctz(near);
        if (body.barriers >> s & 1) {
            count = touched_barrier(body, s, node, x, mixed, list, count);
            continue;
        }
        const Contact c = contact(body.surfaces[static_cast<std::size_t>(s)], x);
        if (c.distance > 0.5 * mirror_reach(c.normal) * body.grid.cell()) continue;
        if (all_on_barriers && is_floor(c.normal)) continue;
        const double asked = mixed.dot(c.normal);
        const bool both_ways = body.surfaces[static_cast<std::size_t>(s)].symmetry;
        list[count++] = {s,        c, c.distance <= 0.0 && !both_ways ? std::max(asked, 0.0) : asked, 0.0, Vec3::Zero(),
                         both_ways};
    }
    return count;
}

/// Where the ground and the top of a low barrier reach a node both, it meets them as one. How much each of them
/// gives is not told by their normals. It follows from what the material needs that stands on each.
struct Shared {
    int ground = -1, top = -1;  ///< in the list of touches; top: -1 where there is none
    double of_top = 0.0;        ///< [1]
    Touch apart_ground{}, apart_top{};
};
inline Vec3 momentum(const SolidBody::Node& node) { return {node.x, node.y, node.z}; }

inline Shared ground_and_top(const SolidBody& body, const Touch* list, int count) {
    Shared shared;
    for (int n = 0; n < count; ++n)
        if (!(body.barriers >> list[n].surface & 1) && is_floor(list[n].contact.normal)) shared.ground = n;
    double nearest = kSameFace;
    for (int n = 0; n < count && shared.ground >= 0; ++n) {
        const double along = list[n].contact.normal.dot(list[shared.ground].contact.normal);
        if ((body.barriers >> list[n].surface & 1) && along > nearest) shared.top = n, nearest = along;
    }
    return shared;
}

[[gnu::noinline]] Shared share_ground(const SolidBody& body, Index node, const SolidBody::Node& real, Touch* list,
                                      int& count) {
    const SolidBody::Node& on = body.on_barriers[node];
    Shared shared;
    if (on.m > 0.0) shared = ground_and_top(body, list, count);
    if (shared.top < 0) return shared;
    expect(shared.ground < shared.top, "floors come before barriers");
    Touch &ground = list[shared.ground], &top = list[shared.top];
    shared.apart_ground = ground, shared.apart_top = top;
    ground.least = std::max(ground.least, top.least);
    const auto needed = [&](double mass, const Vec3& has, const Touch& from) {
        return std::max(0.0, mass * ground.least - has.dot(from.contact.normal));
    };
    const double by_top = needed(on.m, momentum(on), top),
                 by_ground = needed(real.m - on.m, momentum(real) - momentum(on), ground);
    const double s = by_top + by_ground > 0.0 ? by_top / (by_top + by_ground) : std::min(1.0, on.m / real.m);
    shared.of_top = s;
    ground.contact.normal = ((1.0 - s) * ground.contact.normal + s * top.contact.normal).normalized();
    top = list[--count];
    return shared;
}

/// Both again, each with its share of the impulse.
[[gnu::noinline]] void give_each(const Shared& shared, Touch* list, int& count) {
    if (shared.top < 0) return;
    const double s = shared.of_top, given = list[shared.ground].normal_change;
    Touch ground = shared.apart_ground, top = shared.apart_top;
    const double length = ((1.0 - s) * ground.contact.normal + s * top.contact.normal).norm();
    ground.normal_change = (1.0 - s) * given / length, top.normal_change = s * given / length;
    list[shared.ground] = ground;
    list[count++] = list[shared.top];
    list[shared.top] = top;
}

/// Normal impulses that give each surface its speed, or none where the material leaves it faster. They are found by
/// turns (projected Gauss-Seidel), at once where surfaces are perpendicular to each other.
inline void separate(Touch* list, int count, Vec3& v) {
    constexpr int kTurns = 20;  // a corner of 60 degrees errs by a quarter of the turn before: 1e-12 of the start
    for (int turn = 0; turn < (count > 1 ? kTurns : 1); ++turn)
        for (Touch* t = list; t < list + count; ++t) {
            const double asked = t->least - v.dot(t->contact.normal);
            const double change = t->both_ways ? asked : std::max(asked, -t->normal_change);
            t->normal_change += change;
            v += change * t->contact.normal;
        }
}

/// Whether two surfaces there are not perpendicular to each other.
inline bool oblique(const Touch* list, int count) {
    constexpr double kSquare = 1e-9;  // round-off of normals
    for (int n = 0; n < count; ++n)
        for (int m = 0; m < n; ++m)
            if (std::abs(list[n].contact.normal.dot(list[m].contact.normal)) > kSquare) return true;
    return false;
}

/// Whether the ground turns so far within the reach of a node's points that it is a corner.
inline bool bent(const SolidBody& body, const Vec3& x, const Touch* list, int count) {
    constexpr double kBend = 0.707;  // cosine of 45 degrees
    const double reach = 1.5 * body.grid.cell();
    for (const Touch* t = list; t < list + count; ++t) {
        const Surface& surface = body.surfaces[static_cast<std::size_t>(t->surface)];
        if (surface.kind != Surface::Kind::ground) continue;
        for (const auto& [dx, dy] : {std::pair{reach, 0.0}, {-reach, 0.0}, {0.0, reach}, {0.0, -reach}})
            if (contact(surface, x + Vec3(dx, dy, 0.0)).normal.dot(t->contact.normal) < kBend) return true;
    }
    return false;
}

/// Surfaces at rest do no work: no normal force gives a node more energy than it had. What mirror particles require
/// beyond that is not the material's. In corners, and where few points shear, they show motion that is not there.
/// The answer lies between v and what is left where no force makes anything leave a surface. That is no faster than
/// what came. In oblique corners and where the ground bends only: elsewhere the same would take from what rebounds,
/// and from what spreads along a surface.
[[gnu::noinline]] Vec3 without_gain(const SolidBody& body, const Vec3& x, Touch* list, int count, const Vec3& came,
                                    const Vec3& v, double most2) {
    if (!oblique(list, count) && !bent(body, x, list, count)) return v;
    Touch soft[kMostTouched];
    for (int n = 0; n < count; ++n) {
        soft[n] = list[n];
        soft[n].normal_change = 0.0;
        if (!soft[n].both_ways) soft[n].least = std::min(soft[n].least, 0.0);
    }
    Vec3 slow = came;
    separate(soft, count, slow);
    // |slow + s (v - slow)|^2 = most2
    const Vec3 more = v - slow;
    const double a = more.squaredNorm(), b = slow.dot(more), c = most2 - slow.squaredNorm();
    const double root = std::sqrt(b * b + a * std::max(0.0, c));  // both forms are without cancellation
    const double s = c > 0.0 && a > 0.0 ? std::min(1.0, b > 0.0 ? c / (b + root) : (root - b) / a) : 0.0;
    for (int n = 0; n < count; ++n)
        list[n].normal_change = soft[n].normal_change + s * (list[n].normal_change - soft[n].normal_change);
    return slow + s * more;
}

/// v, or as much of it as has no more than that square of the speed.
inline Vec3 no_faster(const Vec3& v, double most2) {
    const double speed2 = v.squaredNorm();
    return speed2 > most2 ? Vec3(std::sqrt(most2 / speed2) * v) : v;
}

struct Touches {
    const Touch *begin, *end;
};

/// v, held by a stuck surface: along it, what points and mirror particles have, and nothing into others. Also
/// behind it, where mirror particles turn velocities round. With nodes at rest, material would stand still above a
/// surface that lies between them. It would lose more to it at each step. But in a barrier mirror particles end
/// halfway. Points that retain their velocities would have each turn added to the one before.
template <bool flip>
inline Vec3 held(const SolidBody& body, const Vec3& mixed, const Vec3& v, const Touch* by, const Touches& all) {
    const bool still = by->contact.distance <= 0.0 && (flip || (body.barriers >> by->surface & 1));
    Vec3 kept = along_of(still ? Vec3::Zero() : mixed, v, by->contact.normal);
    for (const Touch* t = all.begin; t < all.end; ++t)
        if (t != by) kept += std::max(0.0, t->least - kept.dot(t->contact.normal)) * t->contact.normal;
    return kept;
}

/// Square of a node's speed before the step's impulses, where points that retain their velocities tell it; else
/// zero. Stress next to a surface presses a node into it in the step, and the surface takes that back.
template <bool flip>
inline double had2(const SolidBody& body, Index k) {
    if constexpr (!flip) return 0.0;
    const SolidBody::Node& had = body.flip_sums[k];
    return Vec3(had.x, had.y, had.z).squaredNorm() / (body.real[k].m * body.real[k].m);
}

/// The same of what points and adjacent material share. Of that its motion after the step's impulses is known only.
template <bool flip>
inline double had2_in_common(const SolidBody& body, Index k) {
    if constexpr (!flip) return 0.0;
    const SolidBody::Node &had = body.flip_sums[k], &own = body.ghosts.own[k], &both = body.real[k];
    const Vec3 of_other(both.x - own.x, both.y - own.y, both.z - own.z);
    return (Vec3(had.x, had.y, had.z) + of_other).squaredNorm() / (both.m * both.m);
}

/// Where impulses on the nodes of a tile are recorded.
struct Given {
    Vec3* impulse;                    ///< per surface
    std::vector<FaceImpulse>* faces;  ///< of barriers, where some are near
    SurfaceWork* work;                ///< of all surfaces
};

/// The velocity of a node near surfaces. `mixed` is what points and mirror particles gave it. Free surfaces take
/// from it only what it has along their normal. Along themselves mirror particles would brake material that shears.
/// Contact is unilateral: normal forces are compressive. Friction follows from the normal force. Records each
/// surface's impulse on the real material.
template <bool flip>
inline Vec3 meet(const SolidBody& body, SurfaceSet near, Index node, const Vec3& x, const SolidBody::Node& real,
                 const Vec3& mixed, double had2, const Given& given) {
    Touch list[kMostTouched];
    int count = touched(body, near, node, x, mixed, list);
    Vec3 v = Vec3(real.x, real.y, real.z) / real.m;
    const Vec3 came = v;
    const double most2 = std::max(came.squaredNorm(), had2);
    const Shared shared = near & body.barriers ? share_ground(body, node, real, list, count) : Shared{};
    separate(list, count, v);
    if (v.squaredNorm() > most2) v = without_gain(body, x, list, count, came, v, most2);
    give_each(shared, list, count);
    const Vec3 contact_work = v;
    for (Touch* t = list; t < list + count; ++t) {
        const Surface& surface = body.surfaces[static_cast<std::size_t>(t->surface)];
        const Vec3& normal = t->contact.normal;
        if (t->normal_change > 0.0) {
            const Vec3 before = v;
            if (surface.hold == Hold::stuck)
                v = no_faster(held<flip>(body, mixed, v, t, {list, list + count}),
                              oblique(list, count) ? most2 : std::numeric_limits<double>::infinity());
            else if (surface.law)
                v = braked(v, normal, surface.law->coefficient(x) * t->normal_change);
            else if (surface.friction > 0.0)
                v = braked(v, normal, surface.friction * t->normal_change);
            t->brake = v - before;
        }
        if (body.barriers >> t->surface & 1)
            list_impulse(
                body, t->surface, t->contact,
                {real.m, x, 0.5 * body.grid.cell(), t->normal_change * normal + t->brake, Vec3::Zero(), Vec3::Zero()},
                *given.faces);
        else
            given.impulse[t->surface] += real.m * (t->normal_change * normal + t->brake);
    }
    // At the speed after the step, as the work of stress and weight. With that before them a surface would lose
    // what it undoes of both at once.
    given.work->contact_work += real.m * (contact_work - came).dot(v);
    given.work->friction -= real.m * (v - contact_work).dot(v);
    return v;
}

/// The same as meet, of which `share` is recorded.
template <bool flip>
inline Vec3 meet_in_part(const SolidBody& body, SurfaceSet near, Index node, const Vec3& x, const SolidBody::Node& real,
                         const Vec3& mixed, double share, const Given& given) {
    std::array<Vec3, kMostSurfaces> impulse;
    impulse.fill(Vec3::Zero());
    SurfaceWork work{};
    const std::size_t before = given.faces ? given.faces->size() : 0;
    Vec3 v = meet<flip>(body, near, node, x, real, mixed, had2_in_common<flip>(body, node),
                        {impulse.data(), given.faces, &work});
    for (std::size_t s = 0; s < body.surfaces.size(); ++s) given.impulse[s] += share * impulse[s];
    given.work->contact_work += share * work.contact_work, given.work->friction += share * work.friction;
    if (given.faces)
        for (std::size_t f = before; f < given.faces->size(); ++f)
            (*given.faces)[f].impulse *= share, (*given.faces)[f].moment *= share;
    return v;
}

/// Those of a tile where material adjacent to the points gave to the nodes. It and they have one velocity,
/// on which surfaces then act. Of all impulses the points get the share of their mass. What came to them from the
/// other material is recorded apart. Sums of J are of points alone.
template <bool flip, bool averages>
[[gnu::noinline]] void move_near_ghosts(SolidBody& body, Index n, Index tile, const Given& given) {
    const SurfaceSet near = body.near_nodes[static_cast<std::size_t>(n)];
    for (Index k = tile * kTileNodes; k < (tile + 1) * kTileNodes; ++k) {
        SolidBody::Node& node = body.nodes[k];
        const SolidBody::Node &own = body.ghosts.own[k], &both = body.real[k];
        if (!(own.m > 0.0)) {
            node = {};
            if constexpr (flip) body.flip_sums[k] = {};
            continue;
        }
        const Vec3 shared = Vec3(both.x, both.y, both.z) / both.m;
        Vec3 v = shared;
        if (near) {
            const Vec3 mixed = Vec3(node.x, node.y, node.z) / node.m;
            v = meet_in_part<flip>(body, near, k, place_of(body.grid, tile, k - tile * kTileNodes), both, mixed,
                                   own.m / both.m, given);
        }
        const Vec3 impulse = own.m * shared - Vec3(own.x, own.y, own.z);
        body.ghosts.tile_impulse[static_cast<std::size_t>(n)] += impulse;
        given.work->contact_work += impulse.dot(v);
        double mean_j = 0.0;
        if constexpr (averages) mean_j = (flip ? body.flip_sums[k].m : body.mass_j[k]) / own.m;
        node = {mean_j, v[0], v[1], v[2]};
        if constexpr (flip) {
            SolidBody::Node& had = body.flip_sums[k];
            const double share = body.flip_share / own.m;
            had = {0.0, v[0] - share * had.x, v[1] - share * had.y, v[2] - share * had.z};
        }
    }
}

template <bool flip, bool averages>
void move(SolidBody& body) {
    for_each_work_tile(body.active, [&](Index n, Index tile) {
        const SurfaceSet near = body.near_nodes[static_cast<std::size_t>(n)];
        const Index first = tile * kTileNodes;
        Vec3* const impulse = body.tile_impulse.data() + n * static_cast<Index>(body.surfaces.size());
        std::fill_n(impulse, body.surfaces.size(), Vec3::Zero());
        const Given given{impulse, near & body.barriers ? &body.node_impulses[static_cast<std::size_t>(n)] : nullptr,
                          &body.tile_work[static_cast<std::size_t>(n)]};
        *given.work = {};
        if (given.faces) given.faces->clear();
        if (!body.ghosts.reaches.empty() && body.ghosts.reaches[static_cast<std::size_t>(n)])
            return move_near_ghosts<flip, averages>(body, n, tile, given);
        for (Index k = first; k < first + kTileNodes; ++k) {
            auto& node = body.nodes[k];
            const double real = near ? body.real[k].m : node.m;
            if (!(real > 0.0)) {
                node = {};
                if constexpr (flip) body.flip_sums[k] = {};
                continue;
            }
            double mean_j = 0.0;
            if constexpr (averages) mean_j = (flip ? body.flip_sums[k].m : body.mass_j[k]) / real;
            Vec3 v = Vec3(node.x, node.y, node.z) / node.m;
            if (near)
                v = meet<flip>(body, near, k, place_of(body.grid, tile, k - first), body.real[k], v,
                               had2<flip>(body, k), given);
            node = {mean_j, v[0], v[1], v[2]};
            if constexpr (flip) {
                SolidBody::Node& had = body.flip_sums[k];
                const double share = body.flip_share / real;
                had = {0.0, v[0] - share * had.x, v[1] - share * had.y, v[2] - share * had.z};
            }
        }
    });
}

/// Puts a point before the face of a barrier that it crossed, without its speed into it. Returns whether
/// it did. A point that lay inside from the start comes out by the nearest face.
[[gnu::noinline]] bool put_before(SolidBody& body, Index tile, Index p, int s, const Vec3& start) {
    constexpr double kHair = 1e-9;  // of a cell: above round-off of places, below all that matters
    const Surface& surface = body.surfaces[static_cast<std::size_t>(s)];
    MaterialPoints& q = body.points;
    const double h = body.grid.cell();
    const Vec3& origin = body.grid.geometry().origin;
    const Vec3 x = origin + h * position(body, p);
    Contact c;
    Entry entry;
    if (enters(surface, start, x, entry)) {
        const Vec3 crossing = start + entry.share * (x - start);
        c = {entry.normal.dot(x - crossing), entry.normal, entry.face};
    } else if (surface.inside(x)) {
        c = contact(surface, x);
    } else {
        return false;
    }
    const Vec3 v(q.v[0][p], q.v[1][p], q.v[2][p]);
    const Vec3 change = -std::min(0.0, v.dot(c.normal)) * c.normal;
    for (int k = 0; k < 3; ++k) {
        q.x[k][p] += (kHair - c.distance / h) * c.normal[k];
        q.v[k][p] += change[k];
    }
    list_impulse(body, s, c, {q.mass[p], x, 0.0, change, (kHair * h - c.distance) * c.normal, v + change},
                 body.point_impulses[static_cast<std::size_t>(tile)]);
    return true;
}

}  // namespace

void move_nodes(SolidBody& body, bool flip, bool averages) {
    if (flip)
        averages ? move<true, true>(body) : move<true, false>(body);
    else
        averages ? move<false, true>(body) : move<false, false>(body);
}

void move_out(SolidBody& body, SurfaceSet near, Index p, Vec3* impulse) {
    MaterialPoints& q = body.points;
    const double h = body.grid.cell();
    for (; near != 0; near &= near - 1) {
        const int s = __builtin_ctz(near);
        const Contact c =
            contact(body.surfaces[static_cast<std::size_t>(s)], body.grid.geometry().origin + h * position(body, p));
        if (!(c.distance < 0.0)) continue;
        const double inward = q.v[0][p] * c.normal[0] + q.v[1][p] * c.normal[1] + q.v[2][p] * c.normal[2];
        const Vec3 change = -std::min(0.0, inward) * c.normal;
        for (int k = 0; k < 3; ++k) q.x[k][p] -= c.distance / h * c.normal[k], q.v[k][p] += change[k];
        impulse[s] += q.mass[p] * change;
    }
}

void keep_out(SolidBody& body, Index tile, Index p, const Vec3& from) {
    constexpr int kTurns = 8;
    const SurfaceSet near = body.near_points[static_cast<std::size_t>(tile)] & body.barriers;
    const Vec3& origin = body.grid.geometry().origin;
    const double h = body.grid.cell();
    const Vec3 start = origin + h * from;
    bool free = false;
    for (int turn = 0; turn < kTurns && !free; ++turn) {
        free = true;
        for (SurfaceSet left = near; left != 0; left &= left - 1)
            free = !put_before(body, tile, p, __builtin_ctz(left), start) && free;
    }
    if (free) return;
    MaterialPoints& q = body.points;
    for (int k = 0; k < 3; ++k) q.x[k][p] = from[k];
}

}  // namespace frana
