#include "terrain_scenes.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"

namespace frana {
namespace {

double squared(double a) { return a * a; }

std::vector<Vec2> rectangle(double x0, double y0, double x1, double y1) {
    return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

std::vector<Vec2> ellipse(const Vec2& centre, double half_x, double half_y) {
    std::vector<Vec2> ring;
    const int corners = 72;
    for (int k = 0; k < corners; ++k) {
        const double angle = 360.0 * constants::kDegree * k / corners;
        ring.emplace_back(centre.x() + half_x * std::cos(angle), centre.y() + half_y * std::sin(angle));
    }
    return ring;
}

}  // namespace

MadeScene lake_z1() {
    const auto z = [](double x, double y) { return 5.0 * std::exp(-0.4 * (squared(x - 5.0) + squared(y - 5.0))); };
    return {{{"z1.tif", on_nodes(10.0, 10.0, 0.2, z)}}, {{"lake.geojson", rectangle(0.0, 0.0, 10.0, 10.0)}}};
}

MadeScene lake_z2() {
    const double rim = 1e-9;  // the nodes at 4 and 8 belong to the plateau, whatever 20 * 0.2 rounds to
    const auto inside = [rim](double a) { return a > 4.0 - rim && a < 8.0 + rim; };
    const auto z = [inside](double x, double y) { return inside(x) && inside(y) ? 4.0 : 0.0; };
    return {{{"z2.tif", on_nodes(10.0, 10.0, 0.2, z)}}, {}};
}

MadeScene obstacle() {
    const auto z = [](double x, double y) {
        return 60.0 - x / 3.0 + 15.0 * std::exp(-(squared(x - 50.0) + squared(y - 10.0)) / 7.0);
    };
    return {{{"dem.tif", on_nodes(150.0, 20.0, 1.0, z)}}, {{"release.geojson", rectangle(5.0, 3.0, 42.5, 17.0)}}};
}

MadeScene wall() {
    const auto z = [](double x, double) { return 10.0 - std::min(x, 10.0) / 3.0; };
    return {{{"dem.tif", on_nodes(25.0, 5.0, 0.5, z)}},
            {{"release.geojson", rectangle(1.5, 0.0, 5.0, 5.0)}, {"wall.geojson", rectangle(20.0, -1.0, 21.0, 6.0)}}};
}

MadeScene conversion() {
    Raster floor = on_nodes(25.0, 25.0, 0.1, [](double, double) { return 0.0; });
    floor.geometry.x0 = floor.geometry.y0 = -10.0;
    const auto depth = [](double x, double y) { return 10.0 - std::sin(2.0 * x) * std::cos(y); };
    return {{{"dem.tif", std::move(floor)}, {"depth.tif", on_nodes(5.0, 5.0, 0.05, depth)}},
            {{"release.geojson", rectangle(0.0, 0.0, 5.0, 5.0)}}};
}

MadeScene column_collapse() {
    const double side = 0.8, middle = 0.5 * side;
    return {{{"dem.tif", on_nodes(side, side, 0.01, [](double, double) { return 0.0; })}},
            {{"cylinder.geojson", ellipse({middle, middle}, 0.1, 0.1)},
             {"slab.geojson", rectangle(middle - 0.05, 0.36, middle + 0.05, 0.44)}}};
}

MadeScene clay_flume() {
    const double cell = 0.0125, steep = std::sin(42.0 * constants::kDegree),
                 gentle = std::sin(5.0 * constants::kDegree);
    const double obstacle = 0.125 + 0.4 * 0.25 - 0.5 * cell;  // nodes along its side are free
    Raster floor = on_nodes(2.2, 0.5, cell, [=](double s, double) {
        const double x = s - 0.4;
        return -(x < 0.0 ? steep : gentle) * x;
    });
    floor.geometry.x0 = -0.4;
    return {{{"dem.tif", std::move(floor)}},
            {{"block.geojson", rectangle(-0.30, 0.125, 0.0, 0.375)},
             {"obstacle.geojson", rectangle(0.0, -0.1, 0.15, obstacle)}}};
}

namespace {

/// Integral of (1 + tanh(x / w)) / 2 from far below.
double risen(double x, double w) { return 0.5 * (x + w * std::log(2.0 * std::cosh(x / w))); }

/// Ground of 700 x 360 m from x = -20, y = -150 on.
template <class Formula>
Raster ground_of_blocks(const Formula& z) {
    const double x0 = -20.0, y0 = -150.0;
    Raster ground = on_nodes(700.0, 360.0, 2.5, [&](double x, double y) { return z(x + x0, y + y0); });
    ground.geometry.x0 = x0, ground.geometry.y0 = y0;
    return ground;
}

}  // namespace

MadeScene blocks() {
    const double turn = 10.0;  // length of the bends [m]
    const auto convex = [=](double x, double) {
        const double first = std::tan(10.0 * constants::kDegree), second = std::tan(30.0 * constants::kDegree);
        return 200.0 - first * x - (second - first) * risen(x - 50.0, turn) + second * risen(x - 250.0, turn);
    };
    const auto valley = [=](double fan) {
        return [=](double x, double y) {
            const double foot = 220.0, share = 0.5 * (1.0 + std::tanh((x - foot) / turn)), across = (y - 30.0) / 20.0;
            const double slope = std::tan(25.0 * constants::kDegree);
            return 150.0 - slope * x + slope * risen(x - foot, turn) + share * fan * 20.0 * std::log(std::cosh(across));
        };
    };
    return {{{"convex.tif", ground_of_blocks(convex)},
             {"fan.tif", ground_of_blocks(valley(-0.2))},
             {"channel.tif", ground_of_blocks(valley(0.1))}},
            {{"block.geojson", rectangle(0.0, 0.0, 100.0, 60.0)}}};
}

MadeScene debris_flow() {
    const double width = 1600.0, height = 500.0, middle = 250.0, cell = 5.0, mouth = 900.0;
    const double head_slope = std::tan(28.0 * constants::kDegree), mouth_slope = std::tan(5.0 * constants::kDegree);
    std::vector<double> drop{0.0};  // below x = 0, on the nodes
    for (int k = 0; k * cell < width; ++k) {
        const double x = (k + 0.5) * cell;
        drop.push_back(drop.back() + cell * (head_slope + (mouth_slope - head_slope) * smooth_step(x / mouth)));
    }
    const auto z = [&](double x, double y) {
        const double across = y - middle,
                     bend = 25.0 * std::sin(x / 140.0) * smooth_step(x / 200.0) * smooth_step((1000.0 - x) / 200.0);
        // Flanks of 27 degrees that round off at the bottom. They are gone 150 m below the mouth, where a cone begins.
        const double flank = std::sqrt(squared(0.5 * (across - bend)) + 9.0) - 3.0;
        const double share = smooth_step((mouth + 150.0 - x) / 300.0), cone = 0.04 * std::abs(across);
        return 400.0 - drop[static_cast<std::size_t>(std::lround(x / cell))] + share * flank - (1.0 - share) * cone;
    };
    return {{{"dem.tif", on_nodes(width, height, cell, z)}},
            {{"release.geojson", ellipse({150.0, middle + 10.0}, 80.0, 18.0)}}};
}

MadeScene tiff_particles() {
    // The ground reaches 5 m beyond the picture, so that the picture's outer half pixels lie on it as well.
    Raster ground = on_nodes(109.0, 109.0, 1.0, [](double, double) { return 0.0; });
    ground.geometry.x0 = ground.geometry.y0 = -4.5;
    Raster depth = on_nodes(99.0, 99.0, 1.0, [](double column, double row) {
        const double x = column + 0.5, y = row + 0.5;
        return 1.0 + 2.0 * std::exp(-(squared(x - 50.0) + squared(y - 50.0)) / 150.0);
    });
    depth.geometry.x0 = depth.geometry.y0 = 0.5;
    return {{{"dem.tif", ground}, {"depth.tif", depth}}, {}};
}

MadeScene avalanche_track() {
    const double width = 2000.0, height = 800.0, middle = 400.0, cell = 5.0;
    const double foot = 1200.0;  // from here the slope fades into flat ground within 150 m
    const double head_slope = std::tan(34.0 * constants::kDegree), foot_slope = std::tan(12.0 * constants::kDegree);
    const auto slope = [=](double x) {
        const double parabola = head_slope + (foot_slope - head_slope) * std::min(x / foot, 1.0);
        return parabola * (1.0 - smooth_step((x - foot) / 150.0));
    };
    std::vector<double> drop{0.0};  // below x = 0, on the nodes
    for (int k = 0; k * cell < width; ++k) drop.push_back(drop.back() + cell * slope((k + 0.5) * cell));
    const auto z = [&](double x, double y) {
        // The channel gathers the snow below the release, is 160 m wide, and opens before the foot.
        const double depth = 14.0 * smooth_step((x - 100.0) / 200.0) * smooth_step((foot + 50.0 - x) / 350.0);
        const double across = std::min(std::abs(y - middle) / 80.0, 1.0);
        const double below = drop[static_cast<std::size_t>(std::lround(x / cell))];
        return 1000.0 + (drop.back() - below) - depth * squared(1.0 - squared(across));
    };
    return {{{"dem.tif", on_nodes(width, height, cell, z)}},
            {{"release.geojson", ellipse({150.0, middle}, 60.0, 65.0)}}};
}

const std::vector<NamedScene>& made_scenes() {
    static const std::vector<NamedScene> scenes = {
        {"lake_z1", "lake at rest over a smooth hill (Fois et al. 2024, 4.1)", lake_z1},
        {"lake_z2", "lake at rest over a step (Fois et al. 2024, 4.1)", lake_z2},
        {"obstacle", "collapse onto an obstacle (Fois et al. 2024, 4.2)", obstacle},
        {"bindo", "mountainside with river, after Fois et al. 2024, 4.3", bindo},
        {"wall", "slope, flat ground and a wall (Fois et al. 2025, 4.4.1)", wall},
        {"barrier_hill", "hill with cliffs and a terrace, after Fois et al. 2025, 4.4.2", barrier_hill},
        {"conversion", "waves of 1 m on 10 m of water (Fois et al. 2025, 4.3)", conversion},
        {"column_collapse", "flat plate with a column of sand", column_collapse},
        {"clay_flume", "flume with an obstacle, unrolled (van den Bout et al. 2021, 3)", clay_flume},
        {"blocks", "slopes and valleys for a block (van den Bout et al. 2021, 4)", blocks},
        {"debris_flow", "gully with a fan before it", debris_flow},
        {"tiff_particles", "picture of 100 x 100 pixels (Fois et al. 2025, 4.1)", tiff_particles},
        {"avalanche_track", "parabolic slope with a channel and a flat run-out", avalanche_track},
        {"loose_gully", "gully with loose ground in its bed, and a fan", loose_gully},
        {"fan", "fan with houses below a gully", fan},
        {"two_gullies", "two gullies side by side on a rough slope, with three scars", two_gullies},
        {"moraine_lake", "valley with a lake behind a moraine that is cut through", moraine_lake}};
    return scenes;
}

}  // namespace frana
