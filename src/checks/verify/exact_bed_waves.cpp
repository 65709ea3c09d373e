#include "checks/verify/exact_bed_waves.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace frana::verify {
namespace {

using Complex = std::complex<double>;
constexpr Complex kI{0.0, 1.0};

/// Roots of s^3 + a s^2 + b s + c, by Durand and Kerner.
std::array<Complex, 3> roots_of_cubic(Complex a, Complex b, Complex c) {
    const double size = 1.0 + std::max({std::abs(a), std::sqrt(std::abs(b)), std::cbrt(std::abs(c))});
    std::array<Complex, 3> s{size, size * Complex(0.4, 0.9), size * Complex(0.4, 0.9) * Complex(0.4, 0.9)};
    for (int k = 0; k < 200; ++k)
        for (int n = 0; n < 3; ++n) {
            const Complex x = s[n], others = (x - s[(n + 1) % 3]) * (x - s[(n + 2) % 3]);
            if (std::abs(others) > 0.0) s[n] -= (((x + a) * x + b) * x + c) / others;
        }
    return s;
}

}  // namespace

double ErodingSheet::cosine() const { return 1.0 / std::sqrt(1.0 + gradient * gradient); }
double ErodingSheet::xi() const { return gravity * froude * froude / gradient; }
double ErodingSheet::speed() const { return froude * std::sqrt(gravity * cosine() * thickness); }
double ErodingSheet::stress() const { return density * gravity * thickness * gradient * cosine(); }

double ErodingSheet::taken(double h, double u) const {
    erosion::State state;
    state.thickness = h, state.speed = u;
    state.stress = density * gravity * u * u / xi();
    state.density = state.bed_density = density;
    state.dt = 1e-3, state.normal_gravity = gravity * cosine();
    return std::visit([&](const auto& one) { return one.rate(state); }, law);
}

double ErodingSheet::brake(double h, double u) const {
    return gravity * u * u / (xi() * h) + (1.0 - kappa) * taken(h, u) * u / h;
}

ErodingSheet::Slopes ErodingSheet::slopes() const {
    constexpr double kPart = 1e-4;
    const double h = thickness, u = speed(), dh = kPart * h, du = kPart * u;
    return {(taken(h + dh, u) - taken(h - dh, u)) / (2.0 * dh), (taken(h, u + du) - taken(h, u - du)) / (2.0 * du),
            (brake(h + dh, u) - brake(h - dh, u)) / (2.0 * dh), (brake(h, u + du) - brake(h, u - du)) / (2.0 * du)};
}

// Let a = i k u - E_h, c = i k u + F_u + 2 nu k^2, d = i k h - E_u, e = i k g cos + F_h. The three equations are (s +
// a) h' + d u' = 0, s b' = -(E_h h' + E_u u') and e h' + (s + c) u' + i k g cos b' = 0.
BedWave ErodingSheet::fastest(double k) const {
    const Slopes at = slopes();
    const double u = speed(), gn = gravity * cosine();
    const Complex ik = kI * k, a = ik * u - at.taken_h, c = ik * u + at.brake_u + 2.0 * viscosity * k * k;
    const Complex d = ik * thickness - at.taken_u, e = ik * gn + at.brake_h;
    const Complex by_u = ik * gn * at.taken_u, by_h = ik * gn * at.taken_h;
    const auto roots = roots_of_cubic(a + c, a * c - by_u - d * e, d * by_h - a * by_u);
    BedWave wave;
    wave.rate = *std::max_element(roots.begin(), roots.end(),
                                  [](const Complex& p, const Complex& q) { return p.real() < q.real(); });
    wave.depth = 1.0, wave.speed = -(wave.rate + a) / d;
    wave.bed = -(at.taken_h * wave.depth + at.taken_u * wave.speed) / wave.rate;
    const double size =
        std::max({std::abs(wave.depth) / thickness, std::abs(wave.bed) / thickness, std::abs(wave.speed) / u});
    wave.depth /= size, wave.bed /= size, wave.speed /= size;
    return wave;
}

double ErodingSheet::short_limit(double k) const {
    const Slopes at = slopes();
    const double u = speed(), feedback = u * at.taken_u - thickness * at.taken_h;
    return std::abs(std::sqrt(kI * k * gravity * cosine() * feedback / (2.0 * u)).real());
}

double ErodingSheet::residual(double k, const BedWave& wave) const {
    const Slopes at = slopes();
    const double u = speed(), gn = gravity * cosine();
    const Complex ik = kI * k, s = wave.rate, h = wave.depth, b = wave.bed, v = wave.speed;
    const Complex taken = at.taken_h * h + at.taken_u * v;
    const auto rest = [](std::initializer_list<Complex> terms) {
        Complex sum = 0.0;
        double largest = 0.0;
        for (const Complex& term : terms) sum += term, largest = std::max(largest, std::abs(term));
        return std::abs(sum) / largest;
    };
    return std::max({rest({s * h, ik * u * h, ik * thickness * v, -taken}), rest({s * b, taken}),
                     rest({s * v, ik * u * v, ik * gn * h, ik * gn * b, at.brake_h * h, at.brake_u * v,
                           2.0 * viscosity * k * k * v})});
}

std::vector<Residual> bed_wave_residuals() {
    double worst = 0.0;
    for (const double froude : {0.8, 1.0, 1.2})
        for (const double viscosity : {0.0, 0.3})
            for (const double k : {0.1, 1.0, 10.0}) {
                ErodingSheet sheet;
                sheet.froude = froude, sheet.viscosity = viscosity;
                sheet.law = erosion::Jump{0.98 * sheet.stress()};
                worst = std::max(worst, sheet.residual(k, sheet.fastest(k)));
            }
    ErodingSheet jump, growth, off;
    jump.law = off.law = erosion::Jump{0.98 * jump.stress()};
    growth.law = erosion::Growth{0.1};
    off.froude = 0.8;
    const double k = 1e6, half = 0.5e6;
    const auto rate = [](const ErodingSheet& sheet, double at) { return sheet.fastest(at).growth(); };
    return {
        {"waves satisfy mass, bed and momentum", worst, 1e-10},
        {"jump, Froude number 1: short waves grow as the root of k", rate(jump, k) / jump.short_limit(k) - 1.0, 1e-2},
        {"growth, Froude number 1: not so", (rate(growth, k) - rate(growth, half)) / rate(jump, k), 1e-3},
        {"jump, Froude number 0.8: not so", (rate(off, k) - rate(off, half)) / rate(jump, k), 1e-3}};
}

}  // namespace frana::verify
