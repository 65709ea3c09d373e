// A stream that a wall throws back.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "checks/verify/body.h"
#include "checks/verify/library.h"

namespace frana::verify {
namespace {

constexpr double kBoreGravity = 10.0, kBoreDensity = 1000.0, kBoreDepth = 1.0;  // [m/s^2], [kg/m^3], [m]
constexpr double kBoreWidthCells = 3.0;                                         // of a slice
constexpr double kBoreFrom = 0.3;  // of the record [s]: before, the first contact rings with the speed of sound

/// A stream of depth h_1 and speed u_1 = Fr sqrt(g h_1) against a wall, without friction. A bore of depth h_2 moves
/// away from the wall at U, and the wall carries g rho h_2^2 / 2. Jump of mass and momentum (Stoker 1957).
struct Bore {
    double froude;

    double wave() const { return std::sqrt(kBoreGravity * kBoreDepth); }
    double speed() const { return froude * wave(); }
    /// h_2, where u_1 = (h_2 - h_1) sqrt(g (h_1 + h_2) / (2 h_1 h_2)); the right side grows with h_2.
    double depth() const {
        double low = kBoreDepth, high = kBoreDepth * (2.0 + 4.0 * froude);
        for (int n = 0; n < 200; ++n) {
            const double h = 0.5 * (low + high);
            const double u = (h - kBoreDepth) * std::sqrt(kBoreGravity * (kBoreDepth + h) / (2.0 * kBoreDepth * h));
            (u < speed() ? low : high) = h;
        }
        return 0.5 * (low + high);
    }
    double retreat() const { return speed() * kBoreDepth / (depth() - kBoreDepth); }  ///< U [m/s]
    /// Force of the bore on the wall over rho u_1^2 h_1.
    double force() const { return 0.5 * kBoreGravity * depth() * depth() / (speed() * speed() * kBoreDepth); }
    /// Of a stream whose end the wall does not feel before `end`. The end collapses, which runs ahead at u_1 + sqrt(g
    /// h_1), meets the bore and goes on through it at sqrt(g h_2).
    double length(double end) const {
        const double behind = std::sqrt(kBoreGravity * depth());
        return end * (speed() + wave() + retreat()) / (1.0 + retreat() / behind);
    }
};

/// The stream as points that all move with u_1 towards the wall at x = 0, under hydrostatic pressure. Rows
/// across move alike, so that one in a cell is enough.
SolidScene stream(const Bore& bore, double end, const Setup& setup) {
    const double cell = kBoreDepth / static_cast<double>(setup.cells), width = kBoreWidthCells * cell;
    const double sound_speed = 10.0 * std::max(bore.speed(), bore.wave());
    const double bulk = kBoreDensity * sound_speed * sound_speed, length = bore.length(end);
    // The end falls back at 2 sqrt(g h_1) through the stream. Jets rise as high as their speed carries them, and
    // splash.
    const double room = length + std::max(0.0, 2.0 * bore.wave() - bore.speed()) * end;
    const double top = 3.0 * (kBoreDepth + 0.5 * bore.speed() * bore.speed() / kBoreGravity);
    SolidScene s;
    s.gravity = {0, 0, -kBoreGravity};
    s.density = kBoreDensity;
    s.law = solid::Fluid{bulk, 0.0};
    s.grid = grid_around({}, {0, 0, 0}, {room, width, top}, cell);
    s.surfaces = {Surface::plane({0, 0, 0}, {1, 0, 0}), Surface::plane({0, 0, 0}, {0, 0, 1})};
    add_slice(s, width);
    const double spacing = cell / setup.per_side, part = spacing * spacing * cell;
    for (Index k = 0; k < setup.cells * setup.per_side; ++k)
        for (Index i = 0; i < std::lround(length / spacing); ++i)
            for (const double across : {0.5, 1.5, 2.5}) {
                const double x = (static_cast<double>(i) + 0.5) * spacing;
                const double z = (static_cast<double>(k) + 0.5) * spacing;
                const double p = kBoreDensity * kBoreGravity * (kBoreDepth - z);
                s.points.add({x, across * cell, z}, {-bore.speed(), 0, 0}, kBoreDensity * part / (1.0 - p / bulk), p);
            }
    return s;
}

/// The wall's mean force from kBoreFrom to `end` over that of the bore, less one.
struct Thrust {
    double error;
    double left;  ///< out of the grid [m2]
    Measurement run;
};
Thrust thrust_of(const Bore& bore, double end, const Setup& setup) {
    const double width = kBoreWidthCells * kBoreDepth / static_cast<double>(setup.cells);
    Mpm3d flow(stream(bore, end, setup));
    double since = 0.0, before = 0.0;
    Thrust result;
    result.run = run_body(flow, end, [&](const Mpm3d& now) {
        if (now.status().time <= kBoreFrom) since = now.status().time, before = now.body().impulse[0].x();
    });
    const double force = (flow.body().impulse[0].x() - before) / (end - since) / width;
    result.error = force / (kBoreDensity * bore.speed() * bore.speed() * kBoreDepth) / bore.force() - 1.0;
    result.left = flow.status().mass_left / kBoreDensity / width;
    return result;
}

/// Two streams, each for so long [s].
Measurement run_bores(const Setup& setup, const Bore& slow, double slow_end, const Bore& fast, double fast_end) {
    const Thrust first = thrust_of(slow, slow_end, setup), second = thrust_of(fast, fast_end, setup);
    Measurement m = joined(first.run, second.run);
    m.add(fmt::format("force_error_{}", slow.froude), first.error);
    m.add(fmt::format("force_error_{}", fast.froude), second.error);
    m.add("left", first.left + second.left, "m2");
    return m;
}

/// Records that several jets along the wall rise and fall in: shorter ones err by tens of percent, either
/// way.
Measurement run_reflected_bore(const Setup& setup) { return run_bores(setup, {1.0}, 4.6, {2.0}, 6.0); }

/// Jets of faster streams rise and fall more slowly, 2 u_1 / g: records of three of them and more.
Measurement run_strong_bore(const Setup& setup) { return run_bores(setup, {3.0}, 8.0, {5.0}, 10.0); }

/// Mass and momentum across the bore, seen from it; and the forces that the canon of these problems lists.
std::vector<Residual> bore_residuals() {
    std::vector<Residual> list;
    for (const auto& [froude, listed] : {std::pair{1.0, 2.35464}, {2.0, 1.52597}, {3.0, 1.31436}, {5.0, 1.17038}}) {
        const Bore bore{froude};
        const double in = bore.speed() + bore.retreat(), out = bore.retreat(), h = bore.depth();
        const double thrust_in = kBoreDepth * in * in + 0.5 * kBoreGravity * kBoreDepth * kBoreDepth;
        list.push_back(
            {fmt::format("mass through a bore at Fr = {}", froude), h * out / (kBoreDepth * in) - 1.0, 1e-12});
        list.push_back({fmt::format("momentum through a bore at Fr = {}", froude),
                        (h * out * out + 0.5 * kBoreGravity * h * h) / thrust_in - 1.0, 1e-12});
        list.push_back({fmt::format("listed force at Fr = {}", froude), bore.force() / listed - 1.0, 5e-6});
    }
    return list;
}

}  // namespace

std::vector<Problem> bore_problems() {
    Problem bore{"reflected_bore",
                 "a stream at Fr = 1, 2 meets a wall: mean force of the reflected bore",
                 {4},
                 bore_residuals,
                 run_reflected_bore};
    bore.order_of = "force_error_2";
    bore.finest_is_long = true;
    const std::string slice = "what a slice of the same scheme was within, 8 cells deep";
    bore.gates = {{0, "force_error_1", 0.02, slice},
                  {0, "force_error_2", 0.04, slice},
                  {0, "momentum_residual", 1e-12, "round-off"}};
    Problem strong{"strong_bore",
                   "a stream at Fr = 3, 5 meets a wall: mean force of the reflected bore",
                   {4},
                   {},
                   run_strong_bore};
    strong.order_of = "force_error_3";
    strong.takes_minutes = true;
    const std::string asked = "what is asked of a 3D model here";
    strong.gates = {{0, "force_error_3", 0.04, asked},
                    {0, "force_error_5", 0.04, asked},
                    {0, "momentum_residual", 1e-12, "round-off"}};
    bore.in_3d = strong.in_3d = true;
    return {bore, strong};
}

}  // namespace frana::verify
