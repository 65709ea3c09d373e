#pragma once
// A small 3D scene for tests: a lump of material that falls on a rough slope, beside a wall.
#include "checks/verify/body.h"

namespace frana {

inline SolidScene lump(const SolidLaw& law) {
    SolidScene s;
    s.law = law;
    s.density = 1000.0;
    s.grid.cell = 0.1;
    s.grid.origin = {-0.4, -0.4, -0.4};
    s.grid.nodes = {25, 21, 21};
    s.surfaces = {Surface::plane({0, 0, 0}, Vec3(0.2, 0.1, 1.0), Hold::free, 0.3),
                  Surface::plane({0, 0, 0}, {1, 0, 0})};
    verify::for_each_part({0.1, 0.1, 0.05}, {1.1, 0.9, 0.75}, 0.1, 2, [&](const Vec3& x, double volume) {
        s.points.add(x, {-0.5, 0.2 * x.z(), 0.0}, s.density * volume);
    });
    return s;
}

/// The same with points that keep their velocities.
inline SolidScene kept(SolidScene s) {
    s.affine = Affine::tpic;
    s.flip = true;
    s.blending = 0.1;
    return s;
}

inline std::vector<SolidLaw> all_solid_laws() {
    const solid::Elastic elastic = solid::Elastic::of(4e5, 0.3);
    return {solid::Fluid{4e5, 1.0},
            solid::Bingham{4e5, 1e5, 10.0, 500.0},
            elastic,
            solid::DruckerPrager::of(elastic, 0.5, 100.0),
            solid::HerschelBulkley{4e5, 1e5, 20.0, 0.5, 500.0},
            solid::MuI{elastic, 0.4, 0.7, 0.3, 0.02, 0.6, 1000.0}};
}

}  // namespace frana
