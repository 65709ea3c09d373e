#include "checks/verify/placement.h"

#include <cmath>

#include "checks/verify/trial.h"

namespace frana::verify {
namespace {

constexpr double kShiftX = 0.13, kShiftY = 0.29;  ///< [cells], no simple fraction of the spacing

void jitter(Seeds& seeds, double share) {
    Noise noise;
    for (Index p = 0; p < seeds.count(); ++p) {
        seeds.x[p] += 0.5 * share * seeds.size[p] * noise.next();
        seeds.y[p] += 0.5 * share * seeds.size[p] * noise.next();
    }
}

/// 1 m deep, as many points as the lattice has, at the first places of Roberts' (2018) additive sequence. x and y grow
/// by 1/g and 1/g^2 modulo one, g^3 = g + 1. Equal patches.
void cover_r2(Scene& scene, int per_side) {
    const GridGeometry& grid = scene.bed.geometry;
    const double width = grid.x_max() - grid.x0, height = grid.y_max() - grid.y0, size = grid.cell / per_side;
    const double g = 1.32471795724474602596;
    const Index count = (grid.nx - 1) * (grid.ny - 1) * per_side * per_side;
    const auto fraction = [](double x) { return x - std::floor(x); };
    Seeds& seeds = scene.particles;
    for (Index n = 1; n <= count; ++n) {
        seeds.x.push_back(grid.x0 + width * fraction(0.5 + static_cast<double>(n) / g));
        seeds.y.push_back(grid.y0 + height * fraction(0.5 + static_cast<double>(n) / (g * g)));
        seeds.volume.push_back(size * size);
        seeds.size.push_back(size);
    }
}

/// Everywhere on the grid, 1 m deep.
void cover(Scene& scene, Placement placement, int per_side) {
    if (placement == Placement::r2) return cover_r2(scene, per_side);
    const bool shifted = placement == Placement::shifted;
    fill(scene, [](double, double) { return 1.0; }, {per_side, shifted ? kShiftX : 0.0, shifted ? kShiftY : 0.0});
    if (placement == Placement::half_jitter) jitter(scene.particles, 0.5);
    if (placement == Placement::full_jitter) jitter(scene.particles, 1.0);
}

}  // namespace

double Noise::next() {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    z ^= z >> 31;
    return static_cast<double>(z >> 11) * 0x1p-52 - 1.0;
}

const char* name_of(Placement placement) {
    switch (placement) {
        case Placement::aligned:
            return "aligned";
        case Placement::shifted:
            return "shifted";
        case Placement::r2:
            return "r2";
        case Placement::half_jitter:
            return "half";
        case Placement::full_jitter:
            return "full";
    }
    return "";
}

void place(Scene& scene, const Function& depth, Placement placement, int per_side) {
    cover(scene, placement, per_side);
    const Seeds all = std::move(scene.particles);
    scene.particles = {};
    Seeds& kept = scene.particles;
    for (Index p = 0; p < all.count(); ++p) {
        const double h = depth(all.x[p], all.y[p]);
        if (!(h > 0.0)) continue;
        kept.x.push_back(all.x[p]);
        kept.y.push_back(all.y[p]);
        kept.vx.push_back(0.0);
        kept.vy.push_back(0.0);
        kept.volume.push_back(h * all.volume[p]);
        kept.depth.push_back(h);
        kept.size.push_back(all.size[p]);
    }
}

}  // namespace frana::verify
