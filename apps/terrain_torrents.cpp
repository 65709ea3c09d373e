// Made-up torrents: a gully whose bed can be taken up, a fan with houses, two gullies side by side.
#include <algorithm>
#include <array>
#include <cmath>

#include "base/constants.h"
#include "terrain_scenes.h"

namespace frana {
namespace {

constexpr double kCell = 2.5;  // [m]

double squared(double a) { return a * a; }

/// Elevation below that of x = 0 on the nodes along x, down a slope given in the middle between them.
template <class Slope>
std::vector<double> fall_along(double length, const Slope& slope) {
    std::vector<double> drop{0.0};
    for (int k = 0; k * kCell < length; ++k) drop.push_back(drop.back() + kCell * slope((k + 0.5) * kCell));
    return drop;
}

double at(const std::vector<double>& drop, double x) { return drop[static_cast<std::size_t>(std::lround(x / kCell))]; }

/// Depth of a hollow across: round at the bottom, then flanks of a slope [m].
double hollow(double across, double flank, double round) { return std::hypot(flank * across, round) - round; }

std::vector<Vec2> house(const Vec2& centre, double half_x, double half_y, double turn) {
    std::vector<Vec2> ring;
    for (const Vec2& corner : {Vec2(-1, -1), Vec2(1, -1), Vec2(1, 1), Vec2(-1, 1)}) {
        const double x = half_x * corner.x(), y = half_y * corner.y();
        ring.emplace_back(centre.x() + std::cos(turn) * x - std::sin(turn) * y,
                          centre.y() + std::sin(turn) * x + std::cos(turn) * y);
    }
    return ring;
}

}  // namespace

MadeScene loose_gully() {
    const double length = 1500.0, width = 360.0, middle = 180.0, mouth = 950.0;
    const double head_slope = std::tan(30.0 * constants::kDegree), mouth_slope = std::tan(9.0 * constants::kDegree),
                 foot_slope = std::tan(3.0 * constants::kDegree);
    const std::vector<double> drop = fall_along(length, [&](double x) {
        return head_slope + (mouth_slope - head_slope) * smooth_step(x / mouth) +
               (foot_slope - mouth_slope) * smooth_step((x - mouth) / 350.0);
    });
    const auto axis = [&](double x) { return middle + 18.0 * std::sin(x / 110.0) * smooth_step((mouth - x) / 300.0); };
    const auto z = [&](double x, double y) {
        const double share = smooth_step((mouth + 100.0 - x) / 250.0);
        return 600.0 - at(drop, x) + share * hollow(y - axis(x), 0.55, 4.0) -
               (1.0 - share) * 0.03 * std::abs(y - middle);
    };
    // Loose ground in the gully's bed: deepest in its middle, none near the scar and below the mouth.
    const auto loose = [&](double x, double y) {
        const double along = smooth_step((x - 160.0) / 60.0) * smooth_step((mouth - x) / 60.0);
        return 1.6 * along * std::max(0.0, 1.0 - squared((y - axis(x)) / 12.0));
    };
    std::vector<Vec2> scar;
    for (int k = 0; k < 48; ++k) {
        const double angle = 2.0 * 180.0 * constants::kDegree * k / 48;
        scar.emplace_back(75.0 + 28.0 * std::cos(angle), axis(75.0) + 9.0 * std::sin(angle));
    }
    return {{{"dem.tif", on_nodes(length, width, kCell, z)}, {"loose.tif", on_nodes(length, width, kCell, loose)}},
            {{"release.geojson", scar}}};
}

MadeScene fan() {
    const double length = 800.0, width = 600.0, middle = 300.0, apex = 200.0;
    const double gully_slope = std::tan(14.0 * constants::kDegree), fan_slope = std::tan(8.0 * constants::kDegree),
                 foot_slope = std::tan(4.0 * constants::kDegree);
    // Down the gully along x, then away from the apex in all directions, ever gentler.
    const auto fall = [&](double r) {
        const double end = 600.0, gentle = (fan_slope - foot_slope) / end;
        return r < 0.0 ? gully_slope * r
                       : fan_slope * r - 0.5 * gentle * squared(std::min(r, end)) -
                             (r > end ? (fan_slope - foot_slope) * (r - end) : 0.0);
    };
    const auto z = [&](double x, double y) {
        const double across = y - middle, from_apex = std::hypot(x - apex + 60.0, across) - 60.0;
        const double share = smooth_step((apex + 60.0 - x) / 160.0);
        const double in_gully = 500.0 - fall(x - apex) + hollow(across, 0.6, 5.0);
        return share * in_gully + (1.0 - share) * (500.0 - fall(from_apex));
    };
    const std::vector<Vec2> cone = {{230.0, 240.0}, {420.0, 20.0},  {780.0, 20.0},
                                    {780.0, 580.0}, {420.0, 580.0}, {230.0, 360.0}};
    MadeOutline houses{"houses.geojson", house({330.0, 262.0}, 9.0, 6.0, 0.3), {}};
    for (const auto& [x, y, turn] : {std::array{345.0, 335.0, -0.2},
                                     {390.0, 295.0, 0.1},
                                     {430.0, 225.0, 0.5},
                                     {440.0, 372.0, -0.4},
                                     {480.0, 315.0, 0.0},
                                     {520.0, 260.0, 0.2},
                                     {535.0, 400.0, -0.3},
                                     {590.0, 330.0, 0.1}})
        houses.others.push_back(house({x, y}, 9.0, 6.0, turn));
    return {{{"dem.tif", on_nodes(length, width, kCell, z)}}, {{"cone.geojson", cone, {}}, houses}};
}

MadeScene two_gullies() {
    const double length = 1400.0, width = 620.0, cell = 10.0, mouth = 800.0, bend = 350.0;
    const double head_slope = std::tan(32.0 * constants::kDegree), foot_slope = std::tan(3.0 * constants::kDegree);
    const auto first = [](double x) { return 200.0 + 20.0 * std::sin(x / 90.0); };
    const auto second = [](double x) { return 430.0 - 15.0 * std::sin(x / 120.0); };
    const auto z = [&](double x, double y) {
        const double fall = foot_slope * x + (head_slope - foot_slope) * bend * (1.0 - std::exp(-x / bend));
        const auto gully = [&](double axis) {
            return 7.0 * smooth_step((mouth - x) / 300.0) * std::exp(-squared((y - axis) / 45.0));
        };
        const double rough = 0.8 * std::sin(x / 17.0 + 0.7) * std::sin(y / 23.0) + 0.5 * std::sin(x / 11.0 + y / 19.0) +
                             0.4 * std::cos(x / 29.0 - y / 13.0);
        return 420.0 - fall - gully(first(x)) - gully(second(x)) + rough;
    };
    const auto scar = [](const Vec2& middle, double along, double across) {
        std::vector<Vec2> ring;
        for (int k = 0; k < 32; ++k) {
            const double angle = 2.0 * 180.0 * constants::kDegree * k / 32;
            ring.emplace_back(middle.x() + along * std::cos(angle), middle.y() + across * std::sin(angle));
        }
        return ring;
    };
    return {{{"dem.tif", on_nodes(length, width, cell, z)}},
            {{"first.geojson", scar({120.0, first(120.0)}, 45.0, 30.0)},
             {"second.geojson", scar({130.0, second(130.0)}, 40.0, 28.0)},
             {"next.geojson", scar({140.0, first(140.0)}, 60.0, 40.0)}}};
}

}  // namespace frana
