// Material beside the points that another model carries.
#include "base/error.h"
#include "solid/solid_flow.h"

namespace frana {

void SolidFlow::stand_beside(MaterialBeside material) {
    SolidBody::Beside& beside = body_.beside;
    const SolidSeeds& seeds = material.seeds;
    const std::size_t count = seeds.mass.size();
    expect(seeds.position.size() == count && seeds.velocity.size() == count && seeds.pressure.size() == count,
           "material beside points has a place, a velocity and a pressure each");
    beside.near.clear();
    const double h = body_.grid.cell();
    for (std::size_t p = 0; p < count; ++p)
        beside.near.push_back(surfaces_near(body_.surfaces, seeds.position[p], seeds.position[p], h,
                                            material.span * seeds.velocity[p].norm()));
    if (count > 0 && !beside.own) beside.own = LazyArray<SolidBody::Node>(body_.grid.size());
    if (count > 0 && !body_.real) body_.real = LazyArray<SolidBody::Node>(body_.grid.size());
    if (count == 0) beside.reaches.clear(), beside.tile_impulse.clear();
    beside.material = std::move(material);
}

}  // namespace frana
