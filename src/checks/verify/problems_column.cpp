// 3D masses with strength: granular columns that collapse, a slump that its yield stress stops.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "base/constants.h"
#include "checks/verify/body.h"
#include "checks/verify/library.h"

namespace frana::verify {
namespace {

using constants::kDegree, constants::kGravity;
constexpr double kColumnWidthCells = 3.0;  // of a slice

/// End of the deposit that holds together: the first gap of a cell.
double tip(const Mpm3d& flow, double cell) {
    std::vector<double> x;
    for (Index p = 0; p < flow.body().points.count(); ++p) x.push_back(flow.position(p).x());
    std::sort(x.begin(), x.end());
    std::size_t n = 1;
    while (n < x.size() && x[n] - x[n - 1] < cell) ++n;
    return x[n - 1];
}

/// Half of a column of sand, against a smooth wall in its middle: a floor and two smooth sides.
SolidScene column(double height, double room, double cell) {
    const double width = kColumnWidthCells * cell;
    SolidScene s;
    s.gravity = {0, 0, -kGravity};
    s.grid = grid_around({}, {0, 0, 0}, {room, width, height}, cell);
    s.surfaces = {Surface::plane({0, 0, 0}, {0, 0, 1}), Surface::plane({0, 0, 0}, {1, 0, 0})};
    add_slice(s, width);
    return s;
}

/// Elastic stiffness with which sound is ten times as fast as a wave on a heap of that height.
solid::Elastic stiff_enough(double density, double height) {
    constexpr double kPoisson = 0.3;
    const double modulus = density * 100.0 * kGravity * height;  // lambda + 2 G
    return solid::Elastic::of(modulus * (1.0 + kPoisson) * (1.0 - 2.0 * kPoisson) / (1.0 - kPoisson), kPoisson);
}

/// Grains without cohesion or dilatancy in half of a column. It runs until it rests but for what creeps.
struct Heap {
    double length, height, density;
    SolidLaw law;
    double floor;      ///< friction coefficient of the floor; holds if infinite [1]
    double room, end;  ///< length of the grid [m]; [s]

