// Waves on a flow that takes up its bed, near a Froude number of 1. Linear theory, and what the grid makes of it.
#include <algorithm>
#include <cmath>
#include <random>

#include "base/constants.h"
#include "checks/verify/exact_bed_waves.h"
#include "checks/verify/library.h"
#include "checks/verify/trial.h"

namespace frana::verify {
namespace {

constexpr double kWavelength = 8.0;    ///< on the map, eight times the depth [m]
constexpr double kWavesEnd = 3.0;      ///< [s]
constexpr double kWavesBehind = 14.0;  ///< room for the rear end, which spreads [m]
constexpr double kWavesFrom = 32.0;  ///< begin of the window, ahead of what comes in from the rear end of the slab [m]
constexpr int kWaves = 3;            ///< in the window
constexpr double kWavesLength = kWavesFrom + kWaves * kWavelength + 14.0;  ///< of the slab on the map [m]
constexpr double kSmall = 3e-5;                                            ///< height of the wave over the depth [1]
constexpr double kRough = 3e-6;  ///< of the nodes' bed next to it, over the depth [1]
constexpr double kSpare = 2e-3;  ///< share of the stress above the threshold: small waves never bring it to zero

/// A slab at its normal speed on a strip that falls along x, with the fastest wave of theory. The bed is rough from
/// node to node.
Scene slab(const ErodingSheet& sheet, double cell, int per_side) {
    const double cosine = sheet.cosine(), ahead = 40.0;
    const BedWave wave = sheet.fastest(2.0 * constants::kPi * cosine / kWavelength);
    const auto at = [](std::complex<double> amplitude, double x) {
        return kSmall * (amplitude * std::polar(1.0, 2.0 * constants::kPi * x / kWavelength)).real();
    };
    std::mt19937 random(20261125);  // the same numbers everywhere
    std::vector<double> rough(static_cast<std::size_t>(std::lround((kWavesBehind + kWavesLength + ahead) / cell)) + 1);
    for (double& height : rough)
        height = kRough * sheet.thickness * (static_cast<double>(random()) / 4294967296.0 - 0.5);
    const auto bed = [&](double x, double) {
        const double height = at(wave.bed, x) + rough[static_cast<std::size_t>(std::lround((x + kWavesBehind) / cell))];
        return -sheet.gradient * x + height / cosine;
    };
    const auto depth = [&](double x, double) {
        return x > 0.0 && x < kWavesLength ? (sheet.thickness + at(wave.depth, x)) / cosine : 0.0;
    };
    Scene scene = scene_on(static_cast<Index>(rough.size()), 5, cell, bed, -kWavesBehind);
    scene.sides = Sides::wall;
    scene.curvature = Curvature::none;  // theory has none
    scene.density = sheet.density;
    scene.bed_law = bed::Voellmy{0.0, sheet.xi()};
    if (sheet.viscosity > 0.0) scene.rheology = rheology::Newtonian{sheet.density * sheet.viscosity};
    fill(scene, depth, {per_side});
    Seeds& seeds = scene.particles;
    for (std::size_t p = 0; p < seeds.vx.size(); ++p)
        seeds.vx[p] = cosine * (sheet.speed() + at(wave.speed, seeds.x[p]));
    ErodibleBed loose;
    loose.depth = Raster::filled(scene.bed.geometry, 5.0);
    loose.density = sheet.density, loose.law = sheet.law, loose.momentum = sheet.kappa, loose.min_depth = 0.0;
    scene.erodible = loose;
    return scene;
}

/// The bed's height over the plane in the middle row of the window [m].
std::vector<double> bed_in_window(const Frame& frame, double gradient) {
    const Index first = std::lround((kWavesFrom - frame.grid.x0) / frame.grid.cell),
                count = std::lround(kWaves * kWavelength / frame.grid.cell);
    const double* z = frame.node("elevation")->data + frame.grid.ny / 2 * frame.grid.nx;
    std::vector<double> heights;
    for (Index i = first; i < first + count; ++i) heights.push_back(z[i] + gradient * frame.grid.x(i));
    return heights;
}

/// Amplitude of n waves in the window [m].
double amplitude(const std::vector<double>& heights, Index n) {
    std::complex<double> sum = 0.0;
    const auto count = static_cast<double>(heights.size());
    for (std::size_t i = 0; i < heights.size(); ++i)
        sum += heights[i] *
               std::polar(1.0, -2.0 * constants::kPi * static_cast<double>(n) * static_cast<double>(i) / count);
    return 2.0 * std::abs(sum) / count;
}

/// Of all waves of 2 to 4 cells, of 4 to 8, and so on [m]. They are shorter than a third of that of theory. The window
/// fades at its ends, so that long waves do not leak into short ones.
std::vector<double> amplitudes_by_length(std::vector<double> heights) {
    const auto count = static_cast<Index>(heights.size());
    for (Index i = 0; i < count; ++i)
        heights[i] *=
            0.5 - 0.5 * std::cos(2.0 * constants::kPi * (static_cast<double>(i) + 0.5) / static_cast<double>(count));
    std::vector<double> bands;
    for (Index most = count / 2; most >= 4 * Index{kWaves}; most /= 2) {
        double sum = 0.0;
        for (Index n = most / 2 + 1; n <= most; ++n) sum += std::pow(amplitude(heights, n), 2);
        bands.push_back(std::sqrt(sum));
    }
    return bands;
}

/// Adds the difference of the growth of the wave of eight depths from theory, and the rates of short waves.
void add_waves(const ErodingSheet& sheet, const std::string& name, const Setup& setup, Measurement& m) {
    Trial trial(slab(sheet, kWavelength / static_cast<double>(setup.cells), setup.per_side), setup);
    std::vector<double> wave, time = {0.25 * kWavesEnd, 0.5 * kWavesEnd, kWavesEnd};
    std::vector<std::vector<double>> bands;
    for (const double t : time) {
        trial.run_to(t);
        const std::vector<double> heights = bed_in_window(trial.simulation().frame(), sheet.gradient);
        wave.push_back(amplitude(heights, kWaves)), bands.push_back(amplitudes_by_length(heights));
    }
    const double growth = std::log(wave[2] / wave[0]) / (time[2] - time[0]);
    const double exact = sheet.fastest(2.0 * constants::kPi * sheet.cosine() / kWavelength).growth();
    m.add("growth_" + name, growth, "1/s"), m.add("error_" + name, growth / exact - 1.0);
    for (std::size_t n = 0; n < std::min<std::size_t>(3, bands[1].size()); ++n)
        m.add("cells_" + std::to_string(2 << n) + "_" + name, std::log(bands[2][n] / bands[1][n]) / (time[2] - time[1]),
              "1/s");
    const Measurement one = trial.measure();
    m.particles = one.particles, m.steps += one.steps, m.wall_seconds += one.wall_seconds;
    m.mass_error = one.mass_error;
}

Measurement run_waves(const Setup& setup) {
    Measurement m;
    ErodingSheet sheet;
    const auto add = [&](double froude, const char* name) {
        sheet.froude = froude;
        sheet.law = erosion::Jump{(1.0 - kSpare) * sheet.stress()};
        add_waves(sheet, name, setup, m);
    };
    add(0.8, "08"), add(1.0, "10"), add(1.2, "12");
    sheet.viscosity = 0.1;
    add(1.0, "viscous");
    return m;
}

}  // namespace

std::vector<Problem> bed_wave_problems() {
    Problem waves{"bed_waves",
                  "waves on a uniform flow that takes up its bed, Froude numbers of 0.8, 1 and 1.2",
                  {8, 16, 32, 64},
                  bed_wave_residuals,
                  run_waves};
    waves.order_of = "error_08";
    waves.has_presets = false;
    for (const char* name : {"error_08", "error_10", "error_12", "error_viscous"})
        waves.gates.push_back({64, name, 5e-2, "linear theory, without what is of second order in the slope"});
    for (const char* name : {"cells_2_10", "cells_4_10", "cells_2_viscous", "cells_4_viscous"})
        waves.gates.push_back(
            {64, name, 0.24, "goal: waves of the grid's size grow no faster than one of eight depths"});
    return {waves};
}

}  // namespace frana::verify
