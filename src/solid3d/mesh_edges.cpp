#include "solid3d/mesh_edges.h"

#include <cmath>

namespace frana {
namespace {

/// An edge is at most so much farther than the deeper of its faces, at right angles.
constexpr double kDiagonal = 1.5;
constexpr double kSameNormal = 0.999;  // 2.5 degrees: above what the field errs by on a face

/// Faces at the sharp edges that are no farther away.
struct Near {
    EdgeFace list[SharpEdges::kMostFaces];
    int count;
    Near(const DistanceField& shape, const Vec3& x, double radius, double over)
        : count(shape.sharp.faces_near(x - shape.origin, radius, over, list)) {}
    const EdgeFace* begin() const { return list; }
    const EdgeFace* end() const { return list + count; }
};

/// Whether it is a face that is met, and not its edge.
bool is_face(const Near& near, const Contact& contact) {
    if (near.count == 0) return true;
    return std::any_of(near.begin(), near.end(), [&](const EdgeFace& f) {
        return f.beyond <= 0.0 && f.normal.dot(contact.normal) > kSameNormal;
    });
}

/// Of a field that has one face only, the nearest: where it is another one than the point's, both blend. Faces that lie
/// 30 degrees apart or less are one that bends; opposite ones share nothing.
double share_of_smooth(const DistanceField& shape, const Contact& contact, const Vec3& place, double blend) {
    const Contact nearest = shape.contact(place);
    const double turned = nearest.normal.dot(contact.normal);
    if (turned > kSameFace || turned <= kOpposite) return 1.0;
    const double own = std::clamp(blend - (contact.distance + nearest.distance), 0.0, blend);
    return own / (own + blend);
}

}  // namespace

Contact sharp_contact(const DistanceField& shape, const Vec3& x) {
    Contact found = shape.contact(x);
    if (shape.sharp.empty()) return found;
    // Where the field errs by more than a spacing, the face is another one than those at the edge.
    const Near near(shape, x, kDiagonal * std::abs(found.distance) + 2.0 * shape.spacing, 0.0);
    const EdgeFace* best = nullptr;
    const auto better = [](double d, double than) {  // before a face the nearest, inside the least deep
        return (d >= 0.0) != (than >= 0.0) ? d >= 0.0 : std::abs(d) < std::abs(than);
    };
    for (const EdgeFace& f : near)
        if (f.beyond <= 0.0 && std::abs(f.distance - found.distance) <= shape.spacing &&
            (!best || better(f.distance, best->distance)))
            best = &f;
    return best ? Contact{best->distance, best->normal, DistanceField::face_of(best->normal)} : found;
}

MetFaces faces_at_edge(const DistanceField& shape, const Vec3& x, double cell, const Hidden& hidden, Contact* list,
                       int count) {
    constexpr double kReached = 1.5;  // [cells] along each axis, by a node's shape function
    if (count == 0 || shape.sharp.empty()) return {count, count};
    const Near near(shape, x, kLongestReach * cell, kReached * cell);
    Contact reached[kMostContacts];
    int most = 0;
    for (const EdgeFace& f : near)
        if (std::abs(f.distance) <= 0.5 * mirror_reach(f.normal) * cell && f.beyond <= kReached * cell &&
            !hidden(x - f.distance * f.normal, f.normal))
            keep_nearest(reached, most, {f.distance, f.normal, DistanceField::face_of(f.normal)});
    return joined(
        list, count, reached, most, [&](const Contact& c) { return is_face(near, c); },
        [](const Contact& a, const Contact& b) { return a.normal.dot(b.normal) > kSameNormal; });
}

double mirror_share(const DistanceField& shape, const Vec3& x, const Contact& contact, const Vec3& place, double blend,
                    const Hidden& hidden) {
    if (shape.sharp.empty()) return share_of_smooth(shape, contact, place, blend);
    if (!is_face(Near(shape, x, contact.distance + 2.0 * shape.spacing, 0.0), contact)) return 0.0;
    const Near near(shape, place, kDiagonal * (contact.distance + blend), 0.0);
    if (near.count == 0) return share_of_smooth(shape, contact, place, blend);
    return shared_place(contact.distance, blend, [&](const auto& take) {
        for (const EdgeFace& f : near) {
            const double turned = f.normal.dot(contact.normal);
            if (turned > kSameNormal || turned <= kOpposite || f.beyond > 0.0 || f.distance > 0.0) continue;
            if (hidden(place - f.distance * f.normal, f.normal)) continue;
            take(-f.distance);
        }
    });
}

}  // namespace frana
