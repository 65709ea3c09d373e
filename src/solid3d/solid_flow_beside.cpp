// Material beside the points that another model carries.
#include "base/error.h"
#include "solid3d/solid_flow.h"

namespace frana {

void SolidFlow::stand_beside(MaterialBeside material) {
    SolidBody::Beside& beside = body_.beside;
    const SolidSeeds& seeds = material.seeds;
    const std::size_t count = seeds.mass.size();
    expect(seeds.position.size() == count && seeds.velocity.size() == count && seeds.pressure.size() == count &&
               material.gradient.size() == count,
           "material beside points has a place, a velocity with its gradient and a pressure each");
    if (count > 0) make_room_beside();
    else beside.reaches.clear(), beside.tile_impulse.clear();
    beside.near.clear();
    beside.material = std::move(material);
    for (std::size_t p = 0; p < count; ++p) note_near(p);
}

void SolidFlow::stand_beside(const DepartedPoint& point) {
    MaterialBeside& material = body_.beside.material;
    make_room_beside();
    if (material.empty()) material.time = point.time;
    material.seeds.add(point.position - (point.time - material.time) * point.velocity, point.velocity, point.mass,
                       point.pressure);
    material.gradient.push_back(point.gradient);
    note_near(material.seeds.mass.size() - 1);
}

void SolidFlow::make_room_beside() {
    if (!body_.beside.own) body_.beside.own = LazyArray<SolidBody::Node>(body_.grid.size());
    if (!body_.real) body_.real = LazyArray<SolidBody::Node>(body_.grid.size());
}

/// Surfaces that a seed may come near to while it goes on.
void SolidFlow::note_near(std::size_t seed) {
    const MaterialBeside& m = body_.beside.material;
    body_.beside.near.push_back(surfaces_near(body_.surfaces, m.seeds.position[seed], m.seeds.position[seed],
                                              body_.grid.cell(), m.span * m.seeds.velocity[seed].norm()));
}

}  // namespace frana
