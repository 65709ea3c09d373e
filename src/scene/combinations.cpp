#include "scene/combinations.h"

#include <fmt/format.h>

#include <algorithm>

namespace frana {
namespace {

using Are = Values::Are;

/// `"a", "b" or "c"`.
std::string quoted(const std::vector<std::string>& words) {
    std::string text;
    for (std::size_t k = 0; k < words.size(); ++k)
        text += fmt::format("{}\"{}\"", k == 0 ? "" : k + 1 < words.size() ? ", " : " or ", words[k]);
    return text;
}

bool among(const std::vector<std::string>& words, const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

bool of_words(Are are) { return are == Are::words || are == Are::others; }

/// As messages write it.
std::string value_text(const CaseFile& file, const Values& values, const std::string& key) {
    if (of_words(values.are) || (values.are != Are::tables && file.is_text(key))) return "\"" + file.word(key) + "\"";
    if (values.are == Are::on || values.are == Are::on_later) return "true";
    if (values.are == Are::off) return "false";
    if (values.are == Are::tables) return (values.key[0] == 'i' ? "an " : "a ") + values.key;
    return fmt::format("{:.6g}", file.number(key));
}

/// "release.at" -> "release.0.at", "release.1.at", as many as there are; other keys as they are. With
/// a neighbour in such a table the one key in the same.
std::vector<std::string> keys_of(const CaseFile& file, const std::string& key, const std::string& neighbour) {
    const std::size_t dot = key.find('.');
    const std::string table = key.substr(0, dot);
    if (dot == std::string::npos || !among(repeated_tables(), table)) return {key};
    if (neighbour.compare(0, dot + 1, table + ".") == 0)
        return {neighbour.substr(0, neighbour.rfind('.')) + key.substr(dot)};
    std::vector<std::string> keys;
    for (Index i = 0; i < file.count(table); ++i) keys.push_back(fmt::format("{}.{}{}", table, i, key.substr(dot)));
    return keys;
}

/// Of a key of a release.
bool enters_later(const CaseFile& file, const std::string& key) {
    const std::string table = key.substr(0, key.rfind('.') + 1);
    return file.number(table + "at") > 0.0 || file.flag(table + "when_hit");
}

bool holds(const CaseFile& file, const Values& values, const std::string& key) {
    if (values.are == Are::tables) return file.count(key) > 0;
    if (values.are == Are::present) return file.given(key);
    if (values.are == Are::given) return file.given(key) && (file.is_text(key) || file.number(key) > 0.0);
    if (!file.has(key)) return false;
    switch (values.are) {
        case Are::words:
            return among(values.words, file.word(key));
        case Are::others:
            return !among(values.words, file.word(key));
        case Are::without:
            return !among(file.words(key), values.words.front());
        case Are::above_zero:
            return file.number(key) > 0.0;
        case Are::zero:
            return file.number(key) == 0.0;
        case Are::on:
            return file.flag(key);
        case Are::on_later:
            return file.flag(key) && enters_later(file, key);
        default:
            return !file.flag(key);
    }
}

Values is(const char* key, std::vector<std::string> words) { return {key, Are::words, std::move(words)}; }
Values is_not(const char* key, std::vector<std::string> words) { return {key, Are::others, std::move(words)}; }

/// A model that has no use for keys of the depth-averaged flow's scheme.
struct OtherModel {
    Values with;
    std::vector<Values> also;
    std::string who, said, own_cfl;
};

void add_scheme_of(std::vector<Combination>& table, const OtherModel& model) {
    const auto unused = [&](Values refused, const std::string& expected, const std::string& way_out = "remove it") {
        table.push_back({std::move(refused), {model.with}, "expected " + expected, way_out, model.said, model.also});
    };
    unused({"scheme.cfl", Are::given}, "none: " + model.who + " takes its own steps", model.own_cfl);
    unused(is_not("scheme.transfer", {"tpic"}), "\"tpic\": " + model.who + " has no other");
    unused(is("scheme.precision", {"float"}), "\"double\": " + model.who + " has no other");
    unused({"scheme.lateral_drag", Are::above_zero}, "0: " + model.who + " has no such drag");
    unused({"scheme.merge", Are::on}, "false: " + model.who + " is never merged");
    unused({"scheme.wave_shift", Are::above_zero}, "0: " + model.who + " stays where its velocity takes it");
    unused({"scheme.mass_fit", Are::on}, "false: " + model.who + " has its own mass");
    unused({"scheme.strain_rate_floor", Are::given}, "none: " + model.who + " has no rheology");
    unused({"scheme.stress_cap", Are::given}, "none: " + model.who + " has no rheology");
}

/// What only the depth-averaged flow has: neither structured particles nor free water do.
void add_structure(std::vector<Combination>& table) {
    const Values structure = is_not("material.structure.law", {"none"}), free = is("water.model", {"free"});
    const std::vector<Values> either = {structure, free};
    table.push_back({{"terrain.unrolled", Are::on},
                     {is("material.structure.law", {"none"})},
                     "expected it with structured particles only",
                     "remove it, or give the mass a structure"});
    table.push_back({is_not("material.rheology.law", {"none"}),
                     {structure},
                     "expected \"none\": the structure is what resists inside the mass",
                     "remove one of them"});
    table.push_back({{"terrain.unrolled", Are::on},
                     {is("terrain.curvature", {"full"})},
                     "expected \"none\" there: coordinates along the ground know no bend",
                     "remove one of them"});
    table.push_back({is("terrain.curvature", {"inertia"}), either,
                     "expected \"full\" or \"none\": grains press on a bend with all of their weight there",
                     "choose one of them"});
    table.push_back({is_not("terrain.model", {"steep"}), either, "expected \"steep\"", "remove it"});
    table.push_back({is_not("scheme.preset", {"default"}), either, "expected \"default\"", "remove it"});
    table.push_back({is_not("scheme.shape", {"quadratic"}), either, "expected \"quadratic\"", "remove it"});
    table.push_back({{"inflow", Are::tables},
                     {structure},
                     "expected none: what comes in is the depth-averaged flow or free water",
                     "remove it, give a [[release]], or set water.model = \"free\" for water that comes in",
                     {},
                     {is("water.model", {"none"})}});
    table.push_back({{"section", Are::tables},
                     either,
                     "expected none: what passes a line is known of the depth-averaged flow alone",
                     "remove it, or use [[gauge]] or [[profile]]"});
    table.push_back({{"stage", Are::tables},
                     either,
                     "expected none: structured particles and free water go from the start to the end",
                     "remove it"});
}

/// Of what flows as water alone: keys of solids, and of the depth-averaged flow's material.
void add_water_alone(std::vector<Combination>& table) {
    const OtherModel water{is("water.model", {"free"}),
                           {is("material.structure.law", {"none"})},
                           "water",
                           " with water.model = \"free\" and without material.structure",
                           "remove it"};
    const auto refuse = [&](Values refused, const std::string& expected, const char* way_out) {
        table.push_back({std::move(refused), {water.with}, expected, way_out, water.said, water.also});
    };
    refuse({"material.density", Are::given}, "expected none: what is released and comes in is water",
           "remove it, and give water.density if it is not 1000");
    std::vector<Values> one_law = water.also;
    one_law.push_back(is_not("material.bed.law", {"none"}));
    for (const char* other : {"water.friction", "water.viscous"})
        table.push_back({is_not(other, {"none"}),
                         {water.with},
                         "expected \"none\": material.bed brakes what flows",
                         "remove one of them",
                         " with material.bed",
                         one_law});
    refuse(is_not("material.rheology.law", {"none"}), "expected \"none\": water has the viscosity of water.viscous",
           "remove it, and give water.viscous");
    refuse({"water.share", Are::above_zero}, "expected 0: all that is released is water", "remove it");
    const auto of_solids = [&](Values refused, const std::string& usual) {
        refuse(std::move(refused), "expected " + usual + ": there are no solids for the water to meet",
               "remove it, or give the mass a structure");
    };
    for (const char* key : {"water.grain_diameter", "water.block_diameter", "water.drag_power", "water.pore_pressure",
                            "water.void_ratio"})
        of_solids({key, Are::given}, "none");
    of_solids(is_not("water.drag", {"split"}), "\"split\"");
    of_solids(is_not("water.virtual_mass", {"none"}), "\"none\"");
    of_solids({"water.solid_gradient", Are::on}, "false");
    add_scheme_of(table, water);
}

/// What free water, and water within a structure, do not have.
void add_water(std::vector<Combination>& table) {
    const Values free = is("water.model", {"free"});
    table.push_back({{"barrier", Are::tables},
                     {free},
                     "expected none, since water does not know them",
                     "raise the elevation model there"});
    table.push_back({{"terrain.unrolled", Are::on},
                     {free},
                     "expected coordinates on the map, where water finds its level",
                     "remove one of them"});
    table.push_back({{"material.structure.confined_water", Are::above_zero},
                     {is("water.model", {"none"})},
                     "expected 0, since what breaks has to give its water somewhere",
                     "remove it, or set water.model = \"free\"",
                     " without free water"});
    table.push_back({{"material.structure.confined_water", Are::above_zero},
                     {{"material.structure.fraction", Are::zero}},
                     "expected 0, since what has no structure holds no water in it",
                     "use water.share for water in the pores",
                     " with fraction = 0"});
    table.push_back({{"water.profile_factor", Are::above_zero},
                     {{"water.solid_gradient", Are::off}},
                     "expected 0, since it is a part of that term",
                     "set water.solid_gradient = true, or remove it",
                     " without water.solid_gradient"});
}

/// What an erodible bed is not designed for.
void add_erodible_bed(std::vector<Combination>& table) {
    const Values erodible = is_not("erodible.law", {"none"});
    table.push_back({is_not("scheme.shape", {"quadratic"}),
                     {erodible},
                     "expected \"quadratic\", the shapes that share out a bed",
                     "remove it, or the erodible bed"});
    table.push_back({is("scheme.preset", {"paper"}),
                     {erodible},
                     "expected \"default\" or \"fast\": particles of that preset carry a depth that no mass can join",
                     "remove it, or the erodible bed"});
    for (const Values& other : {is_not("material.structure.law", {"none"}), is("water.model", {"free"})})
        table.push_back({other,
                         {erodible},
                         "expected \"none\": a mass that holds together, and free water, take up no bed",
                         "remove one of them"});
}

/// What takes mass out of the flow and leaves it on the ground: where it cannot.
struct Leaves {
    Values with;
    std::string what, leave, it;  ///< "what is left behind", "leave no bed behind", "the deposition"
};

void add_leaves(std::vector<Combination>& table, const Leaves& leaves) {
    const std::string way_out = "remove it, or " + leaves.it;
    const auto refuse = [&](Values refused, const std::string& expected, const std::string& advice) {
        table.push_back({std::move(refused), {leaves.with}, "expected " + expected, advice});
    };
    refuse({"erodible.bed_evolves", Are::off}, "true: " + leaves.what + " raises the ground", way_out);
    refuse(is_not("scheme.shape", {"quadratic"}), "\"quadratic\", the shapes that share out a bed", way_out);
    refuse(is("scheme.preset", {"paper"}),
           "\"default\" or \"fast\": particles of that preset carry a depth that no bed can take over", way_out);
    for (const Values& other : {is_not("material.structure.law", {"none"}), is("water.model", {"free"})})
        refuse(other, "\"none\": a mass that holds together, and free water, " + leaves.leave, "remove one of them");
    refuse({"stage", Are::tables}, "none: points in 3D " + leaves.leave, "remove the stage, or " + leaves.it);
}

/// What the schemes of the depth-averaged flow do not have.
void add_schemes(std::vector<Combination>& table) {
    const Values paper = is("scheme.preset", {"paper"});
    table.push_back({is_not("terrain.curvature", {"none"}),
                     {is("terrain.model", {"shallow"})},
                     "expected \"none\", since that model has no curvature",
                     "remove it, or set terrain.model = \"steep\""});
    table.push_back({is_not("terrain.model", {"shallow"}),
                     {paper},
                     "expected \"shallow\", the only terrain that preset has",
                     "remove it, or use the default preset"});
    table.push_back({is("scheme.shape", {"cubic"}),
                     {paper},
                     "expected \"linear\" or \"quadratic\"",
                     "choose one of them, or scheme.preset = \"default\""});
    table.push_back({is("scheme.transfer", {"apic"}),
                     {is("scheme.shape", {"linear"})},
                     "expected \"tpic\", \"flip\" or \"pic\", since apic here is the one of quadratic shapes",
                     "choose one of them, or scheme.shape = \"quadratic\""});
    table.push_back(
        {is("scheme.precision", {"float"}),
         {is("scheme.preset", {"paper"}), is_not("scheme.shape", {"quadratic"}), is_not("scheme.transfer", {"tpic"})},
         "expected \"double\", since only the default kernels have the other",
         "remove it, or use the default preset, shape and transfer",
         " with another preset, shape or transfer than the default"});
}

/// What runs with a 3D stage do not have.
void add_space(std::vector<Combination>& table) {
    table.push_back({{"inflow", Are::tables},
                     {{"stage", Are::tables}},
                     "expected none: material comes in to the depth-averaged flow alone",
                     "remove one of them",
                     " with a stage"});
    table.push_back({{"inflow", Are::tables},
                     {is("scheme.preset", {"paper"})},
                     "expected \"default\" or \"fast\": that preset has no rows that come in",
                     "remove one of them"});
    table.push_back({{"section", Are::tables},
                     {{"stage", Are::tables}},
                     "expected none: 3D points that pass a line are not counted",
                     "remove it, or use [[gauge]] or [[profile]]",
                     " with a stage"});
}

/// Only the depth-averaged flow, with its own scheme, takes in releases later.
void add_late_releases(std::vector<Combination>& table) {
    for (const Values& late : {Values{"release.at", Are::above_zero}, Values{"release.when_hit", Are::on}}) {
        const std::string none = late.are == Are::on ? "expected false: " : "expected 0: ";
        table.push_back({late,
                         {is_not("material.structure.law", {"none"}), is("water.model", {"free"})},
                         none + "what holds together, and water, begin at the start",
                         "remove it, or the structure or the water; water may come in later by [[inflow]]"});
        table.push_back({late,
                         {{"stage", Are::tables}},
                         none + "releases enter the depth-averaged flow alone",
                         "remove it, or the stage",
                         " with a stage"});
        table.push_back({late,
                         {is("scheme.preset", {"paper"})},
                         none + "that preset begins with all of its particles",
                         "remove it, or use the default preset"});
    }
}

/// Releases that stand in the bed until they go.
void add_late_scars(std::vector<Combination>& table) {
    const Values scar{"release.included_in_dem", Are::on_later};
    table.push_back(
        {scar,
         {is_not("scheme.shape", {"quadratic"})},
         "expected false where the release enters later: its bed falls then, with \"quadratic\" shapes only",
         "remove scheme.shape, or give an elevation model without the mass"});
    table.push_back({scar,
                     {{"erodible.bed_evolves", Are::off}},
                     "expected false where the release enters later: its bed falls then, and this one stays",
                     "remove erodible.bed_evolves, or give an elevation model without the mass"});
}

/// Keys of one table that say different things of the same.
void add_within_tables(std::vector<Combination>& table) {
    const Values normal = is("release.thickness", {"normal"}), in_dem{"release.included_in_dem", Are::on};
    const Values surface{"release.surface", Are::present};
    table.push_back({normal,
                     {surface},
                     "expected \"vertical\": depth = surface - bed is vertical",
                     "remove thickness, or give depth"});
    table.push_back({in_dem,
                     {surface},
                     "expected depth, since the elevation model is the surface already",
                     "give depth = ..., a number or a raster of the thickness"});
    table.push_back({{"release.at", Are::above_zero},
                     {{"release.when_hit", Are::on}},
                     "expected one of the two: a time, or the flow that sets it going",
                     "remove one of them"});
    const std::string one_of_both = "expected one of both: what is stuck does not slide";
    table.push_back(
        {{"barrier.friction", Are::above_zero}, {{"barrier.stuck", Are::on}}, one_of_both, "remove one of them"});
    table.push_back(
        {{"stage.bed_friction", Are::present}, {{"stage.stuck", Are::on}}, one_of_both, "remove one of them"});
    table.push_back({{"stage.blending", Are::present},
                     {is("stage.transfer", {"tpic", "apic"})},
                     "expected it with \"flip\" only",
                     "remove it, or choose \"flip\""});
    table.push_back({{"insitu.gis", Are::on},
                     {is("insitu.of", {"particles"})},
                     "expected the grid, whose cells have an outline",
                     "remove one of them"});
    const Values by_table = is_not("material.bed.table", {"none"});
    table.push_back({by_table,
                     {is_not("material.bed.law", {"voellmy"})},
                     "expected law = \"voellmy\", whose mu and xi it has",
                     "choose that law, or remove the table"});
    for (const char* key : {"material.bed.mu", "material.bed.friction_angle_deg", "material.bed.xi"})
        table.push_back({{key, Are::present},
                         {by_table},
                         "expected one of them",
                         "remove one of them, or give it in a [[material.zone]], which wins over the table"});
}

std::string with_text(const Combination& row) {
    std::string text;
    for (const Values& values : row.with) text += (text.empty() ? "" : ", or ") + values.text();
    for (const Values& values : row.also) text += " and " + values.text();
    return text;
}

}  // namespace

std::vector<std::string> Values::keys_in(const CaseFile& file, const std::string& neighbour) const {
    std::vector<std::string> found;
    for (const std::string& one : keys_of(file, key, neighbour))
        if (holds(file, *this, one)) found.push_back(one);
    return found;
}

std::string Values::text() const {
    switch (are) {
        case Are::words:
            return fmt::format("{} = {}", key, quoted(words));
        case Are::others:
            return fmt::format("{} other than {}", key, quoted(words));
        case Are::without:
            return fmt::format("{} without {}", key, quoted(words));
        case Are::above_zero:
            return key + " above 0";
        case Are::zero:
            return key + " = 0";
        case Are::on:
            return key + " = true";
        case Are::on_later:
            return key + " = true where it enters later";
        case Are::off:
            return key + " = false";
        case Are::given:
        case Are::present:
            return key;
        default:
            return "[[" + key + "]]";
    }
}

bool Combination::applies(const CaseFile& file, const std::string& key) const {
    const auto holds = [&](const Values& values) { return !values.keys_in(file, key).empty(); };
    return std::any_of(with.begin(), with.end(), holds) && std::all_of(also.begin(), also.end(), holds);
}

std::vector<std::string> Combination::found(const CaseFile& file) const {
    std::vector<std::string> keys;
    for (const std::string& key : refused.keys_in(file))
        if ((refused.are == Are::tables || file.given(key)) && applies(file, key)) keys.push_back(key);
    return keys;
}

std::string Combination::found_text(const CaseFile& file, const std::string& key) const {
    std::string beyond = said;
    for (const Values& other : with) {
        const std::vector<std::string> keys = other.keys_in(file, key);
        if (beyond.empty() && !keys.empty())
            beyond = fmt::format(" with {} = {}", other.key, value_text(file, other, keys.front()));
    }
    return "found " + value_text(file, refused, key) + beyond;
}

const std::vector<Combination>& combinations() {
    static const std::vector<Combination> all = [] {
        std::vector<Combination> table;
        add_schemes(table);
        add_structure(table);
        add_scheme_of(table, {is_not("material.structure.law", {"none"}),
                              {},
                              "a structured particle",
                              {},
                              "remove it, and give material.structure.cfl"});
        add_water(table);
        add_water_alone(table);
        add_erodible_bed(table);
        add_leaves(table, {is_not("deposition.law", {"none"}), "what is left behind", "leave no bed behind",
                           "the deposition"});
        add_leaves(
            table,
            {{"forest.detrainment", Are::given}, "what trees hold back", "leave nothing in a forest", "the forest"});
        add_space(table);
        add_late_releases(table);
        add_late_scars(table);
        add_within_tables(table);
        table.push_back({is_not("output.film", {"none"}),
                         {{"output.formats", Are::without, {"vtk"}}},
                         "expected the frames that a film is made of",
                         "add \"vtk\" to output.formats, or remove film",
                         " without \"vtk\" in output.formats"});
        return table;
    }();
    return all;
}

bool refused_if_given(const CaseFile& file, const std::string& key) {
    return std::any_of(combinations().begin(), combinations().end(), [&](const Combination& row) {
        if (row.refused.key != without_numbers(key) || !row.applies(file, key)) return false;
        const bool any = row.refused.are == Are::given || row.refused.are == Are::present;
        return any || holds(file, row.refused, key);
    });
}

std::string describe_combinations() {
    std::string text = "Combinations that are refused\n";
    for (const Combination& row : combinations())
        text += fmt::format("\n{}\n    with {}\n    {}\n    {}\n", row.refused.text(), with_text(row), row.expected,
                            row.way_out);
    return text;
}

std::string combinations_in_markdown() {
    std::string text =
        "\n## Combinations that are refused\n\nAlso printed by `frana describe --combinations`.\n\n"
        "| Given | With | Expected | What to do |\n|---|---|---|---|\n";
    for (const Combination& row : combinations())
        text += fmt::format("| {} | {} | {} | {} |\n", row.refused.text(), with_text(row), row.expected, row.way_out);
    return text;
}

}  // namespace frana