    SolidScene scene(double cell, int per_side) const {
        SolidScene s = column(height, room, cell);
        s.density = density;
        if (std::isfinite(floor))
            s.surfaces[0].friction = floor;
        else
            s.surfaces[0] = Surface::plane({0, 0, 0}, {0, 0, 1}, Hold::stuck);
        s.flip = s.split = true;
        s.blending = std::sqrt(cell / kGravity);  // as stages have it (scene/scene_stages.cpp)
        s.law = law;
        for_each_part({0, 0, 0}, {length, kColumnWidthCells * cell, height}, cell, per_side,
                      [&](const Vec3& x, double volume) { s.points.add(x, Vec3::Zero(), density * volume); });
        return s;
    }
};

/// Sand whose angle of repose is phi [rad].
SolidLaw sand(const solid::Elastic& elastic, double phi) {
    return solid::DruckerPrager::of(elastic, phi, 0.0, solid::Cone::simple_shear);
}

/// Runout of a column half as high as long, with sand so many times as stiff.
Measurement run_stiff_column(const Setup& setup, double stiffness, double& runout) {
    constexpr double kLength = 0.1, kHeight = 0.05, kDensity = 1600.0, kPhi = 31.0 * kDegree;
    const double cell = kHeight / static_cast<double>(setup.cells);
    const solid::Elastic soft = stiff_enough(kDensity, kHeight);
    const Heap heap{kLength,
                    kHeight,
                    kDensity,
                    sand({stiffness * soft.lambda, stiffness * soft.shear}, kPhi),
                    std::tan(kPhi),
                    0.3,
                    4.0 * std::sqrt(kHeight / kGravity) + 0.1};
    Mpm3d flow(heap.scene(cell, setup.per_side));
    Measurement m = run_body(flow, heap.end);
    runout = tip(flow, cell) / kLength - 1.0;
    return m;
}

/// Steps alone damp nothing. Sand that is four times as stiff takes twice as many of them, and runs out as far.
Measurement run_column_steps(const Setup& setup) {
    double soft = 0.0, stiff = 0.0;
    Measurement m = run_stiff_column(setup, 1.0, soft);
    m = joined(m, run_stiff_column(setup, 4.0, stiff));
    m.add("runout", soft);
    m.add("runout_change", stiff / soft - 1.0);
    return m;
}

/// Plane columns of sand, height over half-length 0.5, 1, 2, 3. Runout over length by Lube et al. (2005): 1.2 a below
/// 2.3, 1.9 a^(2/3) above. Cells are counted along the shorter side.
Measurement run_column_collapse(const Setup& setup) {
    constexpr double kLength = 0.1, kDensity = 1600.0, kPhi = 31.0 * kDegree;
    Measurement m;
    double worst = 0.0;
    std::vector<std::pair<std::string, double>> found;
    for (const double a : {0.5, 1.0, 2.0, 4.0}) {
        const double height = a * kLength, law = a < 2.3 ? 1.2 * a : 1.9 * std::pow(a, 2.0 / 3.0);
        const double cell = std::min(kLength, height) / static_cast<double>(setup.cells);
        const Heap heap{kLength,
                        height,
                        kDensity,
                        sand(stiff_enough(kDensity, height), kPhi),
                        std::tan(kPhi),
                        (2.0 + 1.5 * law) * kLength,
                        4.0 * std::sqrt(height / kGravity) + 0.1};
        Mpm3d flow(heap.scene(cell, setup.per_side));
        m = joined(m, run_body(flow, heap.end));
        const double runout = tip(flow, cell) / kLength - 1.0;
        found.emplace_back("runout_" + std::to_string(a).substr(0, 3), runout);
        worst = std::max(worst, std::abs(runout / law - 1.0));
    }
    for (const auto& [name, value] : found) m.add(name, value);
    m.add("runout_error", worst);
    return m;
}

/// Height of what lies within a cell of a place: its volume without stress over that area [m].
double surface(const Mpm3d& flow, double x, double cell) {
    const double low = std::max(0.0, x - cell), high = x + cell;
    double volume = 0.0;
    for (Index p = 0; p < flow.body().points.count(); ++p)
        if (flow.position(p).x() >= low && flow.position(p).x() < high) volume += flow.body().points.rest_volume[p];
    return volume / (high - low) / (kColumnWidthCells * cell);
}

/// Aluminium bars 0.2 m long and 0.1 m high, Bui et al. (2008, Int. J. Numer. Anal. Meth. Geomech. 32, 1537):
/// bulk modulus 0.7 MPa, and the surface that they measured.
Measurement run_column_bars(const Setup& setup) {
    constexpr double kLength = 0.2, kHeight = 0.1, kPoisson = 0.3, kPhi = 19.8 * kDegree;
    constexpr double kMeasured[][2] = {{0.0001, 0.0992}, {0.1001, 0.0776}, {0.2, 0.0474},
                                       {0.3022, 0.0215}, {0.4022, 0.0037}, {0.4423, 0.0015}};
    const double cell = kHeight / static_cast<double>(setup.cells);
    const Heap heap{
        kLength,        kHeight, 2650.0, sand(solid::Elastic::of(3.0 * 0.7e6 * (1.0 - 2.0 * kPoisson), kPoisson), kPhi),
        std::tan(kPhi), 0.6,     0.8};
    Mpm3d flow(heap.scene(cell, setup.per_side));
    Measurement m = run_body(flow, heap.end);
    double sum = 0.0;
    for (const auto& [x, z] : kMeasured) sum += std::abs(surface(flow, x, cell) - z);
    m.front_error = tip(flow, cell) - kMeasured[5][0];
    m.add("front_share", m.front_error / (kMeasured[5][0] - kLength));
    m.add("surface_error", sum / static_cast<double>(std::size(kMeasured)) / kHeight);
    return m;
}

/// Mean depth between two places, by the volume without stress of what lies there [m].
double mean_depth(const Mpm3d& flow, double low, double high, double cell) {
    double volume = 0.0;
    for (Index p = 0; p < flow.body().points.count(); ++p)
        if (flow.position(p).x() >= low && flow.position(p).x() < high) volume += flow.body().points.rest_volume[p];
    return volume / ((high - low) * kColumnWidthCells * cell);
}

/// Plane columns of grains that were simulated one by one. Contact dynamics: Staron and Hinch 2005; Lagree, Staron and
/// Popinet 2011, J. Fluid Mech. 686, 378; as published with the solvers Gerris and Basilisk. Half the final length, and
/// mean depths of tenths of it, of both halves, over the first height. Their law is mu(I) = 0.32 + 0.28 / (1 + 0.4 / I).
/// I has the density of all the material. The floor holds them. Of the tallest column the grains fill 4 % more than
/// it had.
struct Grains {
    const char* name;
    double aspect, diameter, half_length, depth[10];  ///< lengths over the first height
};
constexpr Grains kGrains[] = {
    {"0.5", 0.5, 0.005 / 0.149, 3.95, {0.971, 0.907, 0.766, 0.642, 0.544, 0.412, 0.324, 0.240, 0.146, 0.057}},
    {"1.42", 1.42, 0.005 / 0.324, 3.22, {0.494, 0.419, 0.344, 0.285, 0.221, 0.167, 0.130, 0.085, 0.042, 0.019}},
    {"6.26", 6.26, 0.005 / 0.67, 2.21, {0.178, 0.142, 0.113, 0.091, 0.073, 0.058, 0.042, 0.031, 0.017, 0.009}}};

/// misplaced: half the area between both surfaces, over the column's. Beyond the grains' length all is.
Measurement run_column_grains(const Setup& setup) {
    constexpr double kLength = 0.1, kDensity = 1600.0;
    Measurement m;
    std::vector<std::pair<std::string, double>> found;
    for (const Grains& g : kGrains) {
        const double height = g.aspect * kLength, cell = std::min(kLength, height) / static_cast<double>(setup.cells);
        const solid::MuI law{stiff_enough(kDensity, height), 0.32, 0.60, 0.4, g.diameter * height, 1.0, kDensity};
        const Heap heap{kLength,
                        height,
                        kDensity,
                        law,
                        std::numeric_limits<double>::infinity(),
                        1.5 * g.half_length * height,
                        4.0 * std::sqrt(height / kGravity) + 0.1};
        Mpm3d flow(heap.scene(cell, setup.per_side));
        m = joined(m, run_body(flow, heap.end));
        const double tenth = 0.1 * g.half_length * height;
        double between = mean_depth(flow, 10.0 * tenth, heap.room, cell) * (heap.room - 10.0 * tenth);
        for (int n = 0; n < 10; ++n)
            between += tenth * std::abs(mean_depth(flow, n * tenth, (n + 1) * tenth, cell) - height * g.depth[n]);
        found.emplace_back(std::string("misplaced_") + g.name, 0.5 * between / (kLength * height));
        found.emplace_back(std::string("length_") + g.name, tip(flow, cell) / height / g.half_length - 1.0);
    }
    for (const auto& [name, value] : found) m.add(name, value);
    return m;
}

/// A block of yield-stress material, 2 m long and 1 m high, on a floor that holds it. It is whole. Half of it against a
/// wall is another problem. Walls have no tension, and what is drawn away from one leaves it.
struct Slump {
    static constexpr double kYield = 1000.0, kDensity = 1000.0, kMiddle = 3.5;
    static constexpr double kFirst = 1.0;  ///< half its length [m]
    double cell;
    Mpm3d flow;

