// Waves on a sheet that flows fast: a small wave on a uniform Voellmy flow grows or dies at the rate of linear theory.
#include <cmath>
#include <complex>

#include "base/constants.h"
#include "catch.h"
#include "checks/verify/trial.h"

using namespace frana;
using namespace frana::verify;

namespace {

using constants::kGravity;

constexpr double kWavelength = 10.0;  ///< on the map [m]
constexpr double kSmall = 1e-3;       ///< height of the wave over the depth

/// A uniform flow down a plane of 20 degrees, 1 m deep along the vertical, mu = 0.155.
struct Sheet {
    double xi;  ///< [m/s^2]
    double angle = 20.0 * constants::kPi / 180.0, mu = 0.155, cosine = std::cos(angle), depth = cosine;
    double speed() const { return std::sqrt(xi * depth * (std::sin(angle) - mu * cosine)); }
    double froude() const { return speed() / std::sqrt(kGravity * cosine * depth); }
    double wavenumber() const { return 2.0 * constants::kPi * cosine / kWavelength; }

    /// Rate of the wave that grows fastest [1/s]. With the flow, along the slope: s h' + i k h u' = 0 and
    /// s u' = -i k g cos h' - 2 n u' + n u / h h', n = g u / (xi h). So s^2 + 2 n s + k^2 g cos h + i k n u = 0.
    /// Short waves grow at n (F / 2 - 1), F the Froude number: roll waves from F = 2 on, the shorter the faster.
    std::complex<double> rate() const {
        const double n = kGravity * speed() / (xi * depth), k = wavenumber();
        const std::complex<double> q(k * k * kGravity * cosine * depth, k * n * speed());
        return -n + std::sqrt(n * n - q) * (std::sqrt(n * n - q).real() < 0.0 ? -1.0 : 1.0);
    }
};

/// Height of the wave in a window that goes with the flow [m].
double height(const Frame& frame, double from) {
    const Index cells = std::lround(4.0 * kWavelength / frame.grid.cell), first = std::lround(from / frame.grid.cell);
    const double* depth = frame.node("depth")->data + frame.grid.ny / 2 * frame.grid.nx;
    std::complex<double> sum = 0.0;
    for (Index i = first; i < first + cells; ++i)
        sum += (depth[i] - 1.0) * std::polar(1.0, 2.0 * constants::kPi * frame.grid.x(i) / kWavelength);
    return 2.0 * std::abs(sum) / static_cast<double>(cells);
}

/// The rate at which such a wave grows in a run [1/s].
double measured_rate(const Sheet& sheet, double cell) {
    const double fall = std::tan(sheet.angle);
    Scene scene = scene_on(std::lround(220.0 / cell) + 1, 5, cell, [&](double x, double) { return -fall * x; });
    scene.density = 300.0;
    scene.bed_law = bed::Voellmy{sheet.mu, sheet.xi};
    scene.sides = Sides::wall;
    const auto phase = [](double x) { return 2.0 * constants::kPi * x / kWavelength; };
    verify::fill(scene,
                 [&](double x, double) { return x > 40.0 && x < 160.0 ? 1.0 + kSmall * std::sin(phase(x)) : 0.0; });
    const std::complex<double> s = sheet.rate() / sheet.wavenumber();
    for (std::size_t p = 0; p < scene.particles.vx.size(); ++p) {
        const double at = phase(scene.particles.x[p]), wave = s.real() * std::cos(at) - s.imag() * std::sin(at);
        scene.particles.vx[p] = sheet.cosine * (sheet.speed() + kSmall * wave);
    }
    Trial trial(std::move(scene), Setup{});
    const auto height_at = [&](double time) {
        trial.run_to(time);
        return height(trial.simulation().frame(), 70.0 + sheet.cosine * sheet.speed() * time);
    };
    const double early = height_at(0.5);
    return std::log(height_at(2.0) / early) / 1.5;
}

double order_two(double cell) { return std::pow(2.0 * constants::kPi * cell / kWavelength, 2); }

}  // namespace

// A fast sheet multiplies what disturbs it, whatever the cell: by law, not by the scheme.
// The scheme is of second order: the error is a part of the square of cell times wavenumber.
// Half the cell leaves a quarter of it; a third is asked for.
TEST_CASE("Roll waves grow on a fast Voellmy flow as theory has it", "[verify][roll_waves]") {
    const Sheet sheet{2000.0};
    REQUIRE(sheet.froude() > 6.0);
    const double exact = sheet.rate().real(), coarse = measured_rate(sheet, 0.5), fine = measured_rate(sheet, 0.25);
    CAPTURE(exact, coarse, fine);
    REQUIRE(exact > 0.0);
    CHECK(std::abs(fine - exact) < order_two(0.25) * exact);
    CHECK(std::abs(fine - exact) < std::abs(coarse - exact) / 3.0);
}

TEST_CASE("Below a Froude number of two waves die on a Voellmy flow as theory has it", "[verify][roll_waves]") {
    const Sheet sheet{100.0};
    REQUIRE(sheet.froude() < 2.0);
    const double exact = sheet.rate().real(), fine = measured_rate(sheet, 0.25);
    CAPTURE(exact, fine);
    REQUIRE(exact < 0.0);
    CHECK(std::abs(fine - exact) < order_two(0.25) * std::abs(exact));
}
