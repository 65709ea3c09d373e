// Mud that slumps under its own weight until its yield stress stops it: a block, and the cylinder of a slump test.
#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "checks/verify/body.h"
#include "checks/verify/library.h"

namespace frana::verify {
namespace {

using constants::kGravity;

/// A block of yield-stress material, 2 m long and 1 m high, on a floor that holds it. It is whole. Half of it against a
/// wall is another problem. Walls have no tension, and what is drawn away from one leaves it.
struct Slump {
    static constexpr double kYield = 1000.0, kDensity = 1000.0, kMiddle = 3.5;
    static constexpr double kFirst = 1.0;       ///< half its length [m]
    static constexpr double kWidthCells = 3.0;  ///< of a slice
    double cell;
    Mpm3d flow;

    Slump(const Setup& setup, double viscosity)
        : cell(1.0 / static_cast<double>(setup.cells)), flow(scene(cell, setup.per_side, viscosity)) {}

    static SolidScene scene(double cell, int per_side, double viscosity) {
        const double width = kWidthCells * cell, sound_speed = 10.0 * std::sqrt(kGravity);
        SolidScene s;
        s.gravity = {0, 0, -kGravity};
        s.grid = grid_around({}, {0, 0, 0}, {2.0 * kMiddle, width, 1.0}, cell);
        s.surfaces = {Surface::plane({0, 0, 0}, {0, 0, 1}, Hold::stuck)};
        add_slice(s, width);
        s.density = kDensity;
        const double bulk = kDensity * sound_speed * sound_speed;
        s.law = solid::Bingham{bulk, 100.0 * kYield, viscosity, kYield};
        for_each_part({kMiddle - kFirst, 0, 0}, {kMiddle + kFirst, width, 1}, cell, per_side,
                      [&](const Vec3& x, double volume) {
                          const double p = kDensity * kGravity * (1.0 - x.z());
                          s.points.add(x, Vec3::Zero(), kDensity * volume / (1.0 - p / bulk), p);
                      });
        return s;
    }
    /// How far from the middle both fronts are, without the outermost 0.2 % of the points [m].
    double front() const {
        std::vector<double> away;
        for (Index p = 0; p < flow.body().points.count(); ++p) away.push_back(std::abs(flow.position(p).x() - kMiddle));
        std::sort(away.begin(), away.end());
        return away[static_cast<std::size_t>(0.998 * static_cast<double>(away.size() - 1))];
    }
    /// Depth at that way from the middle, by the volume within a cell of it on either side [m].
    double depth(double way) const {
        double volume = 0.0;
        for (Index p = 0; p < flow.body().points.count(); ++p)
            if (std::abs(std::abs(flow.position(p).x() - kMiddle) - way) < cell)
                volume += flow.body().points.rest_volume[p] * flow.body().points.j[p];
        return volume / (4.0 * cell * kWidthCells * cell);
    }
    double speed() const { return std::sqrt(2.0 * flow.status().kinetic / flow.status().mass); }
};

/// It stops where the floor's yield stress carries the slope of its surface, h^2 = 2 tau_Y (x_f - x) / (rho g). There
/// x_f = (9 rho g V^2 / (8 tau_Y))^(1/3), V of half of it (Liu and Mei 1989, J. Fluid Mech. 207, 505).
Measurement run_slump(const Setup& setup) {
    Slump slump(setup, 10.0);
    Measurement m = run_body(slump.flow, 3.0);
    const double before = slump.front();
    while (slump.flow.status().time < 4.0) slump.flow.advance(4.0);
    const double front = slump.front();
    const double exact = std::cbrt(9.0 * Slump::kDensity * kGravity / (8.0 * Slump::kYield));
    m.steps = slump.flow.status().step;
    m.add("front", front, "m");
    m.front_error = front - exact;
    m.add("length_error", front / exact - 1.0);
    m.add("creep", front - before, "m");
    m.add("speed", slump.speed(), "m/s");
    m.add("volume_error", slump.flow.status().volume / (2.0 * Slump::kFirst * Slump::kWidthCells * slump.cell) - 1.0);
    return m;
}

/// The same to the next order of the slope. Material that has yielded throughout has less outward pressure, by the
/// integral of twice sqrt(tau_Y^2 - tau^2), tau linear in depth. (h - c) dh/dx = -b with b = tau_Y / (rho g), c = pi b
/// / 2 (as Dubash et al. 2009, J. Non-Newtonian Fluid Mech. 158, 91). From h = 0 at x_0: x = x_0 - (h^2 / 2 - c h) / b,
/// which reaches furthest at h = c.
struct YieldedHeap {
    double b, c = 0.5 * constants::kPi * b, x0 = 0.0;
    double depth(double x) const { return c + std::sqrt(std::max(0.0, c * c + 2.0 * b * (x0 - x))); }
    double front() const { return x0 + 0.5 * c * c / b; }
    double volume() const {  ///< below depth(), up to the front
        const double h = depth(0.0);
        return x0 * h - (h * h * h / 6.0 - c * h * h / 2.0 - c * c * c / 6.0) / b;
    }
    static YieldedHeap of(double yield_length, double volume) {
        YieldedHeap heap{yield_length};
        for (double step = 0.5 * volume / yield_length; step > 1e-12; step *= 0.5) {
            heap.x0 += step;
            if (heap.volume() > volume) heap.x0 -= step;
        }
        return heap;
    }
};

/// It is so viscous that it hardly overshoots. Its shape is that of the theory but for the front, which is no thin
/// layer.
Measurement run_slow_slump(const Setup& setup) {
    constexpr double kShown = 1.5;  // of the surface [m]
    Slump slump(setup, 300.0);
    Measurement m = run_body(slump.flow, 8.0);
    const YieldedHeap exact = YieldedHeap::of(Slump::kYield / (Slump::kDensity * kGravity), Slump::kFirst);
    double sum = 0.0;
    int places = 0;
    for (double way = slump.cell; way < kShown; way += slump.cell, ++places)
        sum += std::abs(slump.depth(way) - exact.depth(way));
    m.front_error = slump.front() - exact.front();
    m.add("length_error", m.front_error / exact.front());
    m.add("surface_error", sum / places, "m");
    m.add("speed", slump.speed(), "m/s");
    return m;
}

/// The heap's slope against its law.
std::vector<Residual> heap_residuals() {
    const YieldedHeap heap = YieldedHeap::of(Slump::kYield / (Slump::kDensity * kGravity), Slump::kFirst);
    double worst = 0.0;
    for (int k = 1; k < 15; ++k) {
        const double x = 0.1 * k, d = 1e-5, slope = (heap.depth(x + d) - heap.depth(x - d)) / (2.0 * d);
        worst = std::max(worst, std::abs((heap.depth(x) - heap.c) * slope / heap.b + 1.0));
    }
    // Over s, x = front - s^2, in which the depth has no kink at the front.
    constexpr int kParts = 10000;
    double volume = 0.0;
    const double end = std::sqrt(heap.front());
    for (int k = 0; k < kParts; ++k) {
        const double s = end * (k + 0.5) / kParts;
        volume += 2.0 * s * heap.depth(heap.front() - s * s) * end / kParts;
    }
    return {{"slope of the heap less its law", worst, 1e-8}, {"volume of the heap", volume - Slump::kFirst, 1e-7}};
}

/// The slump test: a cylinder of mud as wide as high loses its mould. It is so viscous that it hardly overshoots, as the
/// theory knows no inertia. A quarter of it, between two planes of symmetry.
struct SlumpTest {
    static constexpr double kHeight = 1.0, kRadius = 0.5, kDensity = 1000.0, kViscosity = 1000.0;  // [m], SI
    double yield;  ///< stress over density g height [1]
    double cell, room;

