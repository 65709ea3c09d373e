// Made-up ground with the figures of Fois, de Falco, Formaggia (2025), section 4.4.2. The elevation model of
// the paper, a hill near Lecco, is not public. What it says is used. That is 750 x 1000 m on 151 x 201 nodes, natural
// slopes of 60 to 68 degrees. The release is 0.02 Z within an ellipse, 5.8e3 m3. There is flat ground at the foot of
// the hill, before which the barrier stands. What it does not say is the ground's shape. Here it is a round hill with a
// terrace, on which the mass stands, and cliffs below it. Where the mass goes, the cliffs are cut by a ramp with banks.
// So it takes about half a minute to the barrier and comes with about 20 m/s.
#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "terrain_scenes.h"

namespace frana {
namespace {

constexpr double kWidth = 750.0, kHeight = 1000.0, kCell = 5.0;  // [m]; 151 x 201 nodes
const Vec2 kSummit(600.0, 608.0);
const Vec2 kRelease(420.0, 550.0);           // centre of the ellipse, of the paper
constexpr double kHalfX = 22.3606797749979;  // (x - 420)^2 / 5 + (y - 550)^2 / 4 <= 100 [m]
constexpr double kHalfY = 20.0;
constexpr double kShare = 0.02;    // depth over elevation (eq. 13)
constexpr double kVolume = 5.8e3;  // [m^3]

/// Goes from one value to another between two distances.
double passing(double s, double begin, double end, double from, double to) {
    return from + (to - from) * smooth_step((s - begin) / (end - begin));
}

/// Slopes along the radius from the summit, at a distance s from the release's centre towards the foot [1].
double slope_above(double s) { return passing(s, -170.0, -120.0, 0.0, 0.55) * passing(s, -60.0, -30.0, 1.0, 0.0); }
double ramp_slope(double s) {
    const double terrace = passing(s, -60.0, -30.0, 0.0, 0.31), ramp = passing(s, 98.0, 116.0, 0.0, 0.85);
    const double apron = passing(s, 132.0, 150.0, 0.0, -1.04), plain = passing(s, 155.0, 180.0, 0.0, -0.10);
    return slope_above(s) + terrace + ramp + apron + plain;
}
double cliff_slope(double s) {
    const double terrace = passing(s, -60.0, -30.0, 0.0, 0.24), cliff = passing(s, 98.0, 114.0, 0.0, 2.15);
    return slope_above(s) + terrace + cliff + passing(s, 128.0, 144.0, 0.0, -2.37);
}

/// Elevation above that far out, for a slope along the radius.
class Fall {
public:
    template <class Slope>
    explicit Fall(const Slope& slope) {
        for (double s = kEnd; s > kBegin; s -= kStep) z_.push_back(z_.back() + kStep * slope(s - 0.5 * kStep));
    }
    double at(double s) const {
        const double place = std::clamp((kEnd - s) / kStep, 0.0, static_cast<double>(z_.size()) - 2.0);
        const auto k = static_cast<std::size_t>(place);
        return z_[k] + (place - static_cast<double>(k)) * (z_[k + 1] - z_[k]);
    }

private:
    static constexpr double kBegin = -200.0, kEnd = 700.0, kStep = 0.5;  // [m]
    std::vector<double> z_{0.0};
};

/// The hill, but for a constant.
class Hill {
public:
    double at(double x, double y) const {
        const Vec2 out = Vec2(x, y) - kSummit, way = (kRelease - kSummit).normalized();
        const double s = out.norm() - (kRelease - kSummit).norm();
        const double across = out.dot(way) > 0.0 ? out.x() * way.y() - out.y() * way.x() : 1e3;
        const double flank = smooth_step((std::abs(across) - 28.0) / 40.0);  // 0 on the ramp, 1 on the cliffs
        const double spurs = 4.0 * std::sin(std::atan2(out.y(), out.x()) * 23.0) * smooth_step((s - 30.0) / 60.0) *
                             smooth_step((190.0 - s) / 60.0);
        const double swells = std::sin(x / 23.0) * std::sin(y / 31.0 + 0.7);
        const double hollow = 1.5 * std::min(1.0, across * across / (28.0 * 28.0)) * smooth_step((170.0 - s) / 40.0);
        return (1.0 - flank) * ramp_.at(s) + flank * (cliff_.at(s) + spurs + swells) + hollow;
    }

private:
    Fall ramp_{ramp_slope}, cliff_{cliff_slope};
};

std::vector<Vec2> release_outline() {
    std::vector<Vec2> ring;
    const int corners = 360;  // the polygon has 0.9999492 of the ellipse's area
    for (int k = 0; k < corners; ++k) {
        const double angle = 360.0 * constants::kDegree * k / corners;
        ring.emplace_back(kRelease.x() + kHalfX * std::cos(angle), kRelease.y() + kHalfY * std::sin(angle));
    }
    return ring;
}

/// What has to be added to an elevation so that 0.02 of it over the ellipse is the volume. Midpoint rule.
template <class Elevation>
double level_for_volume(const Elevation& z) {
    const int n = 400;
    double sum = 0.0, count = 0.0;
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const double u = (2.0 * i + 1.0) / n - 1.0, v = (2.0 * j + 1.0) / n - 1.0;
            if (u * u + v * v > 1.0) continue;
            sum += z(kRelease.x() + u * kHalfX, kRelease.y() + v * kHalfY), count += 1.0;
        }
    const double area = 180.0 * constants::kDegree * kHalfX * kHalfY;
    return kVolume / (kShare * area) - sum / count;
}

}  // namespace

MadeScene barrier_hill() {
    const Hill hill;
    const auto shape = [&](double x, double y) { return hill.at(x, y); };
    const double level = level_for_volume(shape);
    Raster dem = on_nodes(kWidth, kHeight, kCell, [&](double x, double y) { return level + hill.at(x, y); });
    Raster depth = dem;
    for (double& h : depth.values) h *= kShare;
    return {{{"dem.tif", std::move(dem)}, {"depth.tif", std::move(depth)}}, {{"release.geojson", release_outline()}}};
}

}  // namespace frana
