#include "solid3d/face_ledger.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

#include "terrain/outline_area.h"

namespace frana {
namespace {

Patches squares(const Vec3& origin, const Vec3& right, const Vec3& up, const Vec2& length, double size) {
    Patches p{origin, right, up, size, {}, {}, {}, {}, {}, {}};
    for (std::size_t n = 0; n < 2; ++n) {
        p.extent[n] = std::max(0.0, length[static_cast<Eigen::Index>(n)] / size);
        p.count[n] = std::max<Index>(1, static_cast<Index>(std::ceil(p.extent[n] - 1e-9)));
    }
    p.impulse.assign(static_cast<std::size_t>(p.count[0] * p.count[1]), Vec3::Zero());
    return p;
}

/// The side of a prism from the ground's depths or the grid's bottom up, its top from its box.
Patches of_prism(const Prism& prism, int number, const Vec3& low, const Vec3& high, double cell) {
    const auto [least, most] = prism.box();
    const Vec3 from = least.cwiseMax(low), to = most.cwiseMin(high);
    if (number == prism.top_face())
        return squares({from.x(), from.y(), most.z()}, {1, 0, 0}, {0, 1, 0}, (to - from).head<2>(), cell);
    const Prism::Edge& edge = prism.edges()[static_cast<std::size_t>(number)];
    Patches side = squares({edge.from.x(), edge.from.y(), from.z()}, {edge.along.x(), edge.along.y(), 0.0}, {0, 0, 1},
                           {edge.length, to.z() - from.z()}, cell);
    for (Index column = 0; column < side.count[0]; ++column) {
        const double middle = std::min((static_cast<double>(column) + 0.5) * cell, edge.length);
        side.tops.push_back((prism.top_at(edge.from + middle * edge.along) - from.z()) / cell);
    }
    return side;
}

/// Of a shape: its box's sides, onto which its surface is projected.
Patches of_shape(const DistanceField& shape, int number, double cell) {
    const auto [least, most] = shape.box();
    const int axis = number / 2, a = (axis + 1) % 3, b = (axis + 2) % 3;
    const Vec3 size = most - least;
    return squares(least, Vec3::Unit(a), Vec3::Unit(b), {size[a], size[b]}, cell);
}

}  // namespace

FacePart Patches::around(const Vec3& x, double reach, const std::vector<Surface>& others) const {
    constexpr double kLeans = 0.1;  // of a normal: less, and its surface lies along the face
    const std::array<const Vec3*, 2> ways{&right, &up};
    FacePart part;
    std::array<double, 2> at{0, 0};
    for (std::size_t n = 0; n < 2; ++n) {
        at[n] = ways[n]->dot(x - origin) / size;
        part.from[n] = at[n] - reach / size, part.to[n] = at[n] + reach / size;
    }
    for (const Surface& other : others) {
        if (other.is_barrier()) continue;
        const Contact c = contact(other, x);
        // Along the way that leads out of it soonest: along the other one a gentle slope would cut far off.
        const std::size_t n = std::abs(c.normal.dot(up)) >= std::abs(c.normal.dot(right)) ? 1 : 0;
        const double lean = c.normal.dot(*ways[n]);
        if (std::abs(lean) < kLeans) continue;
        const double edge = at[n] - c.distance / lean / size;
        if (lean > 0.0)
            part.from[n] = std::max(part.from[n], edge);
        else
            part.to[n] = std::min(part.to[n], edge);
    }
    if (!tops.empty()) {
        const auto column = static_cast<Index>(std::clamp(at[0], 0.0, static_cast<double>(count[0] - 1)));
        part.to[1] = std::min(part.to[1], tops[static_cast<std::size_t>(column)]);
    }
    for (std::size_t n = 0; n < 2; ++n) {
        part.from[n] = std::clamp(part.from[n], 0.0, extent[n]);
        part.to[n] = std::clamp(part.to[n], part.from[n], extent[n]);
    }
    return part;
}

void Patches::take_areas(const std::vector<double>& shares) {
    constexpr double kLeast = 0.25, kNone = 1e-6;  // of a square; what only touches is not on it
    area.clear(), off_face.clear();
    for (const double share : shares) {
        area.push_back(std::max(kLeast, share) * size * size);
        off_face.push_back(share <= kNone);
    }
}

std::vector<double> Patches::shares_among(const std::vector<Surface>& others) const {
    std::vector<double> shares;
    for (Index row = 0; row < count[1]; ++row)
        for (Index column = 0; column < count[0]; ++column) {
            const double a = static_cast<double>(column) + 0.5, b = static_cast<double>(row) + 0.5;
            const FacePart part = around(origin + size * (a * right + b * up), 0.5 * size, others);
            shares.push_back((part.to[0] - part.from[0]) * (part.to[1] - part.from[1]));
        }
    return shares;
}

void Patches::measure(const std::vector<Surface>& others) { take_areas(shares_among(others)); }

void Patches::measure_top(const Prism& prism, const std::vector<Surface>& others) {
    std::array<std::vector<double>, 2> lines;
    for (std::size_t n = 0; n < 2; ++n)
        for (Index line = 0; line <= count[n]; ++line)
            lines[n].push_back(origin[static_cast<Eigen::Index>(n)] + size * static_cast<double>(line));
    OutlineArea outline(prism.rings(), lines[0], lines[1]);
    std::vector<double> shares = shares_among(others), covered(static_cast<std::size_t>(count[0]));
    for (Index row = 0; row < count[1]; ++row) {
        const auto [first, last] = outline.row(row, covered);
        for (Index column = 0; column < count[0]; ++column) {
            double& share = shares[static_cast<std::size_t>(row * count[0] + column)];
            const bool within = column >= first && column < last;
            share = within ? std::min(share, covered[static_cast<std::size_t>(column)] / (size * size)) : 0.0;
        }
    }
    take_areas(shares);
}

void Patches::spread(const FacePart& part, const Vec3& given) {
    constexpr double kPoint = 1e-9;  // [squares] shorter, a part is a place
    std::array<Index, 2> first{0, 0}, last{0, 0};
    for (std::size_t n = 0; n < 2; ++n) {
        const auto square = [&](double at) { return std::clamp(static_cast<Index>(at), Index{0}, count[n] - 1); };
        first[n] = square(part.from[n]);
        last[n] = part.to[n] - part.from[n] > kPoint ? square(part.to[n]) : first[n];
    }
    const auto share = [&](std::size_t n, Index square) {
        if (first[n] == last[n]) return 1.0;
        const double low = static_cast<double>(square);
        const double covered = std::min(part.to[n], low + 1.0) - std::max(part.from[n], low);
        return covered / (part.to[n] - part.from[n]);
    };
    for (Index row = first[1]; row <= last[1]; ++row)
        for (Index column = first[0]; column <= last[0]; ++column)
            impulse[static_cast<std::size_t>(row * count[0] + column)] += share(0, column) * share(1, row) * given;
}

FaceLedger::FaceLedger(const std::vector<Surface>& surfaces, const Vec3& low, const Vec3& high, double cell) {
    for (std::size_t s = 0; s < surfaces.size(); ++s) {
        const Surface& surface = surfaces[s];
        first_.push_back(static_cast<int>(faces_.size()));
        if (!surface.is_barrier()) continue;
        for (int n = 0; n < surface.faces(); ++n) {
            Face face{static_cast<int>(s), n, Vec3::Zero(), Vec3::Zero(), {}};
            face.patches = surface.kind == Surface::Kind::prism ? of_prism(*surface.prism, n, low, high, cell)
                                                                : of_shape(*surface.shape, n, cell);
            if (surface.kind == Surface::Kind::prism && n == surface.prism->top_face())
                face.patches.measure_top(*surface.prism, surfaces);
            else
                face.patches.measure(surfaces);
            if (surface.kind != Surface::Kind::prism) face.patches.off_face.clear();  // its faces are those of its box
            faces_.push_back(std::move(face));
        }
    }
}

Vec3 FaceLedger::moment_about(const Face& face, const Vec3& point) { return face.moment - point.cross(face.impulse); }

void FaceLedger::add(const FaceImpulse& part) {
    Face& face = faces_[static_cast<std::size_t>(part.face)];
    face.impulse += part.impulse;
    face.moment += part.moment;
    face.patches.spread(part.part, part.impulse);
}

void FaceLedger::serialize(Archive& archive) {
    for (std::size_t f = 0; f < faces_.size(); ++f) {
        Face& face = faces_[f];
        std::vector<double> numbers;
        for (const Vec3* v : {&face.impulse, &face.moment}) numbers.insert(numbers.end(), v->data(), v->data() + 3);
        for (const Vec3& impulse : face.patches.impulse)
            numbers.insert(numbers.end(), impulse.data(), impulse.data() + 3);
        const std::size_t expected = 3 * (2 + face.patches.impulse.size());
        archive.array("face_" + std::to_string(f), numbers);
        if (numbers.size() != expected) Archive::wrong_length("face", numbers.size(), expected);
        if (!archive.loading()) continue;
        const double* from = numbers.data();
        for (Vec3* v : {&face.impulse, &face.moment}) *v = Vec3(from[0], from[1], from[2]), from += 3;
        for (Vec3& impulse : face.patches.impulse) impulse = Vec3(from[0], from[1], from[2]), from += 3;
    }
}

}  // namespace frana
