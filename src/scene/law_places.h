#pragma once
// Laws whose numbers may vary spatially: where a case gives them, and what its zones call them.
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "law/catalogue.h"
#include "scene/case_file.h"

namespace frana {

struct LawPlace {
    const char* choice;   ///< key of the word that chooses the law
    const char* table;    ///< what its numbers' keys begin with
    const char* in_zone;  ///< what they begin with in [[material.zone]], behind the zone's number
};

inline constexpr LawPlace kBedPlace{"material.bed.law", "material.bed.", ""};
inline constexpr LawPlace kRheologyPlace{"material.rheology.law", "material.rheology.", "rheology."};
inline constexpr LawPlace kWaterPlace{"water.friction", "water.", "water."};
inline constexpr std::array<LawPlace, 3> kLawPlaces = {kBedPlace, kRheologyPlace, kWaterPlace};

/// "material.rheology.viscosity" of "rheology.viscosity", a zone's name; of a name without a dot, that of the bed law.
inline std::string key_of_zone_name(const std::string& name) {
    for (const LawPlace& place : kLawPlaces) {
        const std::string beginning = place.in_zone;
        if (!beginning.empty() && name.compare(0, beginning.size(), beginning) == 0)
            return place.table + name.substr(beginning.size());
    }
    return kBedPlace.table + name;
}

/// The law that a case chooses, from its other keys. A number that is a raster stays the law's own.
template <class Law>
Law law_of(const CaseFile& file, const LawPlace& of) {
    return laws::Catalogue<Law>::make(file.word(of.choice), [&](const std::string& name) {
        const std::string key = of.table + name;
        const bool number = file.has(key) && !file.is_text(key);  // a raster is for scene_friction.cpp
        return number ? std::optional<double>(file.number(key)) : std::nullopt;
    });
}

/// The numbers of a struct of parameters that a case has, each by its key in `table`.
template <class Law>
void read_numbers(const CaseFile& file, const std::string& table, const std::vector<laws::Key<Law>>& keys, Law& law) {
    for (const laws::Key<Law>& key : keys)
        if (file.has(table + key.name)) law.*key.parameter = key.convert(file.number(table + key.name));
}

}  // namespace frana
