#pragma once
// Friction of snow avalanches by size, ground, altitude and return period: the Voellmy-Salm classes.
#include <algorithm>
#include <array>
#include <cstddef>

namespace frana::salm {

/// Classes of released volume, ground, altitude and return period, from the first entry of each table to the last.
inline constexpr std::array<const char*, 4> size_names{"tiny", "small", "medium", "large"};
inline constexpr std::array<const char*, 4> ground_names{"flat or convex", "open slope", "channelled", "gully"};
/// The first three sizes end below these volumes [m3].
inline constexpr std::array<double, 3> size_limits{5000.0, 25000.0, 60000.0};
/// The size of that volume [m3], as a place in size_names.
inline std::size_t size_of(double volume) {
    return static_cast<std::size_t>(std::upper_bound(size_limits.begin(), size_limits.end(), volume) -
                                    size_limits.begin());
}
/// The second and third altitude class begin here [m]; in Switzerland, elsewhere shifted by the local tree line.
inline constexpr std::array<double, 2> altitude_limits{1000.0, 1500.0};
/// [years]
inline constexpr std::array<double, 4> return_periods{10.0, 30.0, 100.0, 300.0};

using Altitudes = std::array<double, 3>;                                   ///< low, middle, high
using Grounds = std::array<Altitudes, 4>;                                  ///< as ground_names
using ByPeriod = std::array<Grounds, 4>;                                   ///< as return_periods
inline constexpr std::size_t tiny = 0, channelled = 2, hundred_years = 2;  ///< where a value is interpolated

/// Source of both tables: fric_coeffs_RAMMS_10-300y.txt of the raster tool of the Norwegian Geotechnical Institute
/// (github.com/norwegian-geotechnical-institute/Avaframe-Workshop, MIT licence). It has mu and k = g/xi; xi here is
/// 9.81/k, rounded to 50. Values belong to RAMMS, the model that they were fitted with. Two slips of that file are
/// mended here.
/// - medium, channelled, 10 and 300 years: two altitudes' k are exchanged; xi is that of 30 and 100 years;
/// - tiny, channelled, 100 years: mu .310/.295/.280 there, below that of 300 years. Here it is interpolated in the
///   logarithm of the period between 30 and 300 years, rounded to 0.005.

/// Turbulence coefficient [m/s2], by size, ground and altitude. It does not depend on the return period.
inline constexpr std::array<Grounds, 4> xi{{
    {{{1500, 1600, 1750}, {1250, 1400, 1500}, {1050, 1200, 1250}, {900, 1000, 1050}}},
    {{{2000, 2250, 2500}, {1500, 1750, 2000}, {1200, 1350, 1500}, {1000, 1100, 1200}}},
    {{{2500, 2900, 3250}, {1750, 2100, 2500}, {1350, 1550, 1750}, {1100, 1200, 1350}}},
    {{{3000, 3500, 4000}, {2000, 2500, 3000}, {1500, 1750, 2000}, {1200, 1350, 1500}}},
}};

/// Tangent of the dry friction angle [1], by size, return period, ground and altitude.
inline constexpr std::array<ByPeriod, 4> mu{{
    {{
        {{{.295, .285, .275}, {.330, .305, .290}, {.370, .355, .340}, {.470, .460, .450}}},
        {{{.290, .280, .270}, {.320, .300, .285}, {.360, .345, .330}, {.460, .450, .440}}},
        {{{.285, .275, .265}, {.300, .290, .275}, {.350, .335, .320}, {.450, .440, .430}}},
        {{{.280, .270, .260}, {.300, .290, .275}, {.340, .330, .310}, {.440, .430, .420}}},
    }},
    {{
        {{{.270, .255, .240}, {.295, .275, .260}, {.340, .325, .310}, {.430, .410, .400}}},
        {{{.260, .245, .230}, {.285, .265, .250}, {.330, .315, .300}, {.420, .400, .390}}},
        {{{.255, .240, .225}, {.275, .260, .245}, {.320, .310, .290}, {.410, .390, .380}}},
        {{{.245, .230, .215}, {.265, .250, .235}, {.310, .300, .280}, {.400, .380, .370}}},
    }},
    {{
        {{{.240, .220, .200}, {.260, .240, .225}, {.310, .295, .280}, {.390, .360, .350}}},
        {{{.230, .210, .190}, {.250, .230, .215}, {.300, .285, .270}, {.380, .355, .340}}},
        {{{.220, .200, .180}, {.240, .220, .205}, {.290, .280, .260}, {.370, .340, .330}}},
        {{{.210, .190, .170}, {.230, .210, .195}, {.280, .270, .250}, {.360, .330, .320}}},
    }},
    {{
        {{{.200, .180, .160}, {.220, .200, .180}, {.270, .250, .235}, {.345, .325, .300}}},
        {{{.190, .170, .155}, {.210, .190, .170}, {.260, .240, .225}, {.330, .310, .290}}},
        {{{.180, .160, .150}, {.200, .180, .165}, {.250, .230, .220}, {.315, .300, .280}}},
        {{{.170, .150, .140}, {.190, .170, .155}, {.240, .220, .210}, {.300, .285, .270}}},
    }},
}};

}  // namespace frana::salm
