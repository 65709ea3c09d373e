#include "checks/verify/slide.h"

#include <algorithm>
#include <cmath>

namespace frana::verify {

double Slide::along(double x, double y) const { return std::cos(turn) * x + std::sin(turn) * y; }
double Slide::across(double x, double y) const { return std::cos(turn) * y - std::sin(turn) * x; }

Scene Slide::scene(const Function& z) const {
    const double c = std::cos(turn), s = std::sin(turn), margin = (radius + 8.0) * cell;
    const auto node = [this](double at) { return std::floor(at / cell) * cell; };
    const auto count = [this](double low, double high) {
        return static_cast<Index>(std::ceil((high - low) / cell)) + 1;
    };
    const double x0 = node(std::min(c * start, c * reach) - margin);
    const double y0 = node(std::min(s * start, s * reach) - margin);
    const double x1 = std::max(c * start, c * reach) + margin, y1 = std::max(s * start, s * reach) + margin;
    Scene scene = scene_on(
        count(x0, x1), count(y0, y1), cell, [&](double x, double y) { return z(along(x, y), across(x, y)); }, x0, y0);
    fill(scene,
         [&](double x, double y) {
             return std::hypot(x - c * start, y - s * start) < radius * cell ? depth * cell : 0.0;
         },
         {per_side});
    return scene;
}

BlobState blob_state(Trial& trial, const Slide& slide, const Function& z) {
    const Frame frame = trial.simulation().frame();
    const double *place = frame.particle("position")->data, *speed = frame.particle("speed")->data;
    const double* mass = frame.particle("mass")->data;
    BlobState sum{0.0, 0.0, 0.0, 0.0};
    double total = 0.0;
    for (Index p = 0; p < frame.particle("mass")->count; ++p) {
        const double s = slide.along(place[3 * p], place[3 * p + 1]), n = slide.across(place[3 * p], place[3 * p + 1]);
        const double height = z(s, n);
        sum.along += mass[p] * s;
        sum.across += mass[p] * n;
        sum.height += mass[p] * height;
        sum.energy += mass[p] * (0.5 * speed[p] * speed[p] + trial.scene().gravity * height);
        total += mass[p];
    }
    return {sum.along / total, sum.across / total, sum.height / total, sum.energy / total};
}

}  // namespace frana::verify
