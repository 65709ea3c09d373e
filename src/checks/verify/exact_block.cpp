#include "checks/verify/exact_block.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"

namespace frana::verify {

double Slab::drive() const {
    const double th = slope_deg * constants::kPi / 180.0;
    return std::max(0.0, gravity * (std::sin(th) - mu * std::cos(th)));
}

double Slab::terminal() const { return std::sqrt(xi * thickness * drive() / gravity); }

double Slab::speed(double t) const {
    const double a = drive(), limit = terminal();
    return std::isfinite(limit) ? limit * std::tanh(a * t / limit) : a * t;
}

double Slab::travel(double t) const {
    const double a = drive(), limit = terminal();
    if (!std::isfinite(limit)) return 0.5 * a * t * t;
    const double s = a * t / limit;  // ln cosh s without overflow
    return limit * limit / a * (s + std::log1p(std::exp(-2 * s)) - std::log(2.0));
}

std::vector<Residual> Slab::residuals() const {
    double motion = 0.0, path = 0.0;
    constexpr double d = 1e-3;
    for (const double t : {1.0, 4.0, 10.0}) {
        const double v = speed(t), acceleration = (speed(t + d) - speed(t - d)) / (2 * d);
        motion = std::max(motion, std::abs(acceleration - drive() + gravity * v * v / (xi * thickness)) / drive());
        path = std::max(path, std::abs((travel(t + d) - travel(t - d)) / (2 * d) - v) / v);
    }
    return {{"dv/dt = a - g v^2 / (xi h) by differences", motion, 1e-7},  // step^2
            {"dx/dt = v by differences", path, 1e-7}};
}

std::vector<Residual> published_blocks() {
    const Slab block{30, 0.3};
    double coulomb = std::max({std::abs(block.drive() - 2.35628724), 1e-1 * std::abs(block.speed(5) - 11.781436),
                               1e-1 * std::abs(block.travel(5) - 29.453590)});
    struct Row {
        Slab slab;
        double drive, terminal, speed, travel;
    };
    double voellmy = 0.0;
    for (const Row& row : {Row{{30, 0.2, 1000, 2}, 3.205858, 25.565403, 21.715171, 130.30041},
                           Row{{35, 0.155, 4000, 1}, 4.381223, 42.266198, 32.821112, 188.34438},
                           Row{{25, 0.1, 500, 1.5}, 3.256797, 15.779436, 15.278879, 106.02380}})
        voellmy =
            std::max({voellmy, std::abs(row.slab.drive() - row.drive), std::abs(row.slab.terminal() - row.terminal),
                      std::abs(row.slab.speed(10) - row.speed), 0.1 * std::abs(row.slab.travel(10) - row.travel)});
    const double toe = std::sqrt(2 * Slab{35, 0.4}.drive() * 100.0);
    return {{"printed a, v, x of the 30 degree block", coulomb, 5.1e-8},
            {"printed a, v_inf, v, x of the Voellmy slabs", voellmy, 6e-7},
            {"printed speed at the toe of 100 m of 35 degrees", toe - 21.965574, 5.1e-7},
            {"printed run-out on the flat behind it", toe * toe / (2 * 0.4 * 9.81) - 61.478905, 5.1e-7}};
}

}  // namespace frana::verify
