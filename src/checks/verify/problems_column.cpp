// Granular columns that collapse.
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>

#include "base/constants.h"
#include "checks/verify/body.h"
#include "checks/verify/library.h"

namespace frana::verify {
namespace {

using constants::kDegree, constants::kGravity;
constexpr double kColumnWidthCells = 3.0;                          // of a slice
constexpr double kSandDensity = 1600.0, kRepose = 31.0 * kDegree;  // of Lube's columns [kg/m^3], [rad]

/// Where the first gap of a cell begins; 0 without places.
double first_gap(std::vector<double>& places, double cell) {
    if (places.empty()) return 0.0;
    std::sort(places.begin(), places.end());
    std::size_t n = 1;
    while (n < places.size() && places[n] - places[n - 1] < cell) ++n;
    return places[n - 1];
}

/// End of the deposit that holds together.
double tip(const Mpm3d& flow, double cell) {
    std::vector<double> x;
    for (Index p = 0; p < flow.body().points.count(); ++p) x.push_back(flow.position(p).x());
    return first_gap(x, cell);
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
    return solid::Elastic::of_sound(modulus, kPoisson);
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
    constexpr double kLength = 0.1, kHeight = 0.05;
    const double cell = kHeight / static_cast<double>(setup.cells);
    const solid::Elastic soft = stiff_enough(kSandDensity, kHeight);
    const Heap heap{kLength,
                    kHeight,
                    kSandDensity,
                    sand({stiffness * soft.lambda, stiffness * soft.shear}, kRepose),
                    std::tan(kRepose),
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
    constexpr double kLength = 0.1;
    Measurement m;
    double worst = 0.0;
    std::vector<std::pair<std::string, double>> found;
    for (const double a : {0.5, 1.0, 2.0, 4.0}) {
        const double height = a * kLength, law = a < 2.3 ? 1.2 * a : 1.9 * std::pow(a, 2.0 / 3.0);
        const double cell = std::min(kLength, height) / static_cast<double>(setup.cells);
        const Heap heap{kLength,
                        height,
                        kSandDensity,
                        sand(stiff_enough(kSandDensity, height), kRepose),
                        std::tan(kRepose),
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

/// A quarter of a round column of sand between two planes of symmetry, until it rests but for what creeps.
SolidScene quarter_column(double radius, double height, double room, double cell, int per_side) {
    SolidScene s;
    s.gravity = {0, 0, -kGravity};
    s.density = kSandDensity;
    s.grid = grid_around({}, {0, 0, 0}, {room, room, height}, cell);
    s.surfaces = {Surface::plane({0, 0, 0}, {0, 0, 1}, Hold::free, std::tan(kRepose))};
    add_quarter(s);
    s.flip = s.split = true;
    s.blending = std::sqrt(cell / kGravity);
    s.law = sand(stiff_enough(kSandDensity, height), kRepose);
    for_each_part({0, 0, 0}, {radius, radius, height}, cell, per_side, [&](const Vec3& x, double volume) {
        if (x.head<2>().norm() < radius) s.points.add(x, Vec3::Zero(), kSandDensity * volume);
    });
    return s;
}

/// Ends of the deposit in sectors of a quarter, each as of a plane column: their mean and half their range [m]. `from`:
/// within that radius, where sectors are narrower than cells, it holds together.
struct Ends {
    double mean, spread;
};
Ends ends(const Mpm3d& flow, double from, double cell) {
    constexpr std::size_t kSectors = 9;
    std::array<std::vector<double>, kSectors> away;
    for (Index p = 0; p < flow.body().points.count(); ++p) {
        const Vec3 x = flow.position(p);
        if (x.head<2>().norm() < from) continue;
        const double turn = std::atan2(x.y(), x.x()) / (0.5 * constants::kPi);
        away[std::min(kSectors - 1, static_cast<std::size_t>(std::max(0.0, turn) * kSectors))].push_back(
            x.head<2>().norm());
    }
    double sum = 0.0, least = INFINITY, most = 0.0;
    for (std::vector<double>& sector : away) {
        const double end = first_gap(sector, cell);
        sum += end, least = std::min(least, end), most = std::max(most, end);
    }
    return {sum / kSectors, 0.5 * (most - least)};
}

/// Round columns of sand, height over radius 0.5, 1, 2, 4. Runout over radius by Lube et al. (2004, J. Fluid Mech. 508,
/// 175): 1.24 a below 1.7, 1.6 a^(1/2) above. Cells are counted along the shorter of both.
Measurement run_round_column(const Setup& setup) {
    constexpr double kRadius = 0.1;
    Measurement m;
    double worst = 0.0, uneven = 0.0;
    std::vector<Extra> found;
    for (const double a : {0.5, 1.0, 2.0, 4.0}) {
        const double height = a * kRadius, law = a < 1.7 ? 1.24 * a : 1.6 * std::sqrt(a);
        const double cell = std::min(kRadius, height) / static_cast<double>(setup.cells);
        Mpm3d flow(quarter_column(kRadius, height, (1.5 + 1.5 * law) * kRadius, cell, setup.per_side));
        m = joined(m, run_body(flow, 4.0 * std::sqrt(height / kGravity) + 0.1));
        const Ends end = ends(flow, 0.5 * kRadius, cell);
        const double runout = end.mean / kRadius - 1.0;
        found.push_back({"runout_" + std::to_string(a).substr(0, 3), runout});
        worst = std::max(worst, std::abs(runout / law - 1.0));
        uneven = std::max(uneven, end.spread / end.mean);
    }
    for (const Extra& extra : found) m.add(extra.name, extra.value);
    m.add("runout_error", worst);
    m.add("uneven", uneven);
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
    Problem round{
        "round_columns", "round columns of sand collapse: runout by Lube et al. (2004)", {4, 8}, {}, run_round_column};
    round.order_of = "runout_error";
    round.finest_is_long = true;
    round.gates = {{8, "runout_error", 0.2, "scatter of published runouts"},
                   {8, "uneven", 0.1, "a deposit without fingers: neighbours within a tenth"},
                   closed};
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
    for (Problem* problem : {&sand, &round, &steps, &bars, &grains}) problem->in_3d = true;
    return {sand, round, steps, bars, grains};
}

}  // namespace frana::verify
