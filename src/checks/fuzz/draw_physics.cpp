// What the mass of a random case is made of, and how it is solved.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "checks/fuzz/draw.h"
#include "scene/parameters.h"

namespace frana::fuzz {
namespace {

bool has(const std::vector<std::string>& words, const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

double draw_mu(Dice& dice) { return dice.one_of({0.0, 1e-6, 0.1, 0.4, 1.0, 3.0, 10.0, dice.between(0.0, 1.0)}); }

/// Some keys of the scheme off their defaults.
void draw_parts(Dice& dice, Draft& draft) {
    if (dice.chance(0.2)) say(draft, "scheme.filter", dice.one_of({0.0, 0.5, 1.0}));
    if (dice.chance(0.2)) say(draft, "scheme.wave_shift", dice.one_of({0.0, 0.5, 2.0}));
    if (dice.chance(0.2)) draft.keys["scheme.margin"] = "false";
    if (dice.chance(0.2)) say(draft, "scheme.sub_point_reach", dice.one_of({0.0, 0.1, 0.25}));
    if (dice.chance(0.2)) say(draft, "scheme.margin_limit", dice.one_of({0.0, 1.0, 4.0}));
    if (dice.chance(0.2)) say(draft, "scheme.viscosity_linear", dice.one_of({0.0, 0.5, 1.0}));
    if (dice.chance(0.2)) say(draft, "scheme.viscosity_quadratic", dice.one_of({0.0, 1.0, 2.0}));
    if (dice.chance(0.2)) draft.keys["scheme.split"] = "false";
    if (dice.chance(0.2)) draft.keys["scheme.merge"] = "false";
    if (dice.chance(0.2)) draft.keys["scheme.reset_domains"] = "false";
    if (dice.chance(0.2)) say(draft, "scheme.split_length", dice.one_of({0.5, 0.8, 1.0, 1.5}));
    if (dice.chance(0.2)) say(draft, "scheme.split_min_mass", dice.one_of({0.0, 0.02, 0.5}));
    if (dice.chance(0.2)) say(draft, "scheme.strain_rate_floor", dice.decades(1e-6, 1.0));
    if (dice.chance(0.2)) say(draft, "scheme.stress_cap", dice.one_of({0.05, 0.25, 0.5}));
}

}  // namespace

std::string toml_number(double value) {
    const std::string text = fmt::format("{}", value);
    return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
}

void say(Draft& draft, const std::string& key, const std::string& word) { draft.keys[key] = "\"" + word + "\""; }
void say(Draft& draft, const std::string& key, double number) { draft.keys[key] = toml_number(number); }

void draw_bed_keys(Dice& dice, Draft& draft, const std::string& law) {
    for (const Parameter& key : parameters()) {
        if (key.switch_key != "material.bed.law" || !has(key.required_by, law) || draft.has(key.instead_of)) continue;
        const double low = std::isinf(key.range.low) ? 0.0 : key.range.low;
        say(draft, key.key,
            std::isinf(key.range.high) ? low + dice.decades(1e-4, 1e6) : dice.between(low, key.range.high));
    }
}

void draw_bed_law(Dice& dice, Draft& draft) {
    std::vector<std::string> laws = {"none", "coulomb", "voellmy", "voellmy", "manning", "bingham", "pouliquen"};
    const auto known = laws;
    for (const std::string& law : find_parameter("material.bed.law")->choices)
        if (!has(known, law)) laws.push_back(law);
    const std::string law = laws[dice.below(static_cast<Index>(laws.size()))];
    say(draft, "material.bed.law", law);
    if (!has(known, law)) return draw_bed_keys(dice, draft, law);
    if (law != "none" && law != "pouliquen") say(draft, "material.bed.mu", draw_mu(dice));
    if (law == "voellmy") say(draft, "material.bed.xi", dice.decades(1e-3, 1e7));
    if (law == "manning") say(draft, "material.bed.manning_n", dice.decades(1e-4, 1.0));
    if (law == "bingham") {
        say(draft, "material.bed.viscosity", dice.decades(1e-4, 1e6));
        say(draft, "material.bed.yield_stress", dice.chance(0.2) ? 0.0 : dice.decades(1e-4, 1e6));
    }
    if (law == "pouliquen") {
        const double slow = dice.decades(0.01, 3.0);
        say(draft, "material.bed.mu_s", slow);
        say(draft, "material.bed.mu_2", slow * dice.decades(1.001, 3.0));
        say(draft, "material.bed.i0", dice.decades(1e-3, 10.0));
        say(draft, "material.bed.grain_diameter", dice.decades(1e-5, 1.0));
    }
}

void draw_material(Dice& dice, Draft& draft) {
    draw_bed_law(dice, draft);
    if (dice.chance(0.5)) say(draft, "material.density", dice.decades(50.0, 5000.0));
    const std::string law = dice.one_of({"none", "none", "newtonian", "bingham"});
    if (law == "none") return;
    say(draft, "material.rheology.law", law);
    say(draft, "material.rheology.viscosity", dice.decades(1e-4, 1e6));
    if (law == "bingham") say(draft, "material.rheology.yield_stress", dice.decades(1e-4, 1e6));
}

void draw_scheme(Dice& dice, Draft& draft) {
    const bool paper = dice.chance(0.12);
    if (paper) say(draft, "scheme.preset", "paper");
    std::string shape = paper ? dice.one_of({"linear", "quadratic"})
                              : dice.one_of({"quadratic", "quadratic", "quadratic", "quadratic", "linear", "cubic"});
    std::string transfer = dice.chance(paper ? 0.4 : 0.3) ? dice.one_of({"tpic", "apic", "flip", "pic"})
                           : paper                        ? "pic"
                                                          : "tpic";
    if (shape == "linear" && transfer == "apic") transfer = "tpic";
    if (shape != (paper ? "linear" : "quadratic")) say(draft, "scheme.shape", shape);
    if (transfer != (paper ? "pic" : "tpic")) say(draft, "scheme.transfer", transfer);
    if (transfer == "flip" && dice.chance(0.5)) say(draft, "scheme.flip_ratio", dice.one_of({0.5, 0.95, 1.0}));
    if (dice.chance(0.5)) say(draft, "scheme.cfl", dice.between(0.02, paper ? 0.25 : 0.5));
    if (!paper) {
        const std::string model = dice.one_of({"steep", "steep", "steep", "shallow", "linearised"});
        if (model != "steep") say(draft, "terrain.model", model);
        const std::string curvature = dice.one_of({"full", "full", "inertia", "none"});
        if (model != "shallow" && curvature != "full") say(draft, "terrain.curvature", curvature);
        const double cell = draft.dem().geometry.cell;
        if (dice.chance(0.4)) say(draft, "scheme.curvature_length", dice.one_of({0.0, 2.0, 8.0}) * cell);
    }
    if (dice.chance(0.25)) draw_parts(dice, draft);
}

}  // namespace frana::fuzz
