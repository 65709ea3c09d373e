#pragma once
// What structured particles and the water with them are, in a random case.
#include "checks/fuzz/draw.h"

namespace frana::fuzz {

/// [material.structure], the density and perhaps a bed law, for what the draft lets go.
void draw_structure(Dice& dice, Draft& draft);
/// Friction, viscosity and exchange of free water.
void draw_free_water(Dice& dice, Draft& draft);
/// The level of a lake somewhere between the lowest and the highest ground.
void draw_level(Dice& dice, Draft& draft);

}  // namespace frana::fuzz
