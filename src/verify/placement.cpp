#include "verify/placement.h"

#include "particles/generate.h"
#include "verify/trial.h"

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

/// Everywhere on the grid, 1 m deep.
void cover(Scene& scene, Placement placement, int per_side) {
    const auto one = [](double, double) { return 1.0; };
    if (placement == Placement::shifted) return fill(scene, one, {per_side, kShiftX, kShiftY});
    if (placement != Placement::r2) {
        fill(scene, one, {per_side});
        if (placement != Placement::aligned) jitter(scene.particles, placement == Placement::half_jitter ? 0.5 : 1.0);
        return;
    }
    Release everywhere;
    everywhere.depth = 1.0;
    ParticleOptions options;
    options.per_cell = per_side * per_side;
    options.placement = frana::Placement::r2;
    std::vector<ReleaseReport> reports;
    scene.particles = make_seeds({everywhere}, scene.bed, options, reports, scene.log);
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
        case Placement::aligned: return "aligned";
        case Placement::shifted: return "shifted";
        case Placement::r2: return "r2";
        case Placement::half_jitter: return "half";
        case Placement::full_jitter: return "full";
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
