#pragma once
// How the rows of the parameter table are written down. Private to the files that hold the table.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "law/catalogue.h"
#include "scene/law_places.h"
#include "scene/parameters.h"

namespace frana {

using Table = std::vector<Parameter>;

/// The keys of [[insitu]] and [[camera]] (parameter_table_insitu.cpp).
void add_insitu(Table& table);

/// The keys of [material.structure] (parameter_table_structure.cpp).
void add_structure(Table& table);

/// The keys of [erodible] (parameter_table_erodible.cpp).
void add_erodible(Table& table);

/// The keys of [deposition] (parameter_table_deposition.cpp).
void add_deposition(Table& table);

/// The keys of [forest] (parameter_table_forest.cpp).
void add_forest(Table& table);

/// The keys of [water] (parameter_table_water.cpp).
void add_water(Table& table);

/// The keys of [[barrier]] and of [[stage]] (parameter_table_stages.cpp).
void add_barriers(Table& table);
void add_stages(Table& table);

/// The keys of [survey] (parameter_table_survey.cpp).
void add_survey(Table& table);

namespace rows {

using namespace ranges;

inline Value text(const char* value) { return std::string(value); }

inline Parameter make(const char* key, Kind kind, const char* unit, const char* meaning) {
    Parameter parameter;
    parameter.key = key;
    parameter.kind = kind;
    parameter.unit = unit;
    parameter.meaning = meaning;
    return parameter;
}

inline Parameter number(const char* key, const char* unit, Range range, const char* meaning) {
    Parameter parameter = make(key, Kind::number, unit, meaning);
    parameter.range = range;
    return parameter;
}

inline Parameter number(const char* key, const char* unit, Range range, double fallback, const char* meaning) {
    Parameter parameter = number(key, unit, range, meaning);
    parameter.fallback = fallback;
    return parameter;
}

inline Parameter flag(const char* key, bool fallback, const char* meaning) {
    Parameter parameter = make(key, Kind::flag, "", meaning);
    parameter.fallback = fallback;
    return parameter;
}

inline Parameter choice(const char* key, std::vector<std::string> choices, const char* fallback, const char* meaning) {
    Parameter parameter = make(key, Kind::choice, "", meaning);
    parameter.choices = std::move(choices);
    parameter.fallback = text(fallback);
    return parameter;
}

inline Parameter required(Parameter parameter) {
    parameter.required = true;
    return parameter;
}

inline Parameter absent(Parameter parameter, const char* consequence) {
    parameter.absent = consequence;
    return parameter;
}

inline Parameter instead(Parameter parameter, const char* other) {
    parameter.instead_of = other;
    return parameter;
}

/// Refused without that key of the same table; the rules of the case say so in words of their own.
inline Parameter goes_with(Parameter parameter, const char* other) {
    parameter.only_with = other;
    return parameter;
}

/// Another default under the preset "paper", the choices of Fois et al. (2024).
inline Parameter paper(Parameter parameter, Value value) {
    parameter.otherwise.push_back({"scheme.preset", text("paper"), std::move(value)});
    return parameter;
}

/// Another default under the preset "fast": fewer particles.
inline Parameter fast(Parameter parameter, Value value) {
    parameter.otherwise.push_back({"scheme.preset", text("fast"), std::move(value)});
    return parameter;
}

/// Used with these choices of `key` only, and needed with those of `needed_by`.
inline Parameter with(Parameter parameter, const char* key, std::vector<std::string> used_by,
                      std::vector<std::string> needed_by = {}) {
    parameter.switch_key = key;
    parameter.used_by = std::move(used_by);
    parameter.required_by = std::move(needed_by);
    return parameter;
}

/// The numbers of laws that may vary spatially, each a number or a raster. Laws bring their own keys.
template <class Law>
void add_numbers(Table& table, const LawPlace& place) {
    for (const laws::SharedKey& key : laws::Catalogue<Law>::keys()) {
        const std::string name = place.table + key.name;
        Parameter row = number(name.c_str(), key.unit.c_str(), key.range, key.meaning.c_str());
        row.kind = Kind::number_or_path;
        if (key.usual) row.fallback = *key.usual;
        if (!key.instead_of.empty()) row.instead_of = place.table + key.instead_of;
        table.push_back(with(row, place.choice, key.used_by, key.needed_by));
    }
}

/// The row of a key that a law's own list has, in `table`.
template <class Law>
Parameter of_law(const std::string& table, const std::vector<laws::Key<Law>>& keys, const std::string& name) {
    const auto key = std::find_if(keys.begin(), keys.end(), [&](const auto& one) { return one.name == name; });
    expect(key != keys.end(), "a key of the law's list");
    Parameter row = number((table + name).c_str(), key->unit, key->range, key->meaning);
    if (key->missing == laws::Missing::usual) {
        const double usual = Law{}.*key->parameter;
        expect(key->convert(usual) == usual, "a default that is the same in the key's unit");
        row.fallback = usual;
    }
    if (*key->instead_of) row.instead_of = table + key->instead_of;
    return row;
}

}  // namespace rows
}  // namespace frana