    SlumpTest(double yield, const Setup& setup)
        : yield(yield), cell(kHeight / static_cast<double>(setup.cells)), room(yield < 0.08 ? 1.6 : 1.2) {}

    SolidScene scene(int per_side) const {
        constexpr double kSound = 10.0;  // over that of a wave on the water at rest
        const double stress = yield * kDensity * kGravity * kHeight,
                     bulk = kDensity * kSound * kSound * kGravity * kHeight;
        SolidScene s;
        s.gravity = {0, 0, -kGravity};
        s.density = kDensity;
        s.law = solid::Bingham{bulk, 100.0 * stress, kViscosity, stress};
        s.grid = grid_around({}, {0, 0, 0}, {room, room, kHeight}, cell);
        s.surfaces = {Surface::plane({0, 0, 0}, {0, 0, 1}, Hold::stuck)};
        add_quarter(s);
        double volume = 0.0;
        const auto place = [&](const auto& take) {
            for_each_part({0, 0, 0}, {kRadius, kRadius, kHeight}, cell, per_side, [&](const Vec3& x, double part) {
                if (x.head<2>().norm() < kRadius) take(x, part);
            });
        };
        place([&](const Vec3&, double part) { volume += part; });
        const double share = 0.25 * constants::kPi * kRadius * kRadius * kHeight / volume;
        place([&](const Vec3& x, double part) {
            const double p = kDensity * kGravity * (kHeight - x.z());
            s.points.add(x, Vec3::Zero(), kDensity * share * part / (1.0 - p / bulk), p);
        });
        return s;
    }
};

/// How far the middle of the top has sunk, over the height, and the root of the mean square of speeds [m/s].
struct Sunk {
    double slump, speed;
};
Sunk sink(double yield, const Setup& setup, double end, Measurement& m) {
    constexpr double kMiddle = 0.3;  // of the radius
    const SlumpTest test(yield, setup);
    const SolidScene scene = test.scene(setup.per_side);
    Mpm3d flow(scene);
    const auto height = [&] {
        double sum = 0.0;
        Index count = 0;
        for (Index p = 0; p < flow.body().points.count(); ++p) {
            const Vec3& first = scene.points.position[static_cast<std::size_t>(flow.body().points.id[p])];
            const double top = SlumpTest::kHeight - test.cell / setup.per_side;
            if (first.z() < top || first.head<2>().norm() > kMiddle * SlumpTest::kRadius) continue;
            sum += flow.position(p).z(), ++count;
        }
        return sum / static_cast<double>(count);
    };
    const double before = height();
    m = joined(m, run_body(flow, end));
    const SolidStatus now = flow.status();
    return {(before - height()) / SlumpTest::kHeight, std::sqrt(2.0 * now.kinetic / now.mass)};
}

/// Each layer spreads until its area carries the weight above it, and its sides are as if they were upright. `strength`:
/// what a slender column carries over the yield stress. It is sqrt(3) by von Mises, the law's (Roussel and Coussot 2005,
/// J. Rheol. 49, 705), and 2 by Tresca (Pashias et al. 1996, J. Rheol. 40, 1179).
double slump_of(double yield, double strength) {
    const double unyielded = strength * yield;  // height of what stays as it is
    return 1.0 - unyielded * (1.0 - std::log(unyielded));
}

/// Until it sinks by a thousandth of its height in a second at most.
Measurement run_slump_test(const Setup& setup) {
    struct Test {
        double yield, end;  ///< [s]
        const char* name;
    };
    Measurement m;
    std::vector<Extra> found;
    double speed = 0.0;
    for (const Test& test : {Test{0.1, 20.0, "0.1"}, Test{0.2, 12.0, "0.2"}, Test{0.3, 12.0, "0.3"}}) {
        const Sunk sunk = sink(test.yield, setup, test.end, m);
        found.push_back({std::string("slump_") + test.name, sunk.slump});
        found.push_back({std::string("off_") + test.name, sunk.slump - slump_of(test.yield, std::sqrt(3.0))});
        speed = std::max(speed, sunk.speed);
    }
    for (const Extra& extra : found) m.add(extra.name, extra.value);
    m.add("speed", speed, "m/s");
    return m;
}

/// The layers' balance against the formula: areas from the weight, heights from the volume.
std::vector<Residual> slump_residuals() {
    double worst = 0.0;
    for (const double yield : {0.1, 0.2, 0.3}) {
        constexpr int kLayers = 20000;
        double height = 0.0;
        for (int k = 0; k < kLayers; ++k) {
            const double above = (k + 0.5) / kLayers;  // weight above it over the whole weight
            height += 1.0 / kLayers / std::max(1.0, above / (std::sqrt(3.0) * yield));
        }
        worst = std::max(worst, std::abs(1.0 - height - slump_of(yield, std::sqrt(3.0))));
    }
    return {{"slump by layers less its formula", worst, 1e-6}};
}

}  // namespace

std::vector<Problem> slump_problems() {
    const Gate closed{0, "momentum_residual", 1e-12, "round-off"};
    Problem slump{"slump", "a block of yield-stress material slumps and stops", {16}, {}, run_slump};
    slump.order_of = "length_error";
    slump.finest_is_long = true;
    slump.gates = {{0, "length_error", 0.1, "thin-layer theory at an aspect of 0.3"},
                   {0, "creep", 2e-3, "a thousandth of the length in a second"},
                   {0, "speed", 1e-2, "at rest but for what decays"},
                   closed};
    Problem slow{"slow_slump",
                 "a viscous block slumps and stops: its surface by thin-layer theory to the second order",
                 {8},
                 heap_residuals,
                 run_slow_slump};
    slow.gates = {{0, "surface_error", 0.0625, "half a cell"},
                  {0, "length_error", 0.1, "as of the slump"},
                  {0, "speed", 1e-2, "at rest but for what decays"},
                  closed};
    Problem test{"slump_test",
                 "a cylinder of mud slumps on a floor that holds it: by theory, yield stress over weight .1, .2, .3",
                 {8, 16},
                 slump_residuals,
                 run_slump_test};
    test.order_of = "off_0.2";
    test.finest_is_long = true;
    const std::string asked = "a fiftieth of the height: what a slump test is read to";
    test.gates = {{16, "off_0.1", 0.02, asked},
                  {16, "off_0.2", 0.02, asked},
                  {16, "off_0.3", 0.02, asked},
                  {0, "speed", 2e-3, "it has stopped but for a fiftieth of a cell in a second"},
                  closed};
    for (Problem* problem : {&slump, &slow, &test}) problem->in_3d = true;
    return {slump, slow, test};
}

}  // namespace frana::verify
