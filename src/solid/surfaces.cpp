#include "solid/surfaces.h"

#include <algorithm>

#include "base/error.h"

namespace frana {
namespace {

/// Elevation and gradient of the bilinear bed.
struct Ground {
    double z, slope_x, slope_y;
};

Ground ground_at(const Raster& bed, double x, double y) {
    const GridGeometry& g = bed.geometry;
    const double u = std::clamp((x - g.x0) / g.cell, 0.0, static_cast<double>(g.nx - 1));
    const double v = std::clamp((y - g.y0) / g.cell, 0.0, static_cast<double>(g.ny - 1));
    const Index i = std::min(static_cast<Index>(u), g.nx - 2), j = std::min(static_cast<Index>(v), g.ny - 2);
    const double fu = u - static_cast<double>(i), fv = v - static_cast<double>(j);
    const double a = bed.at(i, j), b = bed.at(i + 1, j), c = bed.at(i, j + 1), d = bed.at(i + 1, j + 1);
    return {(1 - fv) * ((1 - fu) * a + fu * b) + fv * ((1 - fu) * c + fu * d),
            ((1 - fv) * (b - a) + fv * (d - c)) / g.cell, ((1 - fu) * (c - a) + fu * (d - b)) / g.cell};
}

}  // namespace

Surface Surface::plane(const Vec3& through, const Vec3& normal, Hold hold, double friction) {
    Surface s;
    s.normal = normal.normalized();
    s.offset = s.normal.dot(through);
    s.hold = hold;
    s.friction = friction;
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

Contact contact(const Surface& surface, const Vec3& x) {
    if (surface.kind == Surface::Kind::plane) return {surface.normal.dot(x) - surface.offset, surface.normal};
    const Ground g = ground_at(surface.bed, x.x(), x.y());
    const Vec3 normal = Vec3(-g.slope_x, -g.slope_y, 1.0).normalized();
    return {(x.z() - g.z) * normal.z(), normal};
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
            near = contact(surface, centre).distance - span < image_reach(surface.normal) * cell + more;
        } else {
            const double step = std::min(surface.bed.geometry.cell, cell);
            for (double y = low.y(); y < high.y() + step && !near; y += step)
                for (double x = low.x(); x < high.x() + step && !near; x += step) {
                    const Contact c = contact(surface, {x, y, low.z()});
                    near = c.distance < image_reach(c.normal) * cell + more;
                }
        }
        if (near) set |= SurfaceSet{1} << s;
    }
    return set;
}

Images::Images(const std::vector<Surface>& surfaces, SurfaceSet near, const Vec3& x, double cell) {
    Near list[kMostNear];
    int count = 0;
    for (; near != 0 && count < kMostNear; near &= near - 1) {
        const Surface& surface = surfaces[static_cast<std::size_t>(__builtin_ctz(near))];
        const Contact c = contact(surface, x);
        if (c.distance < image_reach(c.normal) * cell) list[count++] = {c, surface.hold == Hold::stuck};
    }
    reflect(list, count, {x, Mat3::Identity(), Mat3::Identity()}, 0);
}

/// Reflects in each of the surfaces, and these images in those listed behind; at most three times in a row.
void Images::reflect(const Near* near, int count, const Image& from, int depth) {
    constexpr double kOpposite = -0.5;
    for (int n = 0; n < count && count_ < kMost; ++n) {
        const Vec3& normal = near[n].contact.normal;
        const Mat3 mirror = Mat3::Identity() - 2.0 * normal * normal.transpose();
        const Image image{from.place - 2.0 * near[n].contact.distance * normal, mirror * from.turn,
                          near[n].stuck ? Mat3(-from.motion) : Mat3(mirror * from.motion)};
        list_[static_cast<std::size_t>(count_++)] = image;
        if (depth == 2) continue;
        Near others[kMostNear];
        int left = 0;
        for (int m = n + 1; m < count; ++m) {
            if (normal.dot(near[m].contact.normal) < kOpposite) continue;
            Near other = near[m];
            other.contact.distance += other.contact.normal.dot(image.place - from.place);
            if (other.contact.distance > 0.0)
                others[left++] = other;  // in a wide corner it may lie behind already
        }
        reflect(others, left, image, depth + 1);
    }
}

}  // namespace frana
