// The table itself, and how values are found in it.
#include "scene/parameter_ranges.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"

namespace frana {
namespace {

constexpr const char* bed_mu = "material.bed.mu";
constexpr const char* bed_xi = "material.bed.xi";
constexpr const char* manning = "material.bed.manning_n";
constexpr const char* water_manning = "water.manning_n";
constexpr const char* darcy = "water.darcy_f";
constexpr const char* material_density = "material.density";
constexpr const char* yield = "material.rheology.yield_stress";
constexpr const char* viscosity = "material.rheology.viscosity";
constexpr const char* salm_guide =
    "Voellmy-Salm classes, raster tool of the Norwegian Geotechnical Institute "
    "(norwegian-geotechnical-institute/Avaframe-Workshop)";
constexpr const char* martinelli = "Martinelli, Lang and Mears 1980, J. Glaciol.";
constexpr const char* obrien = "O'Brien and Julien 1988, J. Hydraul. Eng. 114, table 2; Geotechnics 2025, 5, 37";
constexpr const char* jop = "Jop, Forterre and Pouliquen 2006, Nature 441, 727";
constexpr const char* frank =
    "Frank et al. 2015, Nat. Hazards Earth Syst. Sci. 15, 2569, who fitted it at the Illgraben";
constexpr const char* half_to_twice = "half to twice the published value";
constexpr const char* in_common_use = "";

}  // namespace

const std::vector<MassKind>& mass_kinds() {
    static const std::vector<MassKind> kinds = {
        {"snow", 300.0, "flowing snow of avalanches"},
        {"debris_flow", 1900.0, "water with stones and fines"},
        {"rock_avalanche", 2100.0, "broken rock"},
        {"mud", 1600.0, "water with fines"},
    };
    return kinds;
}

const std::vector<ParameterRange>& parameter_ranges() {
    static const std::vector<ParameterRange> table = {
        {"snow", bed_mu, "voellmy", 0.14, 0.47, "all sizes, grounds, altitudes and return periods", salm_guide},
        {"snow", bed_xi, "voellmy", 900.0, 4000.0, "all sizes, grounds and altitudes", salm_guide},
        {"snow", bed_mu, "voellmy", 0.155, 0.155, "ten very long run-outs, for zoning",
         "Buser and Frutiger 1980, J. Glaciol."},
        {"snow", bed_xi, "voellmy", 1120.0, 1120.0, "ten very long run-outs, for zoning",
         "Buser and Frutiger 1980, J. Glaciol."},
        {"snow", bed_mu, "voellmy", 0.15, 0.15, "large design avalanches", martinelli},
        {"snow", bed_xi, "voellmy", 1200.0, 1600.0, "large design avalanches", martinelli},
        {"snow", bed_xi, "voellmy", 700.0, 800.0, "hard slab, slow wet slab, soft slab through timber", martinelli},
        {"snow", material_density, "", 200.0, 400.0, "flowing snow", in_common_use},
        {"snow", "erodible.energy", "", 5000.0, 5000.0, "default of com1DFA", "AvaFrame, configuration of com1DFA"},
        {"debris_flow", bed_mu, "", 0.03, 0.40, "back-analysed events", in_common_use},
        {"debris_flow", bed_xi, "voellmy", 100.0, 1000.0,
         "back-analysed events; granular ones lower, muddy ones higher", in_common_use},
        {"debris_flow", manning, "manning", 0.10, 0.18, "back-analysed events", in_common_use},
        {"debris_flow", yield, "", 500.0, 5000.0, "field estimates", in_common_use},
        {"debris_flow", viscosity, "", 10.0, 1000.0, "field estimates", in_common_use},
        {"debris_flow", material_density, "", 1700.0, 2100.0, "flowing", in_common_use},
        {"debris_flow", "erodible.rate", "", 0.0125, 0.05, half_to_twice, frank},
        {"debris_flow", "erodible.threshold", "", 500.0, 2000.0, half_to_twice, frank},
        {"debris_flow", "erodible.depth_per_stress", "", 0.5e-4, 2e-4, half_to_twice, frank},
        {"rock_avalanche", bed_mu, "voellmy", 0.03, 0.35, "back-analysed events; on glaciers and wet ground lowest",
         in_common_use},
        {"rock_avalanche", bed_xi, "voellmy", 100.0, 1000.0, "back-analysed events", in_common_use},
        {"rock_avalanche", bed_mu, "coulomb", 0.25, 0.58, "bulk friction, 14 to 30 degrees", in_common_use},
        {"rock_avalanche", material_density, "", 1800.0, 2400.0, "broken rock", in_common_use},
        {"mud", yield, "", 0.54, 528.0, "13 samples at volume concentrations of 0.30 to 0.40", obrien},
        {"mud", viscosity, "", 0.042, 34.0, "13 samples at volume concentrations of 0.30 to 0.40", obrien},
        {"mud", yield, "", 20.0, 500.0, "mudflows; earth flows reach 10 000 Pa", in_common_use},
        {"mud", viscosity, "", 1.0, 100.0, "mudflows", in_common_use},
        {"mud", manning, "manning", 0.03, 0.06, "hyperconcentrated flows", in_common_use},
        {"mud", material_density, "", 1300.0, 1900.0, "flowing", in_common_use},
        {kFreeWater, water_manning, "", 0.008, 0.3, "channels and floodplains, from glass flumes to willows",
         in_common_use},
        {kFreeWater, water_manning, "", 0.1, 0.8, "sheet flow of centimetres through grass and woods", in_common_use},
        {kFreeWater, darcy, "", 0.005, 10.0, "channels, from smooth ones to beds of boulders", in_common_use},
        {kFreeWater, darcy, "", 1.0, 100.0, "sheet flow of centimetres through grass and woods", in_common_use},
        {"", "material.bed.mu_s", "pouliquen", 0.38, 0.38, "glass beads", jop},
        {"", "material.bed.mu_2", "pouliquen", 0.64, 0.64, "glass beads", jop},
        {"", "material.bed.i0", "pouliquen", 0.279, 0.279, "glass beads", jop},
    };
    return table;
}

RangeKey range_key(const std::string& key) {
    const auto same = [](double value) { return value; };
    if (key == "material.bed.friction_angle_deg")
        return {bed_mu, [](double tangent) { return std::atan(tangent) * 180.0 / constants::kPi; }};
    if (key == "material.bed.yield_stress") return {yield, same};
    if (key == "material.bed.viscosity") return {viscosity, same};
    return {key, same};
}

std::optional<Plausible> plausible(const std::string& kind, const std::string& key, const std::string& law) {
    std::optional<Plausible> all;
    for (const ParameterRange& row : parameter_ranges()) {
        if (row.kind != kind || row.key != key || (*row.law && row.law != law)) continue;
        if (!all) all = Plausible{row.low, row.high};
        all->low = std::min(all->low, row.low);
        all->high = std::max(all->high, row.high);
    }
    return all;
}

}  // namespace frana
