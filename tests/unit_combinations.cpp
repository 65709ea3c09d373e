// What cannot go together: each row of the table is refused in its own words, and each is in the lists for people.
#include <algorithm>
#include <map>

#include "catch.h"
#include "scene/combinations.h"
#include "slope_case.h"

using namespace frana;
using namespace frana::test;

namespace {

using Are = Values::Are;
using Sets = std::map<std::string, std::string>;  ///< key and value as --set has them

bool among(const std::vector<std::string>& words, const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

bool begins(const std::string& key, const std::string& with) { return key.compare(0, with.size(), with) == 0; }

/// Values that a row speaks of, or (not `named`) those of the key that it does not.
std::vector<std::string> examples(const Values& values, bool named = true) {
    const Are are = values.are;
    if (are == Are::above_zero || are == Are::zero) return {named == (are == Are::zero) ? "0" : "0.5"};
    if (are == Are::on || are == Are::off) return {named == (are == Are::on) ? "true" : "false"};
    if (values.are == Are::without) return {"[\"png\"]"};
    const bool any = are == Are::given || are == Are::present;
    if (any && !named) return {};
    if (any) return {find_parameter(values.key)->kind == Kind::integer ? "1" : "0.5"};
    if (values.are == Are::tables) return {""};
    std::vector<std::string> all = find_parameter(values.key)->choices;
    all.erase(std::remove_if(all.begin(), all.end(),
                             [&](const std::string& word) {
                                 return (values.are == Are::words) == named ? !among(values.words, word)
                                                                            : among(values.words, word);
                             }),
              all.end());
    return all;
}

void give(Sets& sets, const std::string& key, const std::string& value) { sets.emplace(key, value); }

/// What the keys that are set need beside them: a structure for water, water for what lies within it, numbers for laws.
void complete(Sets& sets) {
    const auto any = [&](const std::string& table) {
        return std::any_of(sets.begin(), sets.end(), [&](const auto& set) { return begins(set.first, table); });
    };
    if (any("material.structure.confined_water")) give(sets, "water.model", "free");
    if (any("water.profile_factor"))
        give(sets, "water.model", "free"), give(sets, "material.structure.law", "drucker_prager");
    if (any("water.profile_factor") || any("water.solid_gradient")) give(sets, "water.viscous", "clear");
    const auto law = sets.find("material.bed.law");
    if (law != sets.end() && law->second == "pouliquen") give(sets, "material.bed.mu_2", "0.75");  // more than mu_s
    if (any("terrain.unrolled")) give(sets, "material.structure.law", "drucker_prager");
    if (any("material.structure.")) give(sets, "material.structure.law", "drucker_prager");
    const auto table = sets.find("material.bed.table");
    const bool by_table = table != sets.end() && table->second != "none";
    if (by_table) give(sets, "material.bed.law", "voellmy");
    for (const Parameter& parameter : parameters()) {
        if (by_table && parameter.table() == "material.bed") continue;  // it says what the law needs
        const auto chosen = sets.find(parameter.switch_key);
        if (chosen != sets.end() && among(parameter.required_by, chosen->second) && !sets.count(parameter.instead_of))
            give(sets, parameter.key, "0.5");
    }
}

/// One release is there to hit the other.
const std::string kLeast =
    "[terrain]\ndem = \"dem.tif\"\n[[release]]\ndepth = 1\n[[release]]\ndepth = 1\n[time]\nend = 1\n";
const std::map<std::string, std::string> kTables = {
    {"stage", "[[stage]]\nmodel = \"mpm3d\"\n"},
    {"inflow", "[[inflow]]\nname = \"a\"\nline = [[0, 0], [9, 0]]\nvolume = 10\n"},
    {"section", "[[section]]\nname = \"a\"\nline = [[0, 0], [9, 0]]\n"},
    {"barrier", "[[barrier]]\noutline = \"wall.geojson\"\nheight = 3\n"},
    {"insitu", "[[insitu]]\nname = \"a\"\nkind = \"threshold\"\nfield = \"depth\"\nfrom = 1\n"}};

/// "release.at" -> "release.0.at"; other keys as they are.
std::string in_first_table(const std::string& key) {
    const std::size_t dot = key.find('.');
    return among(repeated_tables(), key.substr(0, dot)) ? key.substr(0, dot) + ".0" + key.substr(dot) : key;
}

void parse(Sets sets, std::vector<std::string> tables) {
    if (sets.count("erodible.bed_evolves")) give(sets, "erodible.law", "energy");  // which has all of its numbers
    complete(sets);
    std::vector<std::string> arguments;
    for (const auto& [key, value] : sets) arguments.push_back(in_first_table(key) + "=" + value);
    CAPTURE(arguments);
    std::string text = kLeast;
    const std::string depth = "depth = 1\n";  // of the first release: a surface stands for it
    if (sets.count("release.surface")) text.erase(text.find(depth), depth.size());
    for (const auto& [key, value] : sets) {
        const std::string table = key.substr(0, key.find('.'));
        if (kTables.count(table) && !among(tables, table)) tables.push_back(table);
    }
    for (const std::string& table : tables) text += kTables.at(table);
    CaseFile::parse(text, "case.toml", arguments);
}

std::string in_message(const Values& values, const std::string& value) {
    const bool word = values.are == Are::words || values.are == Are::others;
    const std::string article = values.key[0] == 'i' ? "an " : "a ";
    return values.are == Are::tables ? article + values.key : word ? "\"" + value + "\"" : value;
}

/// The sentence of a row with these values.
std::string sentence(const Combination& row, const Values& partner, const std::string& value,
                     const std::string& other) {
    const bool table = row.refused.are == Are::tables;
    const std::string with = row.said.empty() ? " with " + partner.key + " = " + in_message(partner, other) : row.said;
    return (table ? "case.toml:9: " + row.refused.key + ".0" : "--set " + in_first_table(row.refused.key)) +
           ": found " + in_message(row.refused, value) + with + "; " + row.expected + "; " + row.way_out;
}

}  // namespace

TEST_CASE("What cannot go together is refused in the words of its row, and only together", "[case][combinations]") {
    for (const Combination& row : combinations()) {
        const bool table = row.refused.are == Are::tables;
        for (const Values& partner : row.with)
            for (const std::string& other : examples(partner)) {
                Sets sets;
                for (const Values& also : row.also) sets[also.key] = examples(also).front();
                std::vector<std::string> tables, none;
                if (table) tables.push_back(row.refused.key);
                if (partner.are == Are::tables)
                    tables.push_back(partner.key), none.push_back(partner.key);
                else
                    sets[partner.key] = other;
                for (const std::string& value : examples(row.refused)) {
                    Sets both = sets;
                    if (!table) both[row.refused.key] = value;
                    CAPTURE(row.refused.key, value, partner.key, other);
                    CHECK(only_problem([&] { parse(both, tables); }) == sentence(row, partner, value, other));
                }
                for (const std::string& value : examples(row.refused, false)) {
                    if (!table) sets[row.refused.key] = value;
                    CAPTURE(row.refused.key, value, partner.key, other);
                    CHECK_NOTHROW(parse(sets, none));
                }
            }
    }
}

TEST_CASE("Every combination that is refused is listed for people", "[case][combinations][describe]") {
    const std::string text = describe_combinations(), page = describe_in_markdown();
    for (const Combination& row : combinations())
        for (const std::string& list : {text, page}) {
            CAPTURE(row.refused.text());
            CHECK(list.find(row.refused.text()) != std::string::npos);
            CHECK(list.find(row.expected) != std::string::npos);
            CHECK(list.find(row.way_out) != std::string::npos);
            for (const Values& values : row.with) CHECK(list.find(values.text()) != std::string::npos);
            for (const Values& values : row.also) CHECK(list.find(" and " + values.text()) != std::string::npos);
        }
}
