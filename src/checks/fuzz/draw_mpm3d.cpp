// 3D points from the start: what a random case of them is made of.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "checks/fuzz/draw.h"
#include "checks/fuzz/draw_3d.h"

namespace frana::fuzz {
namespace {

/// The stage's table.
std::string key(const std::string& stage, const char* name) { return stage + "." + name; }

/// A law of 3D material, as strong and stiff as suits its depth within some powers of ten.
void draw_law(Dice& dice, Draft& draft, const std::string& stage, const Scales& of) {
    std::string law = dice.one_of(
        {"fluid", "fluid", "fluid", "bingham", "herschel_bulkley", "drucker_prager", "drucker_prager", "elastic"});
    if (law == "drucker_prager" && dice.chance(0.3)) law = "mu_i";
    const double density = dice.decades(300.0, 3000.0), weight = density * of.gravity * of.deepest;
    say(draft, "material.density", density);
    say(draft, key(stage, "law"), law);
    // A viscosity that the step has to be cut for by no more than a few times.
    const double thick = density * of.wave * of.deepest;
    if (law == "fluid" && dice.chance(0.5)) say(draft, key(stage, "viscosity"), thick * dice.decades(1e-6, 1e-1));
    if (law == "bingham") say(draft, key(stage, "viscosity"), thick * dice.decades(1e-6, 1e-1));
    if (law == "bingham" || law == "herschel_bulkley")
        say(draft, key(stage, "yield_stress"), weight * dice.decades(1e-3, 3.0));
    if (law == "herschel_bulkley") {
        say(draft, key(stage, "consistency"), thick * dice.decades(1e-6, 1e-2));
        say(draft, key(stage, "exponent"), dice.between(0.2, 1.0));
    }
    if (law == "drucker_prager" || law == "mu_i" || law == "elastic") {
        say(draft, key(stage, "young_modulus"), (weight + density * of.speed * of.speed) * dice.decades(30.0, 1000.0));
        if (dice.chance(0.5)) say(draft, key(stage, "poisson_ratio"), dice.between(0.0, 0.45));
    }
    if (law == "drucker_prager") {
        say(draft, key(stage, "friction_angle_deg"), dice.between(5.0, 60.0));
        if (dice.chance(0.4)) say(draft, key(stage, "cohesion"), weight * dice.decades(1e-3, 1.0));
        if (dice.chance(0.3)) say(draft, key(stage, "cone"), dice.one_of({"plane_strain", "simple_shear"}));
    }
    if (law == "mu_i") {
        const double slow = dice.between(0.05, 1.0);
        say(draft, key(stage, "mu_s"), slow);
        say(draft, key(stage, "mu_2"), slow + dice.decades(1e-2, 1.0));
        say(draft, key(stage, "grain_diameter"), of.deepest * dice.decades(1e-4, 1.0));
        if (dice.chance(0.5)) say(draft, key(stage, "i0"), dice.decades(1e-2, 10.0));
    }
    if ((law == "fluid" || law == "bingham") && dice.chance(0.2))
        say(draft, key(stage, "sound_speed"), of.wave * dice.between(8.0, 30.0));
}

void draw_walls(Dice& dice, Draft& draft, const std::string& stage) {
    if (dice.chance(0.3))
        draft.keys[key(stage, "closed")] = dice.one_of({"[\"west\"]", "[\"north\", \"east\"]", "[\"south\"]"});
    if (!dice.chance(0.2)) return;
    const GridGeometry& g = draft.dem().geometry;
    draft.keys["barrier#0.line"] = line_across(dice, g);
    say(draft, "barrier#0.height", g.cell * dice.decades(0.3, 5.0));
    if (dice.chance(0.3)) say(draft, "barrier#0.friction", dice.between(0.0, 1.0));
    if (dice.chance(0.2)) draft.keys["barrier#0.stuck"] = "true", draft.keys.erase("barrier#0.friction");
}

}  // namespace

std::string line_across(Dice& dice, const GridGeometry& g) {
    const auto place = [&] {
        const double x = g.x0 + g.cell * dice.between(1.0, static_cast<double>(g.nx - 2));
        const double y = g.y0 + g.cell * dice.between(1.0, static_cast<double>(g.ny - 2));
        return fmt::format("[{}, {}]", toml_number(x), toml_number(y));
    };
    const std::string from = place();
    return fmt::format("[{}, {}]", from, place());
}

double draw_3d(Dice& dice, Draft& draft, const std::string& stage) {
    const Scales of = scales_of(draft);
    const double terrain_cell = draft.dem().geometry.cell, most = 2500.0;
    double cell = terrain_cell * dice.one_of({0.4, 0.5, 0.5, 0.7, 1.0});
    const double share = dice.one_of({0.5, 0.5, 0.5, 0.34, 0.7});
    cell = std::max(cell, std::cbrt(of.volume / most) / share);
    say(draft, key(stage, "model"), "mpm3d");
    say(draft, key(stage, "cell"), cell);
    say(draft, key(stage, "spacing"), share * cell);
    draw_law(dice, draft, stage, of);
    const bool stuck = dice.chance(0.15);
    if (stuck) draft.keys[key(stage, "stuck")] = "true";
    if (dice.chance(0.6)) {
        const double friction = dice.one_of({0.0, 0.1, 0.3, 0.7, 2.0});  // drawn in any case: later numbers stay
        if (!stuck) say(draft, key(stage, "bed_friction"), friction);
    }
    if (dice.chance(0.3)) say(draft, key(stage, "cfl"), dice.between(0.05, 0.5));
    if (dice.chance(0.3)) say(draft, key(stage, "transfer"), dice.one_of({"tpic", "apic", "flip"}));
    if (dice.chance(0.15)) draft.keys[key(stage, "split")] = "true";
    if (dice.chance(0.2)) say(draft, key(stage, "profile"), dice.one_of({"linear", "parabolic", "bagnold"}));
    if (dice.chance(0.2)) say(draft, key(stage, "vertical"), "zero");
    draw_walls(dice, draft, stage);
    return cell;
}

void draw_mpm3d(Dice& dice, Draft& draft) {
    draw_ground(dice, draft);
    draw_release(dice, draft, {0.15, 3.0, 120});
    draw_3d(dice, draft, "stage#0");
}

}  // namespace frana::fuzz
