#include "solid3d/face_ledger.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace frana {
namespace {

Patches squares(const Vec3& origin, const Vec3& right, const Vec3& up, const Vec2& length, double size) {
    Patches p{origin, right, up, size, {}, {}};
    for (int n = 0; n < 2; ++n)
        p.count[static_cast<std::size_t>(n)] =
            std::max<Index>(1, static_cast<Index>(std::ceil(length[n] / size - 1e-9)));
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
    return squares({edge.from.x(), edge.from.y(), from.z()}, {edge.along.x(), edge.along.y(), 0.0}, {0, 0, 1},
                   {edge.length, to.z() - from.z()}, cell);
}

/// Of a shape: its box's sides, onto which its surface is projected.
Patches of_shape(const DistanceField& shape, int number, double cell) {
    const auto [least, most] = shape.box();
    const int axis = number / 2, a = (axis + 1) % 3, b = (axis + 2) % 3;
    const Vec3 size = most - least;
    return squares(least, Vec3::Unit(a), Vec3::Unit(b), {size[a], size[b]}, cell);
}

}  // namespace

Index Patches::at(const Vec3& x) const {
    const auto place = [&](const Vec3& way, std::size_t n) {
        const double far = way.dot(x - origin) / size;
        return static_cast<Index>(std::clamp(far, 0.0, static_cast<double>(count[n] - 1)));
    };
    return place(up, 1) * count[0] + place(right, 0);
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
            faces_.push_back(std::move(face));
        }
    }
}

Vec3 FaceLedger::moment_about(const Face& face, const Vec3& point) { return face.moment - point.cross(face.impulse); }

void FaceLedger::add(const FaceImpulse& part) {
    Face& face = faces_[static_cast<std::size_t>(part.face)];
    face.impulse += part.impulse;
    face.moment += part.moment;
    face.patches.impulse[static_cast<std::size_t>(part.patch)] += part.impulse;
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
