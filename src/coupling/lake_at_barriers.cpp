#include "coupling/lake_at_barriers.h"

#include <algorithm>
#include <cmath>

#include "terrain/bed_points.h"

namespace frana {

double make_room_in_lake(Scene& scene, const Raster& bed) {
    if (!scene.still_surface || scene.solid) return 0.0;  // 3D points stand beside barriers
    constexpr double kCrumb = 0.03;  // of a particle; less is as little as the fit of masses leaves one (mass_fit.cpp)
    const Seeds all = std::move(scene.particles);
    scene.particles = {};
    double gone = 0.0;
    for (Index p = 0; p < all.count(); ++p) {
        const auto n = static_cast<std::size_t>(p);
        const double before = bed_elevation(bed, all.x[n], all.y[n]),
                     now = bed_elevation(scene.bed, all.x[n], all.y[n]);
        double share = 1.0;
        if (now > before && *scene.still_surface > before)
            share = std::max(0.0, (*scene.still_surface - now) / (*scene.still_surface - before));
        if (share < kCrumb) share = 0.0;
        gone += (1.0 - share) * all.volume[n];
        if (!(share > 0.0)) continue;
        scene.particles.append(all, p, p + 1);
        scene.particles.volume.back() *= share, scene.particles.depth.back() *= share;
    }
    return gone;
}

}  // namespace frana
