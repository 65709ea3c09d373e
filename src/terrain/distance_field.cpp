#include "terrain/distance_field.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace frana {

int DistanceField::face_of(const Vec3& normal) {
    Index axis = 0;
    normal.cwiseAbs().maxCoeff(&axis);
    return static_cast<int>(2 * axis + (normal[axis] > 0.0 ? 1 : 0));
}

Contact DistanceField::contact(const Vec3& x) const {
    Index first[3];
    Vec3 f, beyond = Vec3::Zero();
    for (int axis = 0; axis < 3; ++axis) {
        const double last = static_cast<double>(nodes[axis] - 1);
        const double at_x = (x[axis] - origin[axis]) / spacing, u = std::clamp(at_x, 0.0, last);
        first[axis] = std::min(static_cast<Index>(u), nodes[axis] - 2);
        f[axis] = u - static_cast<double>(first[axis]);
        beyond[axis] = spacing * (at_x - u);
    }
    double value = 0.0;
    Vec3 slope = Vec3::Zero();
    for (int c = 0; c < 8; ++c) {
        const Index on[3] = {c & 1, (c >> 1) & 1, c >> 2};
        double w[3], s[3];
        for (int axis = 0; axis < 3; ++axis)
            w[axis] = on[axis] ? f[axis] : 1.0 - f[axis], s[axis] = on[axis] ? 1.0 : -1.0;
        const double phi = at(first[0] + on[0], first[1] + on[1], first[2] + on[2]);
        value += w[0] * w[1] * w[2] * phi;
        slope += phi / spacing * Vec3(s[0] * w[1] * w[2], w[0] * s[1] * w[2], w[0] * w[1] * s[2]);
    }
    const double steep = slope.norm();
    const Vec3 normal = steep > 1e-6 ? Vec3(slope / steep) : Vec3(0, 0, 1);  // on a ridge any way leads out
    if (beyond.isZero(0.0)) return {value, normal, face_of(normal)};
    return {std::max(value + normal.dot(beyond), beyond.norm()), normal, face_of(normal)};
}

bool DistanceField::enters(const Vec3& from, const Vec3& to, Entry& entry) const {
    const int pieces = 1 + static_cast<int>((to - from).norm() / (0.5 * spacing));
    double before = 0.0;
    for (int n = 1; n <= pieces; ++n) {
        double behind = static_cast<double>(n) / pieces;
        if (!inside(from + behind * (to - from))) {
            before = behind;
            continue;
        }
        for (int halving = 0; halving < 30; ++halving) {
            const double middle = 0.5 * (before + behind);
            (inside(from + middle * (to - from)) ? behind : before) = middle;
        }
        const Contact there = contact(from + before * (to - from));
        entry = {before, there.normal, there.face};
        return true;
    }
    return false;
}

double DistanceField::thickness(const Vec3& from, const Vec3& way) const {
    const double longest = (end() - origin).norm();
    double before = 0.0;
    for (double far = spacing; far < longest; far += spacing) {
        const double here = contact(from + far * way).distance;
        if (here >= 0.0) return far - (before < 0.0 ? spacing * here / (here - before) : 0.0);
        before = here;
    }
    return std::numeric_limits<double>::infinity();
}

double DistanceField::top_at(const Vec2& p) const {
    const Vec3 last = end();
    constexpr double kNone = -std::numeric_limits<double>::infinity();
    if (p.x() < origin.x() || p.y() < origin.y() || p.x() > last.x() || p.y() > last.y()) return kNone;
    double above = 0.0;
    for (Index k = nodes[2] - 1; k >= 0; --k) {
        const double z = place(0, 0, k).z(), here = contact({p.x(), p.y(), z}).distance;
        if (here < 0.0) return k + 1 == nodes[2] ? z : z + spacing * here / (here - above);
        above = here;
    }
    return kNone;
}

}  // namespace frana
