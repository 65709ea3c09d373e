#pragma once
// Plausible values of friction and density by the kind of a mass, with their sources. One table: `frana describe`,
// remarks and cases/PARAMETERS.md have it from here.
#include <optional>
#include <string>
#include <vector>

namespace frana {

/// A row of the table. Friction is told as material.bed.mu, also where a case gives an angle.
struct ParameterRange {
    const char* kind;  ///< word of case.kind, or kFreeWater; "": grains in the laboratory, no kind
    const char* key;
    const char* law;  ///< word of material.bed.law that the values belong to; "": any
    double low, high;
    const char* what;    ///< what was fitted or measured
    const char* source;  ///< "": a common range, without a source that was read
};

/// Of rows that free water is judged by, whatever the kind of the mass.
inline constexpr const char* kFreeWater = "water";

/// A kind of mass, and its density where a case gives none [kg/m3]: the middle of the common range.
struct MassKind {
    const char* name;
    double density;
    const char* meaning;
};

const std::vector<MassKind>& mass_kinds();
const std::vector<ParameterRange>& parameter_ranges();

struct Plausible {
    double low = 0.0, high = 0.0;
};
/// From the lowest to the highest value in the rows of a kind, a key and a bed law. Nothing without a row.
std::optional<Plausible> plausible(const std::string& kind, const std::string& key, const std::string& law);

/// The key of the table that tells of a case key, and how its values become the case key's.
struct RangeKey {
    std::string key;
    double (*scale)(double);
};
/// material.bed.friction_angle_deg is material.bed.mu in degrees; strengths of a bed law are those of a rheology.
RangeKey range_key(const std::string& key);

/// Lines that `frana describe` adds to a key, each indented and ended; empty when no row has the key.
std::string ranges_in_words(const std::string& key);

/// The page cases/PARAMETERS.md.
std::string ranges_in_markdown();

}  // namespace frana
