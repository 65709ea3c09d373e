#pragma once
// What barriers of any kind share at edges that stand out. It tells which faces a node meets, and how faces share the
// solid.
#include <algorithm>

#include "terrain/contact.h"

namespace frana {

/// Faces that a node meets: first those that it is before, or behind first, then others.
struct MetFaces {
    int faced, all;
};

/// Mirror particles of one face that bends would count twice.
inline bool bends_from(const Contact* list, int count, const Vec3& normal) {
    for (int n = 0; n < count; ++n)
        if (list[n].normal.dot(normal) > kSameFace) return false;
    return true;
}

/// Puts a contact among the nearest so far.
inline void keep_nearest(Contact* list, int& count, const Contact& contact) {
    if (count == kMostContacts && !(contact.distance < list[count - 1].distance)) return;
    if (count < kMostContacts) ++count;
    int at = count - 1;
    for (; at > 0 && contact.distance < list[at - 1].distance; --at) list[at] = list[at - 1];
    list[at] = contact;
}

/// Appends to the `count` of `list` those of `reached` (`most` of them) that are not there. They are faces that a
/// node's shape function lies on, and replace the one direction to an edge. is_face: of one in `list`; same: as one
/// reached.
template <class IsFace, class Same>
MetFaces joined(Contact* list, int count, Contact* reached, int most, const IsFace& is_face, const Same& same) {
    const Vec3 first = list[0].normal;
    const auto listed = [&](const Contact& other) {
        return std::any_of(list, list + count, [&](const Contact& c) { return same(c, other) && is_face(c); });
    };
    int more = 0;
    for (int n = 0; n < most; ++n)
        if (!listed(reached[n]) && reached[n].normal.dot(first) > kOpposite) reached[more++] = reached[n];
    if (more > 0)
        count =
            static_cast<int>(std::remove_if(list, list + count, [&](const Contact& c) { return !is_face(c); }) - list);
    const int faced = count;
    for (int n = 0; n < more && count < kMostContacts; ++n)
        if (bends_from(list, count, reached[n].normal)) list[count++] = reached[n];
    return {faced, count};
}

/// A face's share of a place that lies `own` below it. Each face has what is nearest to it, and halfway between two of
/// them both blend over `blend`. for_each_other(take): takes the place's depth below each of the other faces [m].
template <class ForEachOther>
double shared_place(double own, double blend, const ForEachOther& for_each_other) {
    double nearest = own;
    for_each_other([&](double depth) { nearest = std::min(nearest, depth); });
    const auto weight = [&](double depth) { return std::max(0.0, blend - (depth - nearest)); };
    double sum = weight(own);  // the nearest of all has the weight `blend`
    for_each_other([&](double depth) { sum += weight(depth); });
    return weight(own) / sum;
}

}  // namespace frana
