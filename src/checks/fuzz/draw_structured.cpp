// Particles that hold together, and grains: what a random case of them is made of.
#include <algorithm>

#include "checks/fuzz/draw.h"
#include "checks/fuzz/draw_structure.h"

namespace frana::fuzz {

void draw_structure(Dice& dice, Draft& draft) {
    const Scales of = scales_of(draft);
    const std::string s = "material.structure.";
    const double density = dice.decades(1300.0, 3000.0), weight = density * of.gravity * of.deepest;
    say(draft, "material.density", density);
    const std::string law = dice.one_of({"drucker_prager", "mohr_coulomb"});
    say(draft, s + "law", law);
    const double cohesion = dice.chance(0.3) ? 0.0 : weight * dice.decades(1e-2, 10.0);
    say(draft, s + "cohesion", cohesion);
    const double angle = dice.between(1.0, 60.0);
    say(draft, s + "friction_angle_deg", angle);
    if (dice.chance(0.4)) say(draft, s + "dilatancy_angle_deg", angle * dice.between(0.0, 1.0));
    if (law == "drucker_prager" && dice.chance(0.3)) say(draft, s + "cone", "plane_strain");
    say(draft, s + "young_modulus", (weight + cohesion + density * of.speed * of.speed) * dice.decades(10.0, 300.0));
    if (dice.chance(0.4)) say(draft, s + "poisson_ratio", dice.between(0.0, 0.45));
    say(draft, s + "fraction", dice.one_of({0.0, 1.0, 1.0, dice.between(0.0, 1.0)}));
    if (dice.chance(0.3)) say(draft, s + "earth_pressure", "hydrostatic");
    if (dice.chance(0.5)) say(draft, s + "damage", dice.one_of({"extension", "strain"}));
    say(draft, s + "critical_strain", dice.decades(1e-3, 1.0));
    if (dice.chance(0.3)) say(draft, s + "cfl", dice.between(0.05, 0.5));
    if (dice.chance(0.5)) draw_bed_law(dice, draft);
}

void draw_structured(Dice& dice, Draft& draft) {
    draw_ground(dice, draft);
    draw_release(dice, draft, {0.02, 3.0, 300});
    draw_structure(dice, draft);
}

}  // namespace frana::fuzz