    Slump(const Setup& setup, double viscosity)
        : cell(1.0 / static_cast<double>(setup.cells)), flow(scene(cell, setup.per_side, viscosity)) {}

    static SolidScene scene(double cell, int per_side, double viscosity) {
        const double width = kColumnWidthCells * cell, sound_speed = 10.0 * std::sqrt(kGravity);
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
        return volume / (4.0 * cell * kColumnWidthCells * cell);
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
    m.add("volume_error", slump.flow.status().volume / (2.0 * Slump::kFirst * kColumnWidthCells * slump.cell) - 1.0);
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

}  // namespace

std::vector<Problem> column_problems() {
    const Gate closed{0, "momentum_residual", 1e-12, "round-off"};
    Problem sand{"column_collapse",
                 "plane columns of sand collapse: runout by Lube et al. (2005)",
                 {8},
                 {},
                 run_column_collapse};
    sand.order_of = "runout_error";
    sand.gates = {{0, "runout_error", 0.2, "scatter of published runouts"}, closed};
    Problem steps{"column_steps",
                  "a plane column of sand collapses in twice the steps, four times as stiff: as far",
                  {4, 8},
                  {},
                  run_column_steps};
    steps.order_of = "runout_change";
    steps.finest_is_long = true;
    steps.gates = {{4, "runout_change", 0.155, "half a cell of four"},
                   {8, "runout_change", 0.04, "half a cell of eight; damped by the step it was -8 %"},
                   closed};
    Problem bars{"column_bars",
                 "a plane column of aluminium bars collapses: surface measured by Bui et al. (2008)",
                 {8},
                 {},
                 run_column_bars};
    bars.order_of = "surface_error";
    bars.gates = {
        {0, "front_share", 0.2, "as of sand"}, {0, "surface_error", 0.0625, "half a cell of the height"}, closed};
    Problem grains{"column_grains",
                   "plane columns of grains simulated one by one (Lagree et al. 2011): final profiles",
                   {8},
                   {},
                   run_column_grains};
    grains.gates = {closed};
    grains.finest_is_long = true;
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
    for (Problem* problem : {&sand, &steps, &bars, &grains, &slump, &slow}) problem->in_3d = true;
    return {sand, steps, bars, grains, slump, slow};
}

}  // namespace frana::verify
