#pragma once
// Yield stress and viscosity of mud by its concentration: fitted coefficients of samples.
#include <array>

namespace frana::mud {

/// tau_y = a1 exp(b1 Cv), eta = a2 exp(b2 Cv), Cv: volume concentration of solids [1] from 0.10 to 0.45.
struct Sample {
    const char* name;
    double a1, b1;  ///< [Pa], [1]
    double a2, b2;  ///< [Pa s], [1]
};

/// O'Brien and Julien 1988, J. Hydraul. Eng. 114, table 2, which is in dyn/cm2 and poise; divided by 10 here. The last
/// one: Geotechnics 2025, 5, 37.
inline constexpr std::array<Sample, 13> samples{{
    {"Aspen pit 1", 0.0181, 25.7, 0.0036, 22.1},
    {"Aspen pit 2", 0.272, 10.4, 0.00538, 14.5},
    {"Aspen natural soil", 0.0152, 18.7, 0.000136, 28.4},
    {"Aspen mine fill", 0.00473, 21.1, 0.0128, 12},
    {"Aspen natural soil, source area", 0.00383, 19.6, 4.95e-05, 27.1},
    {"Aspen mine fill, source area", 0.0291, 14.3, 2.01e-05, 33.1},
    {"Glenwood 1", 0.00345, 20.1, 0.000283, 23},
    {"Glenwood 2", 0.00765, 16.9, 0.00648, 6.2},
    {"Glenwood 3", 7.07e-05, 29.8, 0.000632, 19.9},
    {"Glenwood 4", 0.000172, 29.5, 6.02e-05, 33.1},
    {"Dai et al. 1980", 0.26, 17.48, 0.00075, 14.39},
    {"Kang and Zhang 1980", 0.175, 7.82, 0.00405, 8.29},
    {"coarse additions to 2 mm, sample GS-1 (Geotechnics 2025, 5, 37)", 0.0169, 20.29, 0.0173, 10.35},
}};

}  // namespace frana::mud
