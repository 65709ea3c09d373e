#include "checks/verify/exact_bowl.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"

namespace frana::verify {
namespace {

using constants::kGravity;
constexpr double kBowlLength = 4.0, kBowlMiddle = 2.0;
constexpr double kPrinted = 5e-9;  ///< half a unit of the eighth digit after the point, as printed

double square(double x) { return x * x; }

/// Derivative at s by central differences of the fourth order.
template <class F>
double slope(const F& f, double s) {
    constexpr double d = 1e-3;
    return (8 * (f(s + d) - f(s - d)) - (f(s + 2 * d) - f(s - 2 * d))) / (12 * d);
}

/// What is left of the shallow-water equations at one place and time: mass [m/s], momentum in x and y [m/s^2].
struct Left {
    double mass, x, y;
};
Left left_at(const Bowl& bowl, double x, double y, double t) {
    const BowlState w = bowl.at(x, y, t);
    const auto level = [&](double px, double py) { return bowl.at(px, py, t).depth + bowl.bed(px, py); };
    const auto along = [&](double BowlState::*which) {
        return slope([&](double s) { return bowl.at(x, y, s).*which; }, t) +
               w.u * slope([&](double s) { return bowl.at(s, y, t).*which; }, x) +
               w.v * slope([&](double s) { return bowl.at(x, s, t).*which; }, y);
    };
    const double spread =
        slope([&](double s) { return bowl.at(s, y, t).u; }, x) + slope([&](double s) { return bowl.at(x, s, t).v; }, y);
    return {along(&BowlState::depth) + w.depth * spread,
            along(&BowlState::u) + kGravity * slope([&](double s) { return level(s, y); }, x),
            along(&BowlState::v) + kGravity * slope([&](double s) { return level(x, s); }, y)};
}

/// Volume at time t. Each line in x holds a parabola, integrated between its roots from three of its values. The lines
/// are added by midpoints.
double volume_at(const Bowl& bowl, double t) {
    constexpr int lines = 4000;
    double sum = 0.0;
    for (int j = 0; j < lines; ++j) {
        const double y = bowl.width * (j + 0.5) / lines;
        const auto h = [&](double s) { return bowl.at(kBowlMiddle + s, y, t).depth; };
        const double c0 = h(0), c1 = 0.5 * (h(1) - h(-1)), c2 = 0.5 * (h(1) + h(-1)) - c0;
        const double roots = c1 * c1 - 4 * c0 * c2;
        if (roots > 0.0) sum += roots * std::sqrt(roots) / (6 * c2 * c2);
    }
    return sum * bowl.width / lines;
}

/// Energy over density by midpoints of squares; state: depth and velocity at a place.
template <class State>
double energy_of(const Bowl& bowl, const State& state) {
    constexpr int parts = 400;
    const double s = kBowlLength / parts;
    double sum = 0.0;
    for (int j = 0; j < static_cast<int>(std::lround(bowl.width / s)); ++j)
        for (int i = 0; i < parts; ++i) {
            const double x = (i + 0.5) * s, y = (j + 0.5) * s;
            const BowlState w = state(x, y);
            if (w.depth <= 0.0) continue;
            const double kinetic = 0.5 * (w.u * w.u + w.v * w.v);
            sum += w.depth * (kinetic + kGravity * (bowl.bed(x, y) + 0.5 * w.depth)) * s * s;
        }
    return sum;
}

}  // namespace

Bowl planar_bowl() {
    constexpr double a = 1.0, h0 = 0.1, eta = 0.5;  // radius, depth, distance of the water's centre from the middle [m]
    const double omega = std::sqrt(2 * kGravity * h0) / a;
    Bowl bowl;
    bowl.period = 2 * constants::kPi / omega;
    bowl.volume = 0.5 * constants::kPi * h0 * a * a;
    bowl.swing = 2 * bowl.volume * kGravity * h0 * eta * eta / (a * a);  // as much lift as motion
    bowl.bed = [](double x, double y) {
        return -h0 * (1 - (square(x - kBowlMiddle) + square(y - kBowlMiddle)) / (a * a));
    };
    bowl.rest = [](double x, double y) {
        return h0 * (1 - (square(x - kBowlMiddle) + square(y - kBowlMiddle)) / (a * a));
    };
    bowl.at = [omega, bed = bowl.bed](double x, double y, double t) {
        const double c = std::cos(omega * t), s = std::sin(omega * t);
        const double surface = eta * h0 / (a * a) * (2 * (x - kBowlMiddle) * c + 2 * (y - kBowlMiddle) * s - eta);
        return BowlState{surface - bed(x, y), -eta * omega * s, eta * omega * c};
    };
    bowl.centre_x = [omega](double t) { return kBowlMiddle + eta * std::cos(omega * t); };
    bowl.published = {{"turning rate, printed 1.40071410", omega - 1.40071410, kPrinted},
                      {"three periods, printed 13.45710440", 3 * bowl.period - 13.45710440, kPrinted},
                      {"speed, printed 0.700357", eta * omega - 0.700357, 5e-7}};
    return bowl;
}

Bowl radial_bowl() {
    constexpr double a = 1.0, h0 = 0.1, r0 = 0.8;  // radius and depth at rest, smallest radius [m]
    constexpr double A = (a * a - r0 * r0) / (a * a + r0 * r0), steepness = h0 / (a * a);
    const double omega = std::sqrt(8 * kGravity * h0) / a;
    /// Energy over density of the paraboloid D - k r^2 in the bowl.
    const auto energy = [](double D, double k) {
        return kGravity * constants::kPi / k * (D * D * D / 6 * (1 + steepness / k) - 0.5 * h0 * D * D);
    };
    Bowl bowl;
    bowl.round = true;
    bowl.period = 2 * constants::kPi / omega;
    bowl.volume = 0.5 * constants::kPi * h0 * a * a;
    bowl.swing = energy(h0 * std::sqrt((1 + A) / (1 - A)), steepness * (1 + A) / (1 - A)) - energy(h0, steepness);
    bowl.bed = [](double x, double y) { return -h0 + steepness * (square(x - kBowlMiddle) + square(y - kBowlMiddle)); };
    bowl.rest = [](double x, double y) { return h0 - steepness * (square(x - kBowlMiddle) + square(y - kBowlMiddle)); };
    bowl.at = [omega, bed = bowl.bed](double x, double y, double t) {
        const double dx = x - kBowlMiddle, dy = y - kBowlMiddle, c = 1 - A * std::cos(omega * t);
        const double r2 = (dx * dx + dy * dy) / (a * a);
        const double surface = h0 * (std::sqrt(1 - A * A) / c - 1 - r2 * ((1 - A * A) / (c * c) - 1));
        const double rate = 0.5 * omega * A * std::sin(omega * t) / c;
        return BowlState{surface - bed(x, y), rate * dx, rate * dy};
    };
    bowl.centre_x = [](double) { return kBowlMiddle; };
    bowl.published = {
        {"A, printed 0.21951220", A - 0.21951220, kPrinted},
        {"rate, printed 2.80142821", omega - 2.80142821, kPrinted},
        {"three periods, printed 6.72855220", 3 * bowl.period - 6.72855220, kPrinted},
        {"depth in the middle, 0.125 exactly", bowl.at(kBowlMiddle, kBowlMiddle, 0).depth - 0.125, 1e-15}};
    return bowl;
}

Bowl parabolic_trough() {
    constexpr double a = 1.0, h0 = 0.5, reach = 0.5;  // half width and depth at rest, swing of the water's centre [m]
    const double omega = std::sqrt(2 * kGravity * h0) / a;
    Bowl bowl;
    bowl.width = 1.0;
    bowl.period = 2 * constants::kPi / omega;
    bowl.volume = 4.0 / 3.0 * h0 * a * bowl.width;
    bowl.swing = bowl.volume * kGravity * h0 * reach * reach / (a * a);
    bowl.bed = [](double x, double) { return h0 * (square((x - kBowlMiddle) / a) - 1); };
    bowl.rest = [](double x, double) { return h0 * (1 - square((x - kBowlMiddle) / a)); };
    bowl.at = [omega](double x, double, double t) {
        const double from_centre = (x - kBowlMiddle + reach * std::cos(omega * t)) / a;
        return BowlState{h0 * (1 - square(from_centre)), reach * omega * std::sin(omega * t), 0.0};
    };
    bowl.centre_x = [omega](double t) { return kBowlMiddle - reach * std::cos(omega * t); };
    bowl.published = {{"largest speed, printed 1.56604598", reach * omega - 1.56604598, kPrinted},
                      {"five periods, printed 10.03033340", 5 * bowl.period - 10.03033340, kPrinted}};
    return bowl;
}

std::vector<Residual> residuals_of(const Bowl& bowl) {
    Left worst{0, 0, 0};
    double volume = 0.0, energy = 0.0;
    const double at_rest = energy_of(bowl, [&](double x, double y) { return BowlState{bowl.rest(x, y), 0, 0}; });
    for (const double phase : {0.0, 0.13, 0.41, 0.77}) {
        const double t = phase * bowl.period;
        for (const auto& [x, y] : {std::pair{2.0, 2.0}, std::pair{1.7, 2.4}, std::pair{2.3, 1.9}}) {
            const Left left = left_at(bowl, x, y, t);
            worst = {std::max(worst.mass, std::abs(left.mass)), std::max(worst.x, std::abs(left.x)),
                     std::max(worst.y, std::abs(left.y))};
        }
        volume = std::max(volume, std::abs(volume_at(bowl, t) / bowl.volume - 1));
        const double now = energy_of(bowl, [&](double x, double y) { return bowl.at(x, y, t); });
        energy = std::max(energy, std::abs((now - at_rest) / bowl.swing - 1));
    }
    // Differences over 1e-3: 1e-12 times fifth derivatives of some 1e2, and 1e-13 of round-off.
    std::vector<Residual> all = {{"equation of mass [m/s]", worst.mass, 1e-10},
                                 {"equation of momentum in x [m/s^2]", worst.x, 1e-10},
                                 {"equation of momentum in y [m/s^2]", worst.y, 1e-10},
                                 {"volume / exact - 1", volume, 1e-7},              // 4000 lines to the power -2.5
                                 {"energy above rest / exact - 1", energy, 1e-3}};  // (4 m / 400)^2 times the edge
    all.insert(all.end(), bowl.published.begin(), bowl.published.end());
    return all;
}

}  // namespace frana::verify
