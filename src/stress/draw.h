#pragma once
// Random hostile cases. The same seed and number give the same draft on every machine.
#include <cstdint>

#include "stress/dice.h"
#include "stress/draft.h"

namespace frana::stress {

/// Case `n` of the series `seed`: slopes to 80 degrees, cliffs, pits, noise, nodata, films beside masses, all laws and
/// schemes; some of them piles below their friction angle, lakes, or mirror images of themselves.
Draft draw(std::uint64_t seed, std::uint64_t n);

/// Shape of the ground, of the release, what it is made of, how it is solved: the parts of draw().
void draw_terrain(Dice& dice, Draft& draft);
void draw_release(Dice& dice, Draft& draft);
void draw_material(Dice& dice, Draft& draft);
void draw_scheme(Dice& dice, Draft& draft);
/// A pile on a plane whose surface is nowhere as steep as friction holds; in place of the four above.
void draw_pile(Dice& dice, Draft& draft);
/// Still water over any ground; in place of draw_release and draw_material.
void draw_lake(Dice& dice, Draft& draft);
/// Makes every raster, and velocity, its own mirror image.
void mirror(Draft& draft, Mirror mirror);

/// A number as TOML with all its digits.
std::string toml_number(double value);

}  // namespace frana::stress
