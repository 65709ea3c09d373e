#include "base/colour.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace frana {
namespace {

/// Control points at equal distances, interpolated linearly in sRGB.
template <std::size_t N>
Colour along(const std::array<Colour, N>& points, double t) {
    const double place = t * static_cast<double>(N - 1);
    const auto i = std::min(static_cast<std::size_t>(place), N - 2);
    return mixed(points[i], points[i + 1], place - static_cast<double>(i));
}

constexpr std::array<Colour, 20> viridis{
    {{68, 1, 84},    {72, 21, 103},  {72, 38, 119},  {69, 55, 129},  {64, 71, 136},  {57, 86, 140},  {51, 99, 141},
     {45, 112, 142}, {40, 125, 142}, {35, 138, 141}, {31, 150, 139}, {32, 163, 135}, {41, 175, 127}, {60, 187, 117},
     {85, 198, 103}, {115, 208, 85}, {149, 216, 64}, {184, 222, 41}, {220, 227, 25}, {253, 231, 37}}};

constexpr std::array<Colour, 10> plasma{{{13, 8, 135},
                                         {70, 3, 159},
                                         {114, 1, 168},
                                         {156, 23, 158},
                                         {189, 55, 134},
                                         {216, 87, 107},
                                         {237, 121, 83},
                                         {251, 159, 58},
                                         {253, 202, 38},
                                         {240, 249, 33}}};

constexpr std::array<Colour, 9> greens{{{247, 252, 245},
                                        {229, 245, 224},
                                        {199, 233, 192},
                                        {161, 217, 155},
                                        {116, 196, 118},
                                        {65, 171, 93},
                                        {35, 139, 69},
                                        {0, 109, 44},
                                        {0, 68, 27}}};

constexpr std::array<Colour, 9> cool_to_warm{{{59, 76, 192},
                                              {98, 130, 234},
                                              {141, 176, 254},
                                              {184, 208, 249},
                                              {221, 221, 221},
                                              {245, 196, 173},
                                              {244, 154, 123},
                                              {222, 96, 77},
                                              {180, 4, 38}}};

constexpr std::array<Colour, 6> curves{
    {{0, 114, 178}, {213, 94, 0}, {0, 158, 115}, {204, 121, 167}, {0, 0, 0}, {86, 180, 233}}};

}  // namespace

Colour colour_at(Colormap map, double t) {
    const double place = t > 0.0 ? std::min(t, 1.0) : 0.0;
    switch (map) {
        case Colormap::depth:
            return along(viridis, 1.0 - place);
        case Colormap::speed:
            return along(plasma, place);
        case Colormap::pressure:
            return along(greens, place);
        case Colormap::diverging:
            break;
    }
    return along(cool_to_warm, place);
}

double brightness(const Colour& colour) { return (0.2126 * colour.r + 0.7152 * colour.g + 0.0722 * colour.b) / 255.0; }

Colour curve_colour(std::size_t i) { return curves[i % curves.size()]; }

}  // namespace frana
