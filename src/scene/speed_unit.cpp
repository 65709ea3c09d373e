#include "scene/speed_unit.h"

#include <algorithm>
#include <cctype>

namespace frana {
namespace {

struct SpeedUnit {
    const char* name;  ///< in small letters, without blanks
    double metres_per_second;
};

constexpr double kHour = 3600.0, kFoot = 0.3048, kMile = 1609.344, kNauticalMile = 1852.0;

constexpr SpeedUnit kUnits[] = {
    {"", 1.0},
    {"m/s", 1.0},
    {"m/sec", 1.0},
    {"ms-1", 1.0},
    {"ms^-1", 1.0},
    {"m.s-1", 1.0},
    {"mps", 1.0},
    {"metre/second", 1.0},
    {"meter/second", 1.0},
    {"metrespersecond", 1.0},
    {"meterspersecond", 1.0},
    {"cm/s", 0.01},
    {"cms-1", 0.01},
    {"mm/s", 0.001},
    {"km/h", 1000.0 / kHour},
    {"km/hr", 1000.0 / kHour},
    {"kmh", 1000.0 / kHour},
    {"kmh-1", 1000.0 / kHour},
    {"kph", 1000.0 / kHour},
    {"ft/s", kFoot},
    {"fps", kFoot},
    {"mph", kMile / kHour},
    {"mi/h", kMile / kHour},
    {"kn", kNauticalMile / kHour},
    {"kt", kNauticalMile / kHour},
    {"knot", kNauticalMile / kHour},
    {"knots", kNauticalMile / kHour},
};

}  // namespace

std::optional<double> metres_per_second(const std::string& unit) {
    std::string name;
    for (const char letter : unit)
        if (std::isspace(static_cast<unsigned char>(letter)) == 0)
            name += static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    const auto* const found =
        std::find_if(std::begin(kUnits), std::end(kUnits), [&](const SpeedUnit& known) { return name == known.name; });
    if (found == std::end(kUnits)) return {};
    return found->metres_per_second;
}

}  // namespace frana
