#pragma once
// Random hostile cases. The same seed and number give the same draft on every machine.
#include <algorithm>
#include <cstdint>

#include "checks/fuzz/dice.h"
#include "checks/fuzz/draft.h"

namespace frana::fuzz {

/// Case `n` of the series `seed`: slopes to 80 degrees, cliffs, pits, noise, nodata, films next to masses. All laws and
/// schemes occur. Some of them are piles below their friction angle, lakes, or mirror images of themselves.
Draft draw(std::uint64_t seed, std::uint64_t n);

/// Case `n` of the series `seed` that `model` carries: each has its own series. That of depth_averaged is draw(seed, n).
Draft draw(Model model, std::uint64_t seed, std::uint64_t n);
/// The model of case `n` where several are drawn, each as often as the others.
Model model_of(const std::vector<Model>& models, std::uint64_t seed, std::uint64_t n);

/// All of a case that another model carries, but for its end and its claims on bits.
void draw_mpm3d(Dice& dice, Draft& draft);       ///< 3D points from the start, on all of the terrain
void draw_structured(Dice& dice, Draft& draft);  ///< particles that hold together, and grains
void draw_water(Dice& dice, Draft& draft);       ///< a lake, rain, a wave of water, with little that is solid
void draw_mixture(Dice& dice, Draft& draft);     ///< particles and grains with water in their pores and within them
void draw_flood(Dice& dice, Draft& draft);       ///< water alone: releases, a lake, rain, inflows, sides of all kinds
void draw_staged(Dice& dice, Draft& draft);      ///< particles, 3D points in a window, and perhaps particles again

/// Shape of the ground, of the release, what it is made of, how it is solved: the parts of draw().
void draw_terrain(Dice& dice, Draft& draft);
void draw_release(Dice& dice, Draft& draft);
void draw_material(Dice& dice, Draft& draft);
void draw_scheme(Dice& dice, Draft& draft);
/// A pile on a plane whose surface is nowhere as steep as friction holds; in place of the four above.
void draw_pile(Dice& dice, Draft& draft);
/// Still water over any ground; in place of draw_release and draw_material.
void draw_lake(Dice& dice, Draft& draft);
/// Loose ground under what is drawn so far, where the scheme has that.
void draw_erodible(Dice& dice, Draft& draft);
/// A bed that the flow of what is drawn so far becomes, soon after it has come to rest.
void draw_deposition(Dice& dice, Draft& draft);
/// Trees that take mass out of what is drawn so far.
void draw_forest(Dice& dice, Draft& draft);
/// A line through which more comes in, where the terrain has room for one.
void draw_inflow(Dice& dice, Draft& draft);
/// An area over which more comes in, at rest, where the terrain has room for one.
void draw_spring(Dice& dice, Draft& draft);
/// Another release, which enters at a time or when the flow reaches it.
void draw_late(Dice& dice, Draft& draft);
/// A zone, or a raster, of a number of a law that is drawn so far. The law is at the bed, inside, or of water.
void draw_friction(Dice& dice, Draft& draft);
/// Makes every raster, and velocity, its own mirror image.
void mirror(Draft& draft, Mirror mirror);

/// Whether all pixels up to five away are as `fits(i, j)` says. That is more than a run needs between a release and a
/// hole.
template <class Fits>
bool all_near(const GridGeometry& grid, Index i, Index j, Fits&& fits) {
    for (Index b = std::max<Index>(0, j - 5); b <= std::min(grid.ny - 1, j + 5); ++b)
        for (Index a = std::max<Index>(0, i - 5); a <= std::min(grid.nx - 1, i + 5); ++a)
            if (!fits(a, b)) return false;
    return true;
}

/// A number as TOML with all its digits.
std::string toml_number(double value);
/// A key whose value is a word, or a number.
void say(Draft& draft, const std::string& key, const std::string& word);
void say(Draft& draft, const std::string& key, double number);

/// A line from one random place of a terrain to another, as TOML.
std::string line_across(Dice& dice, const GridGeometry& grid);

/// Parts of those that other models use too.
void draw_bed_law(Dice& dice, Draft& draft);
/// The keys that a bed law needs, anywhere in their ranges.
void draw_bed_keys(Dice& dice, Draft& draft, const std::string& law);
/// Where the material lies on the ground of the draft. It has depths of `least` to `most` cells, no more than `pixels`
/// of them, half of the time in motion.
struct ReleaseKind {
    double least, most;
    Index pixels;
};
void draw_release(Dice& dice, Draft& draft, const ReleaseKind& kind);
/// Makes the ground flatter until no node is more than `rise` cells higher than its neighbour.
void flatten(Draft& draft, double rise);
/// Ground for material that is not the depth-averaged flow's: as draw_terrain, at most as steep as it draws.
void draw_ground(Dice& dice, Draft& draft);
/// What is let go, as it is drawn so far [m], [m/s]: depth, speed, and the speed that it can reach.
struct Scales {
    double deepest, volume, speed, wave, gravity;
};
Scales scales_of(const Draft& draft);

}  // namespace frana::fuzz
