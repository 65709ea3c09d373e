#include "checks/verify/lakes.h"

#include <cmath>

namespace frana::verify {
namespace {

double bell(double x, double y) { return std::exp(-0.4 * ((x - 5) * (x - 5) + (y - 5) * (y - 5))); }

}  // namespace

Lake lake_z1() {
    return {[](double x, double y) { return 5 * bell(x, y); }, 10.0, 10.0};
}

Lake lake_z2() {
    return {[](double x, double y) { return x >= 4 && x <= 8 && y >= 4 && y <= 8 ? 4.0 : 0.0; }, 10.0, 10.0};
}

Lake lake_island() {
    return {[](double x, double y) { return 12 * bell(x, y); }, 10.0, 10.0};
}

Lake lake_bump() {
    const auto bump = [](double x, double) { return x > 8 && x < 12 ? 0.2 - 0.05 * (x - 10) * (x - 10) : 0.0; };
    return {bump, 0.1, 25.0, true};
}

Scene scene_of(const Lake& lake, const Setup& setup, Placement placement) {
    const double cell = lake.length / static_cast<double>(setup.cells);
    Scene scene = scene_on(setup.cells + 1, lake.strip ? 7 : setup.cells + 1, cell, lake.bed);
    scene.sides = Sides::wall;
    scene.still_surface = lake.level;
    if (setup.preset == "paper") scene.scheme.still_level = lake.level;
    place(
        scene, [&](double x, double y) { return lake.level - lake.bed(x, y); }, placement, setup.per_side);
    return scene;
}

}  // namespace frana::verify
