#include "checks/verify/exact_slope_flow.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "checks/verify/ode.h"

namespace frana::verify {
namespace {

using constants::kDegree;

/// Mass and momentum equation of (h, u)(x, t) by central differences of fourth order: what is left, and the terms.
struct Balance {
    double mass, momentum, mass_terms, momentum_terms;
};

template <class Wave>
Balance balance(const Wave& wave, double x, double t, double step) {
    const auto derivative = [step](const auto& f) {
        return (8.0 * (f(step) - f(-step)) - (f(2 * step) - f(-2 * step))) / (12.0 * step);
    };
    const auto flux = [](const WaveState& w) { return w.depth * w.velocity; };
    const double h_t = derivative([&](double d) { return wave.at(x, t + d).depth; });
    const double u_t = derivative([&](double d) { return wave.at(x, t + d).velocity; });
    const double q_x = derivative([&](double d) { return flux(wave.at(x + d, t)); });
    const double u_x = derivative([&](double d) { return wave.at(x + d, t).velocity; });
    const double h_x = derivative([&](double d) { return wave.at(x + d, t).depth; });
    const double carried = wave.at(x, t).velocity * u_x, pressure_gradient = wave.gravity * h_x;
    return {h_t + q_x, u_t + carried + pressure_gradient - wave.drive, std::abs(h_t) + std::abs(q_x),
            std::abs(u_t) + std::abs(carried) + std::abs(pressure_gradient)};
}

/// The worst balance over places inside a moving flow, relative to the largest terms.
template <class Wave>
std::vector<Residual> balances(const Wave& wave, double from, double to, double t) {
    Balance worst{0.0, 0.0, 0.0, 0.0};
    for (int k = 1; k < 10; ++k) {
        const Balance here = balance(wave, from + (to - from) * k / 10.0, t, 1e-3 * t);
        worst.mass = std::max(worst.mass, std::abs(here.mass));
        worst.momentum = std::max(worst.momentum, std::abs(here.momentum));
        worst.mass_terms = std::max(worst.mass_terms, here.mass_terms);
        worst.momentum_terms = std::max(worst.momentum_terms, here.momentum_terms);
    }
    // Differences over a thousandth of the time: truncation 1e-12 and round-off 1e-13, each times what the fields vary.
    return {{"mass equation by differences", worst.mass / worst.mass_terms, 1e-10},
            {"momentum equation by differences", worst.momentum / worst.momentum_terms, 1e-10}};
}

}  // namespace

WaveState SlopeDam::at(double x, double t) const {
    const WaveState wave = Ritter{depth, gravity}.at((x - 0.5 * drive * t * t) / t);
    if (wave.depth <= 0.0) return {0.0, 0.0};
    return {wave.depth, wave.velocity + drive * t};
}

double SlopeDam::front(double t) const { return 2.0 * std::sqrt(gravity * depth) * t + 0.5 * drive * t * t; }
double SlopeDam::rear(double t) const { return -std::sqrt(gravity * depth) * t + 0.5 * drive * t * t; }

SlopeDam SlopeDam::avaframe() {
    const double g_normal = 9.81 * std::cos(22 * kDegree);
    return {1.0, g_normal, g_normal * (std::tan(22 * kDegree) - std::tan(21 * kDegree))};
}

std::vector<Residual> SlopeDam::residuals() const {
    constexpr double t = 5.0;
    std::vector<Residual> list = balances(*this, rear(t), front(t), t);
    double volume = 0.0;
    constexpr int parts = 20000;
    const double width = (front(t) - rear(t)) / parts;
    for (int k = 0; k < parts; ++k) volume += width * at(rear(t) + (k + 0.5) * width, t).depth;
    const double fallen = depth * (0.5 * drive * t * t - rear(t));  // what was behind the fan's rear, had it all slid
    list.push_back({"volume of the fan / (h c t) - 1", volume / fallen - 1, 1e-8});
    return list;
}

std::vector<Residual> SlopeDam::published() {
    const SlopeDam dam = avaframe();
    struct Row {
        double t, front, rear, h, u;
    };
    double worst = 0.0;
    for (const Row& row : {Row{1, 6.1235, -2.9242, 0.458060, 2.132861}, Row{2, 12.4304, -5.6650, 0.471881, 2.255121},
                           Row{5, 32.4514, -12.7872, 0.514576, 2.621898}}) {
        const WaveState w = dam.at(0.0, row.t);
        worst = std::max({worst, std::abs(dam.front(row.t) - row.front), std::abs(dam.rear(row.t) - row.rear),
                          std::abs(w.depth - row.h), std::abs(w.velocity - row.u)});
    }
    return {{"table of the 22/21 degree dam (front, rear, h and u at the dam, 1, 2, 5 s)", worst, 5.1e-5}};
}

double SlidingCap::stretch(double t) const {
    const double target = std::sqrt(4.0 * gravity * depth) * t / half_width;
    const auto clock = [](double l) { return std::sqrt(l * (l - 1)) + std::log(std::sqrt(l) + std::sqrt(l - 1)); };
    return bisect(1.0, 2.0 + target, [&](double l) { return clock(l) < target; });  // as the clock exceeds l - 1
}

WaveState SlidingCap::at(double x, double t, double stretch_then) const {
    const double l = stretch_then, from_centre = x - 0.5 * drive * t * t, s = from_centre / (half_width * l);
    if (s * s >= 1.0) return {0.0, 0.0};
    const double rate = std::sqrt(4.0 * gravity * depth * (1.0 - 1.0 / l)) / half_width;  // l'
    return {depth / l * (1.0 - s * s), drive * t + rate / l * from_centre};
}

std::vector<Residual> SlidingCap::residuals() const {
    constexpr double t = 10.0;
    const double reach = half_width * stretch(t), middle = 0.5 * drive * t * t;
    std::vector<Residual> list = balances(*this, middle - reach, middle + reach, t);
    const double d = 1e-2, l = stretch(t), curve = (stretch(t + d) - 2 * l + stretch(t - d)) / (d * d);
    const double exact = 2.0 * gravity * depth / (half_width * half_width * l * l);
    list.push_back({"l'' by differences / (2 g hc / (w l)^2) - 1", curve / exact - 1, 1e-5});  // step^2, here 1e-4 / 10
    // The printed stretches: 80 m, 4 m normal depth, 35 degrees.
    const SlidingCap pile{4.0, 80.0, 9.81 * std::cos(35 * kDegree), 0.0};
    double worst = 0.0;
    for (const auto& [time, value] :
         {std::pair{1.0, 1.00501405}, {2.0, 1.01995712}, {5.0, 1.12073859}, {10.0, 1.43946341}})
        worst = std::max(worst, std::abs(pile.stretch(time) - value));
    list.push_back({"printed stretch at 1, 2, 5, 10 s", worst, 5.1e-9});
    return list;
}

}  // namespace frana::verify
