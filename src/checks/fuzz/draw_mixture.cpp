// Particles and grains with water in their pores, within them and around them.
#include "checks/fuzz/draw.h"
#include "checks/fuzz/draw_structure.h"

namespace frana::fuzz {

void draw_mixture(Dice& dice, Draft& draft) {
    draw_ground(dice, draft);
    draw_release(dice, draft, {0.02, 3.0, 200});
    draw_structure(dice, draft);
    draw_free_water(dice, draft);
    say(draft, "water.share", dice.chance(0.2) ? 0.0 : dice.between(0.05, 0.8));
    if (draft.keys["material.structure.fraction"] != "0.0" && dice.chance(0.5))
        say(draft, "material.structure.confined_water", dice.between(0.02, 0.5));
    if (dice.chance(0.2)) draw_level(dice, draft);
}

}  // namespace frana::fuzz
