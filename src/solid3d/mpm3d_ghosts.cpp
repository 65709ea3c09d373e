// Material adjacent to the points that another model carries.
#include "base/error.h"
#include "solid3d/mpm3d.h"

namespace frana {

void Mpm3d::set_adjacent(GhostParticles material) {
    SolidBody::Ghosts& ghosts = body_.ghosts;
    const SolidSeeds& seeds = material.seeds;
    const std::size_t count = seeds.mass.size();
    expect(seeds.position.size() == count && seeds.velocity.size() == count && seeds.pressure.size() == count &&
               material.gradient.size() == count,
           "ghost particles have a place, a velocity with its gradient and a pressure each");
    if (count > 0)
        make_room_for_ghosts();
    else
        ghosts.reaches.clear(), ghosts.tile_impulse.clear();
    ghosts.near.clear();
    ghosts.material = std::move(material);
    for (std::size_t p = 0; p < count; ++p) note_near(p);
}

void Mpm3d::set_adjacent(const DepartedPoint& point) {
    GhostParticles& material = body_.ghosts.material;
    make_room_for_ghosts();
    if (material.empty()) material.time = point.time;
    material.seeds.add(point.position - (point.time - material.time) * point.velocity, point.velocity, point.mass,
                       point.pressure);
    material.gradient.push_back(point.gradient);
    note_near(material.seeds.mass.size() - 1);
}

void Mpm3d::make_room_for_ghosts() {
    if (!body_.ghosts.own) body_.ghosts.own = LazyArray<SolidBody::Node>(body_.grid.size());
    if (!body_.real) body_.real = LazyArray<SolidBody::Node>(body_.grid.size());
}

/// Surfaces that a seed may come near to while it goes on.
void Mpm3d::note_near(std::size_t seed) {
    const GhostParticles& m = body_.ghosts.material;
    body_.ghosts.near.push_back(surfaces_near(body_.surfaces, m.seeds.position[seed], m.seeds.position[seed],
                                              body_.grid.cell(), m.span * m.seeds.velocity[seed].norm()));
}

}  // namespace frana
