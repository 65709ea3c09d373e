#include "checks/verify/exact_similarity.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"

namespace frana::verify {
namespace {

using constants::kDegree;

}  // namespace

SimilarityPile::SimilarityPile(double slope_deg, double friction_deg, double length, double depth)
    : length_(length), depth_(depth), scale_(std::sqrt(length / gravity_)) {
    const double th = slope_deg * kDegree;
    sine_ = std::sin(th);
    brake_ = std::cos(th) * std::tan(friction_deg * kDegree);
    drive_ = sine_ - brake_;
    spread_ = depth / length * std::cos(th);
}

/// g'' = 2 B / (g^2 f), f'' = 2 D / (g f^2) - C f' / ((A - C) t): friction turns with the velocity, linearised.
State<4> SimilarityPile::rate(double time, const State<4>& y) const {
    const auto& [g, g_rate, f, f_rate] = y;
    return {g_rate, 2 * spread_ / (g * g * f), f_rate, 2 * spread_ / (g * f * f) - brake_ * f_rate / (drive_ * time)};
}

SimilarityPile::Shape SimilarityPile::shape(double t, double start) const {
    const double end = t / scale_, s = std::min(start, end), lateral = spread_ * drive_ / sine_;
    State<4> y{1 + spread_ * s * s, 2 * spread_ * s, 1 + lateral * s * s, 2 * lateral * s};
    if (end > s) y = integrate([this](double time, const State<4>& at) { return rate(time, at); }, s, end, y, 2e-4);
    return {y[0], y[1], y[2], y[3], end};
}

SimilarityPile::Place SimilarityPile::at(const Shape& shape, double x, double y) const {
    const auto& [g, g_rate, f, f_rate, time] = shape;
    const double xi = x / length_ - 0.5 * drive_ * time * time, eta = y / length_;
    const double left = 1 - xi * xi / (g * g) - eta * eta / (f * f);
    if (left <= 0.0) return {0.0, 0.0, 0.0};
    const double speed = std::sqrt(gravity_ * length_);
    return {depth_ / (g * f) * left, speed * (drive_ * time + xi * g_rate / g), speed * eta * f_rate / f};
}

std::vector<Residual> SimilarityPile::residuals() {
    const SimilarityPile pile(35, 25, 80, 4);
    double along = 0.0, across = 0.0;
    constexpr double d = 0.01;
    for (const double t : {1.0, 3.0, 5.0, 10.0}) {
        const Shape before = pile.shape((1 - d) * t), now = pile.shape(t), after = pile.shape((1 + d) * t);
        const double step = d * now.time;
        const State<4> rate = pile.rate(now.time, {now.g, now.g_rate, now.f, now.f_rate});
        along = std::max(along, std::abs((after.g - 2 * now.g + before.g) / (step * step) / rate[1] - 1));
        across = std::max(across, std::abs((after.f - 2 * now.f + before.f) / (step * step) / rate[3] - 1));
    }
    double volume = 0.0;
    const Shape now = pile.shape(5.0);
    constexpr double cell = 0.25;  // midpoints of a smooth bump that ends in a kink: (cell / length)^2
    for (double y = -99.875; y < 100; y += cell)
        for (double x = -99.875; x < 140; x += cell) volume += cell * cell * pile.at(now, x, y).depth;
    std::vector<Residual> list = published();
    list.insert(list.end(),
                {{"equation of g'' by differences", along, 1e-4},  // step^2 / 12 of the fourth derivative
                 {"equation of f'' by differences", across, 1e-4},
                 {"volume at 5 s / (pi / 2 H L^2) - 1", volume / (0.5 * constants::kPi * 4 * 80 * 80) - 1, 1e-5}});
    return list;
}

/// The printed series starts at 0.1, which shifts g by 4e-6. From there the figures must agree to the last digit.
std::vector<Residual> SimilarityPile::published() {
    constexpr double start = 0.1;
    const SimilarityPile pile(35, 25, 80, 4);
    const Shape five = pile.shape(5.0, start), ten = pile.shape(10.0, start);
    const double front = pile.centre(5.0) + 80 * five.g;
    return {{"printed g(5 s) 1.1199850465", five.g - 1.1199850465, 1e-10},
            {"printed g'(5 s) .1312414565", five.g_rate - 0.1312414565, 1e-10},
            {"printed f(5 s) 1.0395397482", five.f - 1.0395397482, 1e-10},
            {"printed f'(5 s) .0426557024", five.f_rate - 0.0426557024, 1e-10},
            {"printed g(10 s) 1.430870", ten.g - 1.430870, 6e-7},
            {"printed f(10 s) 1.136939", ten.f - 1.136939, 6e-7},
            {"printed centre at 5 s 23.4948966466 m", pile.centre(5.0) - 23.4948966466, 1e-10},
            {"printed height at 5 s 3.4356322226 m", pile.at(five, pile.centre(5.0), 0.0).depth - 3.4356322226, 1e-10},
            {"printed front at 5 s 113.094 m", front - 113.094, 6e-4},
            {"printed speed of the front at 5 s 13.0746 m/s", pile.at(five, front - 1e-9, 0.0).u - 13.0746, 6e-5}};
}

}  // namespace frana::verify
