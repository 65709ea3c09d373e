#include "coupling/spray.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "convert/flow_particles.h"
#include "observe/archive.h"
#include "scene/scene.h"
#include "solid3d/mpm3d.h"
#include "terrain/bed_points.h"

namespace frana {

Spray::Spray(const Scene& scene) : gravity_(scene.gravity) {
    const Seeds& s = scene.particles;
    double highest = -INFINITY;
    for (Index n = 0; n < s.count(); ++n) {
        const auto k = static_cast<std::size_t>(n);
        const Vec2 v(s.vx[k], s.vy[k]);
        const double climb = bed_gradient(scene.bed, s.x[k], s.y[k]).dot(v), v2 = v.squaredNorm() + climb * climb;
        highest = std::fmax(highest, bed_below(scene.bed, s.x[k], s.y[k]) + s.depth[k] + 0.5 * v2 / gravity_);
    }
    available_ = head_ = highest_ = highest;
    if (s.count() > 0) highest_ = -INFINITY;
}

void Spray::sample(const Mpm3d& flow) {
    constexpr double kSlack = 1.01 * 1.01;  // one per cent of the speed
    const MaterialPoints& points = flow.body().points;
    double all = 0.0, above = 0.0;
    for (Index p = 0; p < points.count(); ++p) {
        const double z = flow.position(p).z(), v2 = flow.velocity(p).squaredNorm(),
                     m = points.mass[static_cast<std::size_t>(p)];
        all += m;
        head_ = std::max(head_, z + 0.5 * v2 / gravity_);
        if (v2 > kSlack * 2.0 * gravity_ * std::max(0.0, available_ - z)) {
            above += m;
        } else {
            fastest_ = std::max(fastest_, std::sqrt(v2));
            highest_ = std::max(highest_, z);
        }
    }
    if (!(above > most_share_ * all)) return;
    most_share_ = above / all, time_ = flow.status().time;
}

std::optional<std::string> Spray::remark() const {
    if (!(most_share_ > 0.0)) return {};
    std::string text = fmt::format(
        "3D points: {:.2g} % of their mass had more energy than a fall from the release's highest head gives. "
        "That head "
        "is {:.6g} m, the largest of a point {:.6g} m; most had more at {:.6g} s. Spray may have more; do not build on "
        "the "
        "largest speed and run-up of single points",
        100.0 * most_share_, available_, head_, time_);
    if (std::isfinite(highest_))
        text += fmt::format(". The others had at most {:.4g} m/s and came up to {:.6g} m", fastest_, highest_);
    return text;
}

void Spray::serialize(Archive& archive) {
    archive.numbers("spray", {&most_share_, &time_, &head_, &fastest_, &highest_});
}

}  // namespace frana
